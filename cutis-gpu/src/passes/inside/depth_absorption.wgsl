// Absorption over the distance that light travels through bodies (Green 2004, GPU Gems, section 16.3): the twin of
// cutis-render's `depth_absorption`, and of its `way`, which reads the depth map here.

@group(0) @binding(30) var<uniform> body: DepthAbsorption;
/// Colours over distances in w, mm.
@group(0) @binding(31) var<storage, read> ramp: array<vec4f>;
@group(0) @binding(32) var irradiance_map: texture_2d<f32>;
/// Distances of each light from the surfaces that it meets, negative where it leaves a body, mm.
@group(0) @binding(33) var distances: texture_2d_array<f32>;
/// Share of a light's irradiance that enters at the first of them.
@group(0) @binding(34) var entered_map: texture_2d_array<f32>;

struct DepthAbsorption {
    sigma_t_per_mm: vec3f,
    thickness_scale: f32,
    /// Diffuse reflectance of the body.
    colour: vec3f,
    filter_radius_mm: f32,
    samples: u32,
    layers: u32,
    /// Whether normal and colour of the entry are known.
    by_surface: u32,
    /// Stops of the ramp; none: the exponential.
    stops: u32,
}

/// Streams of random numbers: one per light from here on.
const STREAM: u32 = 0x300u;
/// Cosine of the light on the far side up to which light whose entry is known fades in.
const FADE_COS: f32 = 0.2;
/// Distance where no way leads to the light, mm.
const NO_WAY_MM: f32 = 1e6;

fn exitance_at(place: Place, texels: Around, weights: vec4f) -> Exitance {
    let around = from_environment(place.atlas_uv, place.chart, place.smooth_normal, place.normal);
    let film_in = film(place.albedo, material.albedo_mix);
    var sum = Exitance(around * mean_rho_dt(rho_dt_table, linear, place.roughness, place.rho_s) * film_in, vec3f(0.0));
    var l = 0u;
    loop {
        let towards = sample_light(l, place.position_mm);
        if dot(place.smooth_normal, towards.dir_to_light) >= 0.0 {
            sum.local += faced(place, towards, visible_part(l, texels, weights)) * film_in;
        } else {
            sum.transmitted += through(place, l, towards);
        }
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    return Exitance(sum.local * body.colour, sum.transmitted * body.colour);
}

fn shine_at(place: Place, texels: Around, weights: vec4f) -> vec3f {
    return shine_of_lights(place, texels, weights);
}

/// Light that has entered close by, W/m².
fn faced(place: Place, towards: LightSample, visible: f32) -> vec3f {
    let cos = max(dot(place.normal, towards.dir_to_light), 0.0);
    let enters = rho_dt(rho_dt_table, linear, cos, place.roughness, place.rho_s);
    return towards.irradiance_w_per_m2 * (cos * visible * enters);
}

/// Light that comes through to a place that faces away, W/m²: the mean over the ways to places around it.
fn through(place: Place, l: u32, towards: LightSample) -> vec3f {
    let map = map_of(l);
    if map.layer == NO_MAP {
        return vec3f(0.0);
    }
    let right = any_tangent(towards.dir_to_light);
    let up = cross(towards.dir_to_light, right);
    let shift = random2(place.sample, STREAM + l);
    let samples = select(1u, body.samples, body.filter_radius_mm > 0.0);
    var sum = Ways(vec3f(0.0), 0.0, 0.0);
    var i = 0u;
    loop {
        let aside = select(vec2f(0.0), disc(r2_point(i, shift)) * body.filter_radius_mm, samples > 1u);
        sum = with_ways_to(sum, map, place.position_mm + right * aside.x + up * aside.y);
        continuing {
            i++;
            break if i >= samples;
        }
    }
    let light = sum.light * towards.irradiance_w_per_m2 / max(sum.weight, 1e-6);
    let leaves = -dot(place.smooth_normal, towards.dir_to_light);
    if body.by_surface != 0u {
        return light * smoothstep(0.0, FADE_COS, leaves);
    }
    // As if it were faced, and spread over the surface that it leaves by.
    let cos = max(-dot(place.normal, towards.dir_to_light), 0.0);
    let enters = rho_dt(rho_dt_table, linear, 1.0, place.roughness, place.rho_s);
    return light * film(place.albedo, material.albedo_mix) * (cos * enters);
}

/// What ways of light bring, added up.
struct Ways {
    /// As a share of the irradiance.
    light: vec3f,
    distance_mm: f32,
    weight: f32,
}

/// With the ways to the four texels around a place.
fn with_ways_to(sum: Ways, map: LightMap, place_mm: vec3f) -> Ways {
    let size = vec2f(textureDimensions(distances));
    let uv = light_map_uv(map, in_map_axes(map, place_mm));
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) {
        return sum;
    }
    let corner = floor(uv * size - 0.5);
    let f = uv * size - 0.5 - corner;
    let d_o_mm = light_distance_mm(map, place_mm);
    var all = sum;
    for (var i = 0u; i < 4u; i++) {
        let step = vec2u(i & 1u, i >> 1u);
        let texel = clamp(vec2i(corner) + vec2i(step), vec2i(0), vec2i(size) - 1);
        let s_mm = inside_mm(map, texel, d_o_mm);
        if s_mm >= 0.0 {
            let shares = select(1.0 - f, f, step == vec2u(1u));
            let weight = shares.x * shares.y;
            let scaled = scaled_mm(s_mm, body.thickness_scale);
            all.light += weight * entered(map, texel) * left(scaled);
            all.distance_mm += weight * scaled;
            all.weight += weight;
        }
    }
    return all;
}

