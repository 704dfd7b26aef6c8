// What falls on a place from all around: the twin of `from_environment` in cutis-render's pass `irradiance`.

fn from_environment(atlas_uv: vec2f, chart: u32, smooth_normal: vec3f, normal: vec3f) -> vec3f {
    let texels = around(atlas_uv, textureDimensions(ambient));
    let weights = chart_weights(ambient_charts, texels, chart);
    var bent = smooth_normal;
    var open = 1.0;
    if any(weights > vec4f(0.0)) {
        let value = blend(ambient, texels, weights);
        bent = unit_or(value.xyz, smooth_normal);
        open = value.w;
    }
    // The relief turns the bent normal as it turns the smooth one.
    let dir = unit_or(normal + bent - smooth_normal, normal);
    return textureSampleLevel(irradiance_map, around_sky, latlong_uv(environment, dir), 0.0).rgb * open;
}
