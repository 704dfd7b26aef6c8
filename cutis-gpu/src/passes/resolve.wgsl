// The final pass: from blurred irradiance to radiance at every sample of the picture
// (d'Eon, Luebke & Enderton 2007, section 5.4, "Render final image").
//
// Bindings from 30 on belong to the technique: `passes/inside` has what leaves a body at a place, `exitance_at`, and what the
// surface reflects from the lights, `shine_at`.

@group(0) @binding(0) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<uniform> camera: Camera;
@group(0) @binding(3) var<storage, read> lights: array<Light>;
@group(0) @binding(4) var<uniform> material: Material;
@group(0) @binding(5) var<uniform> environment: Environment;
@group(0) @binding(6) var charts: texture_2d<u32>;
@group(0) @binding(10) var visibility: texture_2d_array<f32>;
@group(0) @binding(11) var ambient: texture_2d<f32>;
@group(0) @binding(12) var ambient_charts: texture_2d<u32>;
@group(0) @binding(13) var reflections: texture_2d_array<f32>;
@group(0) @binding(14) var rho_dt_table: texture_2d<f32>;
@group(0) @binding(15) var albedo_map: texture_2d<f32>;
@group(0) @binding(16) var relief_map: texture_2d<f32>;
@group(0) @binding(17) var rho_s_map: texture_2d<f32>;
@group(0) @binding(18) var roughness_map: texture_2d<f32>;
@group(0) @binding(19) var linear: sampler;
@group(0) @binding(20) var repeating: sampler;
@group(0) @binding(21) var around_sky: sampler;

/// A point on the surface, and what is needed of its material.
struct Place {
    position_mm: vec3f,
    smooth_normal: vec3f,
    normal: vec3f,
    dir_to_eye: vec3f,
    /// In the maps of light.
    atlas_uv: vec2f,
    chart: u32,
    albedo: vec3f,
    rho_s: f32,
    roughness: f32,
    /// The sample of the picture.
    sample: vec2u,
}

/// Light that leaves at a place after it has been inside, before the film of the surface filters it, W/m².
struct Exitance {
    /// What entered close by.
    local: vec3f,
    /// What entered on another side and came through.
    transmitted: vec3f,
}

/// The parts that make up the radiance at a point.
struct Parts {
    /// Before any eye looks, W/m².
    exitance: vec3f,
    diffuse: vec3f,
    transmission: vec3f,
    specular: vec3f,
}

@fragment
fn shade(seen: Seen) -> @location(0) vec4f {
    let parts = parts_at(place_at(seen));
    return vec4f(parts.diffuse + parts.transmission + parts.specular, 1.0);
}

fn place_at(seen: Seen) -> Place {
    let map_uv = seen.map_uv;
    let smooth_normal = unit_or(seen.normal, vec3f(0.0, 1.0, 0.0));
    let stored = textureSampleLevel(relief_map, repeating, map_uv, 0.0).xyz;
    let dir_to_eye = normalize(camera.position_mm - seen.position_mm);
    let relief = with_relief(material, stored, smooth_normal, seen.tangent);
    return Place(
        seen.position_mm,
        smooth_normal,
        towards_eye(relief, dir_to_eye),
        dir_to_eye,
        seen.atlas_uv,
        seen.chart,
        material.albedo_factor * textureSampleLevel(albedo_map, repeating, map_uv, 0.0).rgb,
        scalar_at(material.rho_s, textureSampleLevel(rho_s_map, repeating, map_uv, 0.0)),
        scalar_at(material.roughness, textureSampleLevel(roughness_map, repeating, map_uv, 0.0)),
        vec2u(seen.position.xy),
    );
}

fn shine_of(place: Place) -> Shine {
    return Shine(place.normal, place.dir_to_eye, place.rho_s, place.roughness, material.f0);
}

