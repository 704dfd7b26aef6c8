// Samples of the diffusion profile around every sample of the picture, taken from images of the irradiance
// (Mertens et al. 2003). The twin of cutis-render's technique `image_space` and of its pass `irradiance_image`.

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var<uniform> gathering: Gathering;
@group(0) @binding(3) var places: texture_2d<u32>;
@group(0) @binding(4) var light: texture_2d<f32>;
@group(0) @binding(5) var light_places: texture_2d_array<u32>;
@group(0) @binding(6) var light_light: texture_2d_array<f32>;
/// R per channel in xyz at the entries, 1/mm², object by object, mixture by mixture.
@group(0) @binding(7) var<storage, read> tables: array<vec4f>;
/// Places to look at, pixel by pixel of those that complete each other, profile by profile.
@group(0) @binding(8) var<storage, read> looked_at: array<PlaceToLook>;
@group(0) @binding(9) var<storage, read> radials: array<Radial>;

const ENTRIES: u32 = 1024u;
const INTERLEAVED_PIXELS: u32 = 16u;
/// Ranks of the pixels of an ordered dither.
const RANKS = array<u32, 16>(0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);
const GRAZING: f32 = 0.02;
const ROUNDING: f32 = 1e-6;
const MAX_GAIN: f32 = 2.0;
const MAX_JACOBIAN: f32 = 8.0;
const SAME_SURFACE_TEXELS: f32 = 2.0;
const SAME_SIDE: f32 = 0.3;
const MIN_SLANT: f32 = 0.1;

struct Gathering {
    /// Lights whose images there are.
    lights: vec4u,
    light_count: u32,
    /// Places for a sample of the picture.
    place_count: u32,
    jacobian: u32,
    /// Whether only samples that met the body count.
    count_valid: u32,
    /// Mixtures of every object's media.
    mixtures: u32,
    round: u32,
    pad0: u32,
    pad1: u32,
}

/// The profile of one mixture of one object.
struct Radial {
    fine_mm: f32,
    entries_per_e: f32,
    pad0: f32,
    pad1: f32,
}

struct PlaceToLook {
    offset_mm: vec2f,
    density_per_mm2: f32,
    pad0: f32,
}

/// From where an image is seen.
struct View {
    parallel: bool,
    origin_mm: vec3f,
    right: vec3f,
    up: vec3f,
    forward: vec3f,
    half: vec2f,
}

/// What an image shows in the place of a point.
struct SeenThere {
    found: bool,
    position_mm: vec3f,
    /// From the point that was asked for to that place, mm.
    from_point_mm: vec3f,
    normal: vec3f,
    irradiance_w_per_m2: vec3f,
    uncertain_mm: f32,
}

struct Texel {
    object: u32,
    position_mm: vec3f,
    normal: vec3f,
    irradiance_w_per_m2: vec3f,
    /// Place in the row of mixtures, 0 to 1.
    mixture: f32,
}

struct Gathered {
    @location(0) local: vec4f,
    @location(1) transmitted: vec4f,
}

@fragment
fn sample_profile(@builtin(position) position: vec4f) -> Gathered {
    let sample = vec2u(position.xy);
    let own = texel_at(CAMERA, vec2i(sample));
    if own.object == 0u {
        return Gathered(vec4f(0.0), vec4f(0.0));
    }
    let pixel = sample.x % 4u + 4u * (sample.y % 4u);
    let profile = (own.object - 1u) * gathering.mixtures + mixture_at(own.mixture, pixel);
    let first = (profile * INTERLEAVED_PIXELS + pixel) * gathering.place_count;
    var transmitted = vec3f(0.0);
    for (var image = 0u; image < gathering.light_count; image++) {
        transmitted += found_in_image(image, own, profile, first);
    }
    return Gathered(vec4f(found_in_image(CAMERA, own, profile, first), 1.0), vec4f(transmitted, 1.0));
}

