// How open the surface is to its surroundings, and to which side on the mean: the twin of cutis-render's `ambient`. Maps of
// depth from many directions take the place of rays. At a quarter of the size of the irradiance.

@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var places: texture_2d<u32>;
@group(0) @binding(3) var stretch_map: texture_2d<f32>;
/// Charts at the size of the irradiance and at smaller ones.
@group(0) @binding(4) var charts: texture_2d<u32>;
@group(0) @binding(5) var depths: texture_depth_2d_array;
/// What is smoothed.
@group(0) @binding(6) var sharp: texture_2d<f32>;

/// How often charts are halved for this map.
const HALVINGS: u32 = 2u;
/// Share of what the surface's depth changes by within a texel that its curvature may add to that of its tangent plane.
const BENT: f32 = 0.5;
/// Cosine below which a map's depths say nothing about a surface.
const LEAST_COS: f32 = 0.1;

/// Mean direction that is open in xyz, open fraction of the cosine-weighted hemisphere in w.
@fragment
fn look_around(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, HALVINGS).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let under = central_texel(chart, texel << vec2u(HALVINGS));
    let place = textureLoad(places, under, 0);
    let normal = unpack_unit(place.w);
    let point_mm = bitcast<vec3f>(place.xyz) + normal * textureLoad(stretch_map, under, 0).z;
    var open = vec4f(0.0);
    var whole = vec4f(0.0);
    for (var l = 0u; l < arrayLength(&lights); l++) {
        let dir = lights[l].dir;
        let cos = dot(normal, dir);
        if cos > 0.0 {
            let from_there = vec4f(dir, 1.0) * cos;
            open += from_there * seen_from_afar(map_of(l), point_mm, normal);
            whole += from_there;
        }
    }
    let share = open / max(whole.w, 1e-6);
    // What the few directions over an open surface miss of the mean of all, two thirds of the normal, they miss here, too.
    let missed = normal * (2.0 / 3.0) - whole.xyz / max(whole.w, 1e-6);
    return vec4f(share.xyz + missed * share.w, share.w);
}

/// The most central texel of a chart under one of a quarter of the size.
fn central_texel(chart: u32, corner: vec2i) -> vec2i {
    var found = corner;
    var nearest = 100;
    for (var i = 0; i < 16; i++) {
        let away = vec2i(i & 3, i >> 2u);
        let off_centre = abs(2 * away - 3);
        let distance = off_centre.x + off_centre.y;
        if distance < nearest && textureLoad(charts, corner + away, 0).x == chart {
            found = corner + away;
            nearest = distance;
        }
    }
    return found;
}

/// Share of a point that nothing hides from a direction: of the four texels around it, those that show nothing in front of
/// its tangent plane.
fn seen_from_afar(map: LightMap, point_mm: vec3f, normal: vec3f) -> f32 {
    let axes_mm = in_map_axes(map, point_mm);
    let facing = vec3f(dot(map.right, normal), dot(map.up, normal), min(dot(map.forward, normal), -LEAST_COS));
    // What the plane's depth grows by for a millimetre to the right and up.
    let growth = -facing.xy / facing.z;
    let size = vec2f(textureDimensions(depths));
    let texel_mm = 2.0 * map.half_width / size.x;
    let uv = light_map_uv(map, axes_mm);
    let texels = around(uv, vec2u(size));
    let nearest_mm = axes_mm.z - texel_mm * (1e-3 + BENT * (abs(growth.x) + abs(growth.y)));
    let own = uv * size - 0.5;
    // What is hidden, so that exactly 1 is left where nothing is.
    var hidden = 0.0;
    for (var i = 0; i < 4; i++) {
        let texel = vec2i(select(texels.first.x, texels.last.x, (i & 1) == 1), select(texels.first.y, texels.last.y, i >= 2));
        let away_mm = (vec2f(texel) - own) * vec2f(texel_mm, -texel_mm);
        let depth = textureLoad(depths, texel, map.layer, 0);
        let depth_mm = mix(map.near_mm, map.far_mm, depth);
        hidden += select(texels.weights[i], 0.0, depth_mm >= nearest_mm + dot(growth, away_mm));
    }
    return 1.0 - hidden;
}

/// Mean over a square of 4 × 4 texels of the same chart around a texel: those on its edge count half.
@fragment
fn smooth_openness(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, HALVINGS).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let size = vec2i(textureDimensions(sharp));
    var mean = vec4f(0.0);
    var whole = 0.0;
    for (var i = 0; i < 25; i++) {
        let away = vec2i(i % 5, i / 5) - 2;
        let read = texel + away;
        if all(read >= vec2i(0)) && all(read < size) && textureLoad(charts, read, HALVINGS).x == chart {
            let weight = select(1.0, 0.5, abs(away.x) == 2) * select(1.0, 0.5, abs(away.y) == 2);
            mean += textureLoad(sharp, read, 0) * weight;
            whole += weight;
        }
    }
    return mean / whole;
}
