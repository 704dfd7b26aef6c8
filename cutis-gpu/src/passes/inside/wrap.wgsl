// Wrap lighting (Green 2004, section 16.2 and listing 16-1): the twin of cutis-render's `wrap`.

@group(0) @binding(30) var<uniform> wrap: Wrap;
/// Light per irradiance in rgb, the specular power in alpha, by N·L along x and N·H along y.
@group(0) @binding(31) var skin_table: texture_2d<f32>;
@group(0) @binding(32) var irradiance_map: texture_2d<f32>;
@group(0) @binding(33) var depths: texture_2d_array<f32>;

struct Wrap {
    /// Cosine by which light goes on beyond the terminator.
    wraps: vec3f,
    scatter_width: f32,
    scatter_colour: vec3f,
    shininess: f32,
    /// Colour of the paper's specular power.
    specular_colour: vec3f,
    shadow_offset_mm: f32,
    /// Diffuse reflectance of the body.
    colour: vec3f,
    by_table: u32,
    energy_conserving: u32,
    /// Whether lights are reflected by the paper's power.
    by_power: u32,
    pad0: u32,
    pad1: u32,
}

fn exitance_at(place: Place, texels: Around, weights: vec4f) -> Exitance {
    var sum = vec3f(0.0);
    var l = 0u;
    loop {
        sum += wrapped_light(place, l, texels, weights);
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    let around = from_environment(place.atlas_uv, place.chart, place.smooth_normal, place.normal);
    let light = sum + around * mean_rho_dt(rho_dt_table, linear, place.roughness, place.rho_s);
    return Exitance(light * film(place.albedo, material.albedo_mix) * wrap.colour, vec3f(0.0));
}

fn shine_at(place: Place, texels: Around, weights: vec4f) -> vec3f {
    if wrap.by_power == 0u {
        return shine_of_lights(place, texels, weights);
    }
    var sum = vec3f(0.0);
    var l = 0u;
    loop {
        let towards = sample_light(l, place.position_mm);
        let power = light_at(place, towards).a;
        if power > 0.0 {
            let visible = wrapped_visible(place, l, towards, texels, weights);
            sum += towards.irradiance_w_per_m2 * wrap.specular_colour * (power * visible / PI);
        }
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    return sum;
}

/// What enters of light number `l`, W/m².
fn wrapped_light(place: Place, l: u32, texels: Around, weights: vec4f) -> vec3f {
    let towards = sample_light(l, place.position_mm);
    let light = light_at(place, towards).rgb;
    if all(light == vec3f(0.0)) {
        return vec3f(0.0);
    }
    let wrapped = (dot(place.normal, towards.dir_to_light) + wrap.wraps) / (1.0 + wrap.wraps);
    let cos = max(wrapped.x, max(wrapped.y, wrapped.z));
    let enters = rho_dt(rho_dt_table, linear, cos, place.roughness, place.rho_s);
    return towards.irradiance_w_per_m2 * light * (enters * wrapped_visible(place, l, towards, texels, weights));
}

fn light_at(place: Place, towards: LightSample) -> vec4f {
    let h = unit_or(towards.dir_to_light + place.dir_to_eye, place.normal);
    let cos_light = dot(place.normal, towards.dir_to_light);
    let cos_half = dot(place.normal, h);
    if wrap.by_table != 0u {
        return textureSampleLevel(skin_table, linear, vec2f(0.5 + 0.5 * cos_light, 0.5 + 0.5 * cos_half), 0.0);
    }
    return listing(cos_light, cos_half);
}

/// The function of the paper's listing.
fn listing(cos_light: f32, cos_half: f32) -> vec4f {
    let wrapped = (cos_light + wrap.wraps) / (1.0 + wrap.wraps);
    let energy = select(vec3f(1.0), 1.0 / (1.0 + wrap.wraps), wrap.energy_conserving != 0u);
    let width = wrap.scatter_width;
    var tint = vec3f(0.0);
    if width > 0.0 {
        tint = smoothstep(vec3f(0.0), vec3f(width), wrapped)
            * (1.0 - smoothstep(vec3f(width), vec3f(2.0 * width), wrapped));
    }
    let lit = max(wrapped, vec3f(0.0));
    let power = select(0.0, pow(max(cos_half, 0.0), wrap.shininess), any(wrapped > vec3f(0.0)));
    return vec4f((lit + tint * wrap.scatter_colour) * energy, power);
}

/// Fraction of a light that is seen. Beyond the terminator the body itself would hide all of it: what hides the light from a
/// place above counts, more and more from where the wrap begins to matter.
fn wrapped_visible(place: Place, l: u32, towards: LightSample, texels: Around, weights: vec4f) -> f32 {
    let widest = max(max(wrap.wraps.x, wrap.wraps.y), max(wrap.wraps.z, LEAST_WRAP));
    let cos = dot(place.smooth_normal, towards.dir_to_light);
    let visible = visible_part(l, texels, weights);
    if cos >= widest {
        return visible;
    }
    let offset_mm = wrap.shadow_offset_mm * offset_share(cos, widest);
    let axes = orthonormal_pair(place.smooth_normal);
    var places = PLACES_ABOVE;
    var above = 0.0;
    for (var i = 0u; i < 16u; i++) {
        let aside = axes[0] * places[i].x + axes[1] * places[i].y;
        above += visible_above(l, place.position_mm + (place.smooth_normal * places[i].z + aside) * offset_mm) / 16.0;
    }
    return mix(above, visible, max(cos / widest, 0.0));
}

/// Places above the surface that look for what hides a light, along tangent, bitangent and normal in times of the offset.
const PLACES_ABOVE = array<vec3f, 16>(
    vec3f(0.088, 0.0, 0.53),
    vec3f(-0.113, 0.103, 1.16),
    vec3f(0.017, -0.197, 0.84),
    vec3f(0.142, 0.186, 1.47),
    vec3f(-0.261, -0.046, 0.66),
    vec3f(0.247, -0.157, 1.28),
    vec3f(-0.083, 0.308, 0.97),
    vec3f(-0.156, -0.304, 0.59),
    vec3f(0.342, 0.125, 1.22),
    vec3f(-0.355, 0.147, 0.91),
    vec3f(0.172, -0.366, 1.41),
    vec3f(0.126, 0.405, 0.72),
    vec3f(-0.38, -0.223, 1.34),
    vec3f(0.447, -0.103, 1.03),
    vec3f(-0.274, 0.386, 0.78),
    vec3f(-0.062, -0.488, 1.09),
);

/// Below this, nothing wraps.
const LEAST_WRAP: f32 = 1e-6;

/// Part of the shadow's offset at a cosine of the smooth surface: a body of radius R bulges by R cos²/2 before a place beyond
/// its terminator.
fn offset_share(cos: f32, widest: f32) -> f32 {
    let beyond = clamp(-cos / widest, 0.0, 1.0);
    return 0.1 + 0.9 * beyond * beyond;
}

/// Whether a light sees a place above the surface, 0 or 1.
fn visible_above(l: u32, place_mm: vec3f) -> f32 {
    let map = map_of(l);
    if map.layer == NO_MAP {
        return 1.0;
    }
    let axes_mm = in_map_axes(map, place_mm);
    let size = vec2f(textureDimensions(depths));
    let texel = vec2i(floor(light_map_uv(map, axes_mm) * size));
    if any(texel < vec2i(0)) || any(texel >= vec2i(size)) {
        return 1.0;
    }
    return select(0.0, 1.0, textureLoad(depths, texel, map.layer, 0).x >= axes_mm.z);
}

/// Distances are those of the lights' maps.
fn distances_at(place: Place) -> vec4f {
    return vec4f(0.0);
}
