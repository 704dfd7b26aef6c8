// rho_dt from the table that cutis-render integrates: the square root of the cosine along x, the roughness along y, and the
// means over the hemisphere in one more column.

const COSINES: f32 = 64.0;
const ROUGHNESSES: f32 = 32.0;
const MIN_ROUGHNESS: f32 = 0.02;

fn rho_dt_row(roughness: f32) -> f32 {
    let y = (clamp(roughness, MIN_ROUGHNESS, 1.0) - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS);
    return (y * (ROUGHNESSES - 1.0) + 0.5) / ROUGHNESSES;
}

/// Directional albedo of the lobe for rho_s = 1.
fn specular_albedo(table: texture_2d<f32>, linear: sampler, cos: f32, roughness: f32) -> f32 {
    let x = sqrt(clamp(cos, 0.0, 1.0)) * (COSINES - 1.0) + 0.5;
    return textureSampleLevel(table, linear, vec2f(x / (COSINES + 1.0), rho_dt_row(roughness)), 0.0).x;
}

fn rho_dt(table: texture_2d<f32>, linear: sampler, cos: f32, roughness: f32, rho_s: f32) -> f32 {
    return max(1.0 - rho_s * specular_albedo(table, linear, cos, roughness), 0.0);
}

/// rho_dt for light that comes evenly from the whole hemisphere.
fn mean_rho_dt(table: texture_2d<f32>, linear: sampler, roughness: f32, rho_s: f32) -> f32 {
    let place = vec2f((COSINES + 0.5) / (COSINES + 1.0), rho_dt_row(roughness));
    return max(1.0 - rho_s * textureSampleLevel(table, linear, place, 0.0).x, 0.0);
}