/// Which of the mixtures a pixel takes at a place in their row.
fn mixture_at(place: f32, pixel: u32) -> u32 {
    var ranks = RANKS;
    let rank = (ranks[pixel] + gathering.round) % INTERLEAVED_PIXELS;
    return u32(place * f32(gathering.mixtures - 1u) + (f32(rank) + 0.5) / 16.0);
}

/// In place of the number of a light's image: the camera's.
const CAMERA: u32 = 0xffffffffu;

/// Light that is found in one image around the point, W/m², of all that the images before do not show.
fn found_in_image(image: u32, own: Texel, profile: u32, first: u32) -> vec3f {
    let view = view_of(image);
    let axes = orthonormal_pair(own.normal);
    var sum = vec3f(0.0);
    var valid = 0u;
    for (var i = 0u; i < gathering.place_count; i++) {
        let place = looked_at[first + i];
        let offset_mm = axes[0] * place.offset_mm.x + axes[1] * place.offset_mm.y;
        let plane_mm = own.position_mm + offset_mm;
        let seen = through(image, view, plane_mm, own.object);
        if !seen.found {
            continue;
        }
        valid++;
        let r = profile_at(profile, length(offset_mm + seen.from_point_mm));
        if all(r == vec3f(0.0)) || place.density_per_mm2 <= 0.0 || shown_before(image, seen, own.object) {
            continue;
        }
        var area = 1.0;
        if gathering.jacobian != 0u {
            area = jacobian(view, seen.position_mm, seen.normal, plane_mm, own.normal);
        }
        let drawn = profile_at(profile, length(offset_mm));
        let most = select(1.0, MAX_GAIN, gathering.jacobian != 0u);
        let found = clamp(r * area, -abs(drawn) * most, abs(drawn) * most);
        sum += found * seen.irradiance_w_per_m2 / place.density_per_mm2;
    }
    // Where lights look for what the camera misses, it must not be made up for: what they miss as well is dark.
    if gathering.count_valid != 0u && gathering.light_count == 0u && valid > 0u {
        return max(sum * (f32(gathering.place_count) / f32(valid)), vec3f(0.0));
    }
    return max(sum, vec3f(0.0));
}

fn shown_before(image: u32, seen: SeenThere, object: u32) -> bool {
    if image == CAMERA {
        return false;
    }
    if shows(CAMERA, seen, object) {
        return true;
    }
    for (var before = 0u; before < image; before++) {
        if shows(before, seen, object) {
            return true;
        }
    }
    return false;
}

/// R of each channel at a distance, 1/mm²; nothing beyond the table.
fn profile_at(profile: u32, r_mm: f32) -> vec3f {
    let radial = radials[profile];
    let x = log(1.0 + r_mm / radial.fine_mm) * radial.entries_per_e;
    if x >= f32(ENTRIES - 1u) {
        return vec3f(0.0);
    }
    let i = u32(x);
    let entry = profile * ENTRIES + i;
    return mix(tables[entry].xyz, tables[entry + 1u].xyz, x - f32(i));
}

fn view_of(image: u32) -> View {
    if image == CAMERA {
        let half = vec2f(length(camera.right), length(camera.up));
        return View(false, camera.position_mm, camera.right / half.x, camera.up / half.y, camera.forward, half);
    }
    let map = map_of(gathering.lights[image]);
    return View(map.directional, map.origin_mm, map.right, map.up, map.forward, vec2f(map.half_width));
}

fn size_of(image: u32) -> vec2u {
    if image == CAMERA {
        return textureDimensions(places);
    }
    return textureDimensions(light_places);
}

fn texel_at(image: u32, texel: vec2i) -> Texel {
    var place: vec4u;
    var value: vec4f;
    if image == CAMERA {
        place = textureLoad(places, texel, 0);
        value = textureLoad(light, texel, 0);
    } else {
        place = textureLoad(light_places, texel, image, 0);
        value = textureLoad(light_light, texel, image, 0);
    }
    let plane = unpack_unit_and_share(place.w);
    return Texel(u32(value.w), bitcast<vec3f>(place.xyz), plane.xyz, value.rgb, plane.w);
}

