// Light that was gathered from images of the irradiance, sample by sample of the picture: the twin of cutis-render's
// `image_space`. The pass `sample profile` has gathered it.

/// What entered where the camera sees it, in layer 0, and elsewhere, in layer 1.
@group(0) @binding(30) var gathered: texture_2d_array<f32>;

fn exitance_at(place: Place, texels: Around, weights: vec4f) -> Exitance {
    let sample = vec2i(place.sample);
    return Exitance(textureLoad(gathered, sample, 0, 0).rgb, textureLoad(gathered, sample, 1, 0).rgb);
}

fn shine_at(place: Place, texels: Around, weights: vec4f) -> vec3f {
    return shine_of_lights(place, texels, weights);
}

/// Distances are those of the lights' maps.
fn distances_at(place: Place) -> vec4f {
    return vec4f(0.0);
}
