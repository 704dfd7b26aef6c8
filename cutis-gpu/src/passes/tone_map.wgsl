// The finished picture: 8-bit codes of a screen. The twin of cutis-render's `develop` and `codes`.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> film: Film;
@group(0) @binding(2) var glow: texture_2d<f32>;
@group(0) @binding(3) var linear: sampler;

@fragment
fn develop(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return codes(exposed(textureLoad(picture, vec2i(position.xy), 0), film.gain), vec2u(position.xy));
}

@fragment
fn develop_with_glow(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let light = exposed(textureLoad(picture, vec2i(position.xy), 0), film.gain);
    let cells = position.xy / f32(film.cell);
    let around = textureSampleLevel(glow, linear, cells / vec2f(textureDimensions(glow)), 0.0);
    return codes(mix(light, around, film.strength), vec2u(position.xy));
}

/// The codes of exposed light, each over 255.
fn codes(pixel: vec4f, at: vec2u) -> vec4f {
    let colour = before_grey(shown(pixel));
    let encoded = floor(clamp(linear_to_srgb(colour) * 255.0 + 0.5 + dither(at), vec3f(0.0), vec3f(255.0)));
    return vec4f(encoded / 255.0, 1.0);
}

/// Tone maps the colour itself, not its product with the coverage.
fn shown(pixel: vec4f) -> vec4f {
    if pixel.a <= 0.0 {
        return vec4f(0.0);
    }
    let colour = min(pixel.rgb / pixel.a, vec3f(MAX_RADIANCE));
    return vec4f(tone_mapped(film.tone_mapper, colour) * pixel.a, pixel.a);
}

fn before_grey(pixel: vec4f) -> vec3f {
    return clamp(pixel.rgb + (1.0 - pixel.a) * film.behind, vec3f(0.0), vec3f(1.0));
}

fn linear_to_srgb(linear_light: vec3f) -> vec3f {
    let curve = 1.055 * pow(linear_light, vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * linear_light, linear_light <= vec3f(0.0031308));
}
