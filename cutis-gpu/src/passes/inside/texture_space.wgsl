// Light that was spread in texture space: the twin of cutis-render's `texture_space`.

/// Sum of the kernel's Gaussians.
@group(0) @binding(30) var local: texture_2d<f32>;
@group(0) @binding(31) var half_charts: texture_2d<u32>;
@group(0) @binding(32) var transmission: texture_2d<f32>;

fn exitance_at(place: Place, texels: Around, weights: vec4f) -> Exitance {
    let half_texels = around(place.atlas_uv, textureDimensions(transmission));
    let half_weights = chart_weights(half_charts, half_texels, place.chart);
    return Exitance(
        blend(local, texels, weights).rgb,
        blend(transmission, half_texels, half_weights).rgb,
    );
}

fn shine_at(place: Place, texels: Around, weights: vec4f) -> vec3f {
    return shine_of_lights(place, texels, weights);
}

/// Distances are those of the lights' maps.
fn distances_at(place: Place) -> vec4f {
    return vec4f(0.0);
}
