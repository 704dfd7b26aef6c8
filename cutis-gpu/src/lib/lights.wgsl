// Lights that have a direction at every point, and the maps drawn from them. The twin of cutis-scene's `Light`.

const DIRECTIONAL: u32 = 0u;
const POINT: u32 = 1u;
const SPOT: u32 = 2u;
const PROJECTOR: u32 = 3u;
/// Added to exponents of images of projectors.
const SLIDE_EXPONENT: f32 = 128.0;
/// In place of a layer: the light has no shadow map.
const NO_MAP: u32 = 0xffffffffu;

struct Light {
    position_mm: vec3f,
    kind: u32,
    /// Towards the light if it is directional, along its axis if it is a spot or a projector.
    dir: vec3f,
    /// Radius in mm, or the tangent of the angular radius.
    extent: f32,
    /// W/m² if it is directional, else W/sr.
    strength: vec3f,
    cos_inner: f32,
    map_right: vec3f,
    cos_outer: f32,
    map_up: vec3f,
    /// Half the width of the map: in mm, or at distance 1.
    map_half_width: f32,
    map_forward: vec3f,
    map_near_mm: f32,
    map_origin_mm: vec3f,
    map_far_mm: f32,
    map_layer: u32,
    /// Number of the first texel of a projector's image, and its size in texels.
    slide_first: u32,
    slide_width: u32,
    slide_height: u32,
    /// The image's axis to the right as it leaves the lens.
    slide_right: vec3f,
    /// Tangent of half its vertical angle.
    tan_half_height: f32,
    /// How far it has moved to the right and up, in parts of its size.
    slide_shift: vec2f,
    pad0: f32,
    pad1: f32,
}

/// Images of all projectors, linear: red and green in x, blue and the exponent of all three in y. All passes bind it here.
@group(0) @binding(29) var<storage, read> slides: array<vec2u>;

struct LightSample {
    dir_to_light: vec3f,
    distance_mm: f32,
    irradiance_w_per_m2: vec3f,
}

/// Light number `l` as a point sees it. Lights are told by their number: what is not asked for is not fetched.
fn sample_light(l: u32, point_mm: vec3f) -> LightSample {
    let kind = lights[l].kind;
    let strength = lights[l].strength;
    if kind == DIRECTIONAL {
        return LightSample(lights[l].dir, 3.0e38, strength);
    }
    let to_light = lights[l].position_mm - point_mm;
    // A point at the light's very centre has no direction.
    let distance_mm = max(length(to_light), 1e-30);
    let dir_to_light = to_light / distance_mm;
    // Within a millimetre the inverse square of a real lamp no longer holds.
    let distance_m = max(distance_mm, 1.0) * 1e-3;
    var irradiance = strength / (distance_m * distance_m);
    if kind == SPOT {
        irradiance *= spot_falloff(dot(lights[l].dir, -dir_to_light), lights[l].cos_inner, lights[l].cos_outer);
    }
    if kind == PROJECTOR {
        irradiance *= slide_filter(l, -dir_to_light);
    }
    return LightSample(dir_to_light, distance_mm, irradiance);
}

/// The direction alone, for passes that need no image of a projector for it.
fn dir_to_light(l: u32, point_mm: vec3f) -> vec3f {
    if lights[l].kind == DIRECTIONAL {
        return lights[l].dir;
    }
    let to_light = lights[l].position_mm - point_mm;
    return to_light / max(length(to_light), 1e-30);
}

fn spot_falloff(cos_axis: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    // The specification's own floor for cones that coincide.
    let ramp = clamp((cos_axis - cos_outer) / max(cos_inner - cos_outer, 1e-3), 0.0, 1.0);
    return ramp * ramp;
}

/// What the image of a projector lets through in a direction that light travels; black beside the image and behind the lens.
fn slide_filter(l: u32, dir_travel: vec3f) -> vec3f {
    let right = lights[l].slide_right;
    let along = lights[l].dir;
    let z = dot(along, dir_travel);
    let size = vec2f(f32(lights[l].slide_width), f32(lights[l].slide_height));
    // From -1 to 1 over the image.
    let on_image = vec2f(dot(right, dir_travel) * size.y / size.x, -dot(cross(right, along), dir_travel));
    let place = on_image / (z * lights[l].tan_half_height);
    if z <= 0.0 || max(abs(place.x), abs(place.y)) > 1.0 {
        return vec3f(0.0);
    }
    // The outermost half texel is held; what has left on one side comes in on the other.
    let held = clamp((0.5 + 0.5 * place) * size - 0.5, vec2f(0.0), size - 1.0);
    let p = held + vec2f(-lights[l].slide_shift.x, lights[l].slide_shift.y) * size;
    let f = p - floor(p);
    let first = vec2u(floor(p) - floor(floor(p) / size) * size);
    let last = (first + 1u) % vec2u(size);
    let upper = mix(slide_texel(l, first.x, first.y), slide_texel(l, last.x, first.y), f.x);
    let lower = mix(slide_texel(l, first.x, last.y), slide_texel(l, last.x, last.y), f.x);
    return mix(upper, lower, f.y);
}

fn slide_texel(l: u32, x: u32, y: u32) -> vec3f {
    let packed = slides[lights[l].slide_first + y * lights[l].slide_width + x];
    let scale = exp2(f32(packed.y >> 16u) - SLIDE_EXPONENT);
    return vec3f(unpack2x16unorm(packed.x), unpack2x16unorm(packed.y).x) * scale;
}
