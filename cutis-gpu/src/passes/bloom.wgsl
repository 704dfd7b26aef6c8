// The glow around bright things: means over cells of the picture, blurred along rows and columns. The twin of
// cutis-render's `Bloom`.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> film: Film;

/// Mean over a cell of the exposed picture, smaller ones at the right and lower border.
@fragment
fn reduce(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = vec2i(position.xy) * film.cell;
    let end = min(first + film.cell, vec2i(textureDimensions(picture)));
    var sum = vec4f(0.0);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            sum += exposed(textureLoad(picture, vec2i(x, y), 0), film.gain);
        }
    }
    let count = end - first;
    return sum / f32(count.x * count.y);
}

@fragment
fn blur_along_rows(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return weighted_mean(vec2i(position.xy), vec2i(1, 0));
}

@fragment
fn blur_along_columns(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return weighted_mean(vec2i(position.xy), vec2i(0, 1));
}

/// Mean of the cells along an axis that exist.
fn weighted_mean(middle: vec2i, axis: vec2i) -> vec4f {
    let place = dot(middle, axis);
    let len = dot(vec2i(textureDimensions(picture)), axis);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var i = max(place - film.reach, 0); i <= min(place + film.reach, len - 1); i++) {
        let off = abs(i - place);
        let weight = film.weights[off / 4][off % 4];
        sum += textureLoad(picture, middle + (i - place) * axis, 0) * weight;
        total += weight;
    }
    return sum / total;
}
