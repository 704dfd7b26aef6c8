// Irradiance under the surface, in texture space, with the distance through the body beside it
// (d'Eon, Luebke & Enderton 2007, section 5.4, "Render irradiance texture").

@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var<uniform> material: Material;
@group(0) @binding(3) var<uniform> environment: Environment;
@group(0) @binding(4) var places: texture_2d<u32>;
@group(0) @binding(5) var reliefs: texture_2d<u32>;
@group(0) @binding(6) var charts: texture_2d<u32>;
@group(0) @binding(7) var visibility: texture_2d_array<f32>;
@group(0) @binding(8) var distances_mm: texture_2d_array<f32>;
@group(0) @binding(9) var ambient: texture_2d<f32>;
@group(0) @binding(10) var ambient_charts: texture_2d<u32>;
@group(0) @binding(11) var irradiance_map: texture_2d<f32>;
@group(0) @binding(12) var rho_dt_table: texture_2d<f32>;
@group(0) @binding(13) var albedo_map: texture_2d<f32>;
@group(0) @binding(14) var rho_s_map: texture_2d<f32>;
@group(0) @binding(15) var roughness_map: texture_2d<f32>;
@group(0) @binding(16) var linear: sampler;
@group(0) @binding(17) var repeating: sampler;
@group(0) @binding(18) var around_sky: sampler;
/// Of every texel, in the material's maps and in those of light.
@group(0) @binding(19) var coordinates: texture_2d<u32>;

@fragment
fn light_texel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let place = textureLoad(places, texel, 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(textureLoad(reliefs, texel, 0).x);
    let own = textureLoad(coordinates, texel, 0);
    let map_uv = unpack2x16unorm(own.x);
    let rho_s = scalar_at(material.rho_s, textureSampleLevel(rho_s_map, repeating, map_uv, 0.0));
    let roughness = scalar_at(material.roughness, textureSampleLevel(roughness_map, repeating, map_uv, 0.0));
    var light_in = vec3f(0.0);
    var l = 0u;
    loop {
        let towards = sample_light(l, point_mm);
        let visible = textureLoad(visibility, texel, l / 4u, 0)[l % 4u];
        // Relief may turn a normal away from a light that the smooth surface faces.
        let cos = max(dot(normal, towards.dir_to_light), 0.0);
        let entered = cos * visible * rho_dt(rho_dt_table, linear, cos, roughness, rho_s);
        light_in += towards.irradiance_w_per_m2 * entered;
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    let smooth_normal = unpack_unit(place.w);
    light_in += from_environment(unpack2x16unorm(own.y), chart, smooth_normal, normal)
        * mean_rho_dt(rho_dt_table, linear, roughness, rho_s);
    let albedo = material.albedo_factor * textureSampleLevel(albedo_map, repeating, map_uv, 0.0).rgb;
    let distance_mm = textureLoad(distances_mm, texel, 0, 0).x;
    return vec4f(light_in * film(albedo, material.albedo_mix), distance_mm);
}