/// The texel that a point falls on; none (object 0) outside of the image and where another object is seen.
fn texel_of(image: u32, view: View, point_mm: vec3f, object: u32) -> Texel {
    let p = point_mm - view.origin_mm;
    let depth = select(dot(view.forward, p), 1.0, view.parallel);
    let ndc = vec2f(dot(view.right, p), dot(view.up, p)) / (view.half * depth);
    let size = vec2f(size_of(image));
    let place = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size;
    if depth <= 0.0 || any(place < vec2f(0.0)) || any(place >= size) {
        return Texel(0u, vec3f(0.0), vec3f(0.0, 0.0, 1.0), vec3f(0.0), 0.0);
    }
    var texel = texel_at(image, vec2i(place));
    if texel.object != object {
        texel.object = 0u;
    }
    return texel;
}

fn dir_at(view: View, point_mm: vec3f) -> vec3f {
    if view.parallel {
        return view.forward;
    }
    return unit_or(point_mm - view.origin_mm, view.forward);
}

fn distance_in_view_mm(view: View, point_mm: vec3f) -> f32 {
    if view.parallel {
        return dot(view.forward, point_mm - view.origin_mm);
    }
    return distance(point_mm, view.origin_mm);
}

/// What of an object is seen in the place of a point.
fn through(image: u32, view: View, point_mm: vec3f, object: u32) -> SeenThere {
    let texel = texel_of(image, view, point_mm, object);
    let dir = dir_at(view, point_mm);
    let cos = dot(texel.normal, dir);
    // The middle of a texel lies a little aside: its plane is followed to the view line of the point.
    var further_mm = distance_in_view_mm(view, texel.position_mm) - distance_in_view_mm(view, point_mm);
    if abs(cos) >= GRAZING {
        further_mm = dot(texel.normal, texel.position_mm - point_mm) / cos;
    }
    let rounding_mm = ROUNDING * abs(distance_in_view_mm(view, point_mm));
    let from_point_mm = select(dir * further_mm, vec3f(0.0), abs(further_mm) < rounding_mm);
    return SeenThere(
        texel.object != 0u,
        point_mm + from_point_mm,
        from_point_mm,
        texel.normal,
        texel.irradiance_w_per_m2,
        uncertain_mm(image, view, texel),
    );
}

/// Depths that a texel's surface has within the texel, mm.
fn uncertain_mm(image: u32, view: View, texel: Texel) -> f32 {
    let spread = select(distance_in_view_mm(view, texel.position_mm), 1.0, view.parallel);
    let slant = max(abs(dot(texel.normal, dir_at(view, texel.position_mm))), MIN_SLANT);
    return 2.0 * view.half.y * spread / (f32(size_of(image).y) * slant);
}

/// Whether a place on an object, found in another image, is seen here as well: the same surface, from the same side.
fn shows(image: u32, there: SeenThere, object: u32) -> bool {
    let view = view_of(image);
    let texel = texel_of(image, view, there.position_mm, object);
    if texel.object == 0u {
        return false;
    }
    let apart_mm = distance_in_view_mm(view, texel.position_mm) - distance_in_view_mm(view, there.position_mm);
    let allowed_mm = SAME_SURFACE_TEXELS * (uncertain_mm(image, view, texel) + there.uncertain_mm);
    return dot(texel.normal, there.normal) > SAME_SIDE && abs(apart_mm) <= allowed_mm;
}

/// Area on the body over the area on a plane, both on one view line.
fn jacobian(view: View, body_mm: vec3f, body_normal: vec3f, plane_mm: vec3f, plane_normal: vec3f) -> f32 {
    let dir = dir_at(view, plane_mm);
    var farther = 1.0;
    if !view.parallel {
        farther = distance_in_view_mm(view, body_mm) / max(distance_in_view_mm(view, plane_mm), 1e-6);
    }
    let cosines = abs(dot(plane_normal, dir)) / max(abs(dot(body_normal, dir)), 1e-6);
    return min(farther * farther * cosines, MAX_JACOBIAN);
}
