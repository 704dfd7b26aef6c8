// The irradiance as an image, with place and normal of what is seen: by the camera or by a light. The twin of cutis-render's
// pass `irradiance_image`; it has the bindings of the final pass.

@group(0) @binding(40) var<uniform> drawn: Drawn;
@group(0) @binding(41) var share_map: texture_2d<f32>;
@group(0) @binding(32) var irradiance_map: texture_2d<f32>;

const HALF_PI: f32 = 1.5707964;

struct Image {
    /// Place in xyz, mm; in w, packed, a normal, that of the triangle or of the smooth surface, and the place in the row
    /// of mixtures.
    @location(0) place: vec4u,
    /// Irradiance, W/m², and the number of the object and one in w.
    @location(1) light: vec4f,
}

@vertex
fn see_from_light(@builtin(vertex_index) index: u32) -> Seen {
    let triangle = triangles[index / 3u];
    let vertex = vertices[triangle[index % 3u]];
    let map = map_of(drawn.light);
    let position = on_map(map, in_map_axes(map, vertex.position_mm));
    return Seen(position, vertex.position_mm, vertex.normal, vertex.tangent, vec2f(vertex.map_u, vertex.map_v),
        vertex.atlas_uv, triangle.w);
}

@fragment
fn light_image(seen: Seen) -> Image {
    let smooth_normal = unit_or(seen.normal, vec3f(0.0, 1.0, 0.0));
    let across = cross(dpdx(seen.position_mm), dpdy(seen.position_mm));
    let flat_normal = unit_or(across * select(-1.0, 1.0, dot(across, smooth_normal) > 0.0), smooth_normal);
    let normal = select(flat_normal, smooth_normal, drawn.smooth_plane != 0u);
    let share = clamp(scalar_at(material.share, textureSampleLevel(share_map, repeating, seen.map_uv, 0.0)), 0.0, 1.0);
    // Its place in the row of mixtures, which lie closer at both ends.
    let mixture = asin(sqrt(share)) / HALF_PI;
    let place = vec4u(bitcast<vec3u>(seen.position_mm), pack_unit_and_share(normal, mixture));
    return Image(place, vec4f(irradiance_at(seen, smooth_normal), f32(drawn.object + 1u)));
}

/// Irradiance under the surface, W/m².
fn irradiance_at(seen: Seen, smooth_normal: vec3f) -> vec3f {
    let map_uv = seen.map_uv;
    let stored = textureSampleLevel(relief_map, repeating, map_uv, 0.0).xyz;
    let normal = with_relief(material, stored, smooth_normal, seen.tangent);
    let rho_s = scalar_at(material.rho_s, textureSampleLevel(rho_s_map, repeating, map_uv, 0.0));
    let roughness = scalar_at(material.roughness, textureSampleLevel(roughness_map, repeating, map_uv, 0.0));
    let texels = around(seen.atlas_uv, textureDimensions(charts));
    let weights = chart_weights(charts, texels, seen.chart);
    var sum = from_environment(seen.atlas_uv, seen.chart, smooth_normal, normal)
        * mean_rho_dt(rho_dt_table, linear, roughness, rho_s);
    var l = 0u;
    loop {
        let towards = sample_light(l, seen.position_mm);
        let cos = max(dot(normal, towards.dir_to_light), 0.0);
        let enters = cos * visible_part(l, texels, weights) * rho_dt(rho_dt_table, linear, cos, roughness, rho_s);
        sum += towards.irradiance_w_per_m2 * enters;
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    let albedo = material.albedo_factor * textureSampleLevel(albedo_map, repeating, map_uv, 0.0).rgb;
    return sum * film(albedo, material.albedo_mix);
}
