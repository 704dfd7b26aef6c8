// The share of each of four lights in what falls in from all lights, texel by texel: light that comes through the body is
// counted once for every light.

@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var<uniform> group_of: Group;
@group(0) @binding(3) var<uniform> material: Material;
@group(0) @binding(4) var places: texture_2d<u32>;
@group(0) @binding(5) var reliefs: texture_2d<u32>;
@group(0) @binding(6) var visibility: texture_2d_array<f32>;
@group(0) @binding(7) var rho_dt_table: texture_2d<f32>;
@group(0) @binding(8) var rho_s_map: texture_2d<f32>;
@group(0) @binding(9) var roughness_map: texture_2d<f32>;
@group(0) @binding(10) var linear: sampler;
@group(0) @binding(11) var repeating: sampler;
/// Of every texel, in the material's maps and in those of light.
@group(0) @binding(12) var coordinates: texture_2d<u32>;

struct Group {
    first_light: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

@fragment
fn share_lights(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let point_mm = bitcast<vec3f>(textureLoad(places, texel, 0).xyz);
    let normal = unpack_unit(textureLoad(reliefs, texel, 0).x);
    let map_uv = unpack2x16unorm(textureLoad(coordinates, texel, 0).x);
    let rho_s = scalar_at(material.rho_s, textureSampleLevel(rho_s_map, repeating, map_uv, 0.0));
    let roughness = scalar_at(material.roughness, textureSampleLevel(roughness_map, repeating, map_uv, 0.0));
    var whole = 0.0;
    var shares = vec4f(0.0);
    for (var l = 0u; l < arrayLength(&lights); l++) {
        let towards = sample_light(l, point_mm);
        let visible = textureLoad(visibility, texel, l / 4u, 0)[l % 4u];
        let cos = max(dot(normal, towards.dir_to_light), 0.0);
        let entered = dot(towards.irradiance_w_per_m2, vec3f(1.0)) * cos * visible
            * rho_dt(rho_dt_table, linear, cos, roughness, rho_s);
        whole += entered;
        if l >= group_of.first_light && l < group_of.first_light + 4u {
            shares[l - group_of.first_light] = entered;
        }
    }
    return shares / max(whole, 1e-30);
}