/// Distance through bodies along surfaces in the order in which light meets them, mm; negative if light has not come in. What
/// lies behind the last surface that is told apart is flesh.
fn inside_mm(map: LightMap, texel: vec2i, d_o_mm: f32) -> f32 {
    let first = map.layer * body.layers;
    var sum_mm = 0.0;
    var bodies = 0u;
    var from_mm = 0.0;
    for (var i = 0u; i < body.layers; i++) {
        let stored_mm = textureLoad(distances, texel, first + i, 0).x;
        let enters = stored_mm > 0.0;
        let is_behind = abs(stored_mm) >= d_o_mm;
        if i == 0u && (is_behind || !enters) {
            return -1.0;
        }
        if is_behind {
            return max(sum_mm + select(0.0, from_mm, bodies > 0u), 0.0);
        }
        let before_mm = d_o_mm - abs(stored_mm);
        if bodies > 0u {
            sum_mm += from_mm - before_mm;
        }
        from_mm = before_mm;
        if enters {
            bodies++;
        } else if bodies > 0u {
            bodies--;
        }
    }
    return max(sum_mm + from_mm, 0.0);
}

/// Share of a light's irradiance that has entered; all of it where only the distance counts.
fn entered(map: LightMap, texel: vec2i) -> vec3f {
    if body.by_surface == 0u {
        return vec3f(1.0);
    }
    return textureLoad(entered_map, texel, map.layer, 0).rgb;
}

/// Share of the light that the way through the bodies leaves.
fn left(s_mm: f32) -> vec3f {
    if body.stops == 0u {
        return exp(-body.sigma_t_per_mm * s_mm);
    }
    return at_mm(s_mm);
}

/// Colour of the ramp at a distance.
fn at_mm(distance_mm: f32) -> vec3f {
    var after = 0u;
    var end = body.stops;
    while after < end {
        let middle = (after + end) / 2u;
        if ramp[middle].w <= distance_mm {
            after = middle + 1u;
        } else {
            end = middle;
        }
    }
    let a = ramp[max(after, 1u) - 1u];
    let b = ramp[min(after, body.stops - 1u)];
    if b.w <= a.w {
        return a.rgb;
    }
    return mix(a.rgb, b.rgb, (distance_mm - a.w) / (b.w - a.w));
}

/// Distances through bodies towards the first four lights, mm.
fn distances_at(place: Place) -> vec4f {
    var all_mm = vec4f(0.0);
    for (var l = 0u; l < min(arrayLength(&lights), 4u); l++) {
        if dot(place.smooth_normal, sample_light(l, place.position_mm).dir_to_light) < 0.0 {
            let map = map_of(l);
            var ways = Ways(vec3f(0.0), 0.0, 0.0);
            if map.layer != NO_MAP {
                ways = with_ways_to(ways, map, place.position_mm);
            }
            all_mm[l] = select(NO_WAY_MM, ways.distance_mm / max(ways.weight, 1e-6), ways.weight > 0.0);
        }
    }
    return all_mm;
}
