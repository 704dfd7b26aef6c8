// Even noise of less than a code. The twin of cutis-render's `film::dither`: whole numbers give the same bits.

const TURN_OF_COLUMN = 288237660u;
const TURN_OF_ROW = 25070368u;
const TURN_OF_CHANNEL = 1750839832u;
const STEEPNESS = 54255u;
const WIDTH: f32 = 0.998;

/// What is added to red, green and blue at a place before they are rounded, codes.
fn dither(at: vec2u) -> vec3f {
    let turn = vec3u(at.x * TURN_OF_COLUMN + at.y * TURN_OF_ROW) + vec3u(0u, 1u, 2u) * TURN_OF_CHANNEL;
    let noise = ((turn >> vec3u(16u)) * STEEPNESS) << vec3u(6u);
    return (vec3f(noise >> vec3u(8u)) / 16777216.0 - 0.5) * WIDTH;
}