/// The sums of the paper's final pass.
fn parts_at(place: Place) -> Parts {
    let texels = around(place.atlas_uv, textureDimensions(charts));
    let weights = chart_weights(charts, texels, place.chart);
    let leaves = exitance_at(place, texels, weights);
    // On the way out: the film once more, rho_dt towards the eye, and the even spread of exitance over directions.
    let film_out = film(place.albedo, 1.0 - material.albedo_mix);
    let cos_eye = dot(place.normal, place.dir_to_eye);
    let leaving = film_out * (rho_dt(rho_dt_table, linear, cos_eye, place.roughness, place.rho_s) / PI);
    return Parts(
        (leaves.local + leaves.transmitted) * film_out,
        leaves.local * leaving,
        leaves.transmitted * leaving,
        shine_at(place, texels, weights) + from_surroundings(place, shine_of(place)),
    );
}

/// Radiance reflected from all lights by the lobe of skin, W/(m² sr).
fn shine_of_lights(place: Place, texels: Around, weights: vec4f) -> vec3f {
    let shine = shine_of(place);
    var sum = vec3f(0.0);
    var l = 0u;
    loop {
        let towards = sample_light(l, place.position_mm);
        if dot(place.smooth_normal, towards.dir_to_light) >= 0.0 {
            sum += from_light(shine, towards) * visible_part(l, texels, weights);
        }
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    return sum;
}

/// Fraction of light number `l` that is seen.
fn visible_part(l: u32, texels: Around, weights: vec4f) -> f32 {
    return blend_layer(visibility, l / 4u, texels, weights)[l % 4u];
}

/// Radiance reflected from the environment, of which some may be hidden, W/(m² sr).
fn from_surroundings(place: Place, shine: Shine) -> vec3f {
    let texels = around(place.atlas_uv, textureDimensions(ambient));
    let weights = chart_weights(ambient_charts, texels, place.chart);
    let covered = any(weights > vec4f(0.0));
    let value = select(vec4f(place.smooth_normal, 1.0), blend(ambient, texels, weights), covered);
    let bent = unit_or(shine.normal + unit_or(value.xyz, place.smooth_normal) - place.smooth_normal, shine.normal);
    let cos_eye = max(dot(shine.normal, shine.dir_to_eye), 0.0);
    let mirrored = shine.normal * (2.0 * dot(shine.normal, shine.dir_to_eye)) - shine.dir_to_eye;
    let albedo = shine.rho_s * specular_albedo(rho_dt_table, linear, cos_eye, shine.roughness);
    let seen = lobe_openness(dot(shine.normal, mirrored), dot(bent, mirrored), shine.roughness, value.w);
    return reflection(mirrored, shine.roughness) * (albedo * seen);
}

/// Mean radiance over the specular lobe around a mirror direction.
fn reflection(dir: vec3f, roughness: f32) -> vec3f {
    let uv = latlong_uv(environment, dir);
    var upper = 4u;
    var hi = environment.last_roughness;
    for (var i = 3u; i >= 1u; i--) {
        if environment.roughnesses[i] >= roughness {
            upper = i;
            hi = environment.roughnesses[i];
        }
    }
    let lo = environment.roughnesses[upper - 1u];
    let a = textureSampleLevel(reflections, around_sky, uv, upper - 1u, 0.0).rgb;
    let b = textureSampleLevel(reflections, around_sky, uv, upper, 0.0).rgb;
    return mix(a, b, clamp((roughness - lo) / (hi - lo), 0.0, 1.0));
}

/// Relief may tip a normal away from the eye at the silhouette; tip it back until it is seen edge-on.
fn towards_eye(normal: vec3f, dir_to_eye: vec3f) -> vec3f {
    let cos = dot(normal, dir_to_eye);
    // A hair above 0 keeps the half vector and rho_dt defined.
    if cos >= 1e-3 {
        return normal;
    }
    return unit_or(normal + dir_to_eye * (1e-3 - cos), dir_to_eye);
}
