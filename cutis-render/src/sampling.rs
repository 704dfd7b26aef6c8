//! Sample patterns and the random numbers they are turned by. All are functions of the seed and of where they are
//! used, never of a thread, so that a picture has the same bits on any number of cores.

use glam::{DVec2, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, TAU};

/// A hash of four numbers that passes for random: PCG4D (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering",
/// JCGT 9(3), listing in section 3).
pub fn pcg4d(v: [u32; 4]) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] = v.map(|c| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        if round == 0 {
            [x, y, z, w] = [x, y, z, w].map(|c| c ^ (c >> 16));
        }
    }
    [x, y, z, w]
}

/// Two numbers in [0, 1) for a place (`x`, `y`), a use (`stream`) and a seed.
pub fn random2(x: u32, y: u32, stream: u32, seed: u64) -> Vec2 {
    let [a, b, ..] = pcg4d([x, y, stream ^ (seed >> 32) as u32, seed as u32]);
    Vec2::new(unit_float(a), unit_float(b))
}

/// The upper 24 bits as a float in [0, 1).
fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

/// Point `index` of the two-dimensional R2 sequence (Roberts 2018: multiples of the plastic number's powers), shifted
/// by `shift` and wrapped to the unit square.
pub fn r2_point(index: u32, shift: Vec2) -> Vec2 {
    // In f32 the multiples of late indices would lose the digits that matter.
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053_3);
    ((STEP * f64::from(index)).fract().as_vec2() + shift).fract()
}

/// Unit square to unit disc, keeping areas (Shirley & Chiu 1997, concentric map).
pub fn disc(square: Vec2) -> Vec2 {
    let p = square * 2.0 - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle_rad) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (p.x / p.y))
    };
    Vec2::from_angle(angle_rad) * radius
}

/// Direction around `normal` with density cos / pi.
pub fn cosine_hemisphere(square: Vec2, normal: Vec3) -> Vec3 {
    let d = disc(square);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let height = (1.0 - d.length_squared()).max(0.0).sqrt();
    tangent * d.x + bitangent * d.y + normal * height
}

/// Direction of half vectors about +z that follow Beckmann's distribution weighted by the cosine:
/// tan² theta = -m² ln(1 - u).
pub fn beckmann_half_vector(square: Vec2, roughness: f32) -> Vec3 {
    let tan2 = -roughness * roughness * (1.0 - square.x).ln();
    let cos = 1.0 / (1.0 + tan2).sqrt();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * square.y).sin_cos();
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_fill_the_unit_square_evenly() {
        // Mean and variance of 65,536 uniform numbers: standard errors 1/sqrt(12 n) = 1.1e-3 and sqrt(1/180 n) = 2.9e-4;
        // four of each leaves a false alarm below 1 in 10,000 for the one fixed seed.
        let points: Vec<_> = (0..65_536u32).map(|i| random2(i % 256, i / 256, 3, 7)).collect();
        let mean = points.iter().copied().sum::<Vec2>() / 65_536.0;
        let variance = points.iter().map(|&p| (p - mean) * (p - mean)).sum::<Vec2>() / 65_536.0;
        assert!((mean - 0.5).abs().max_element() < 4.5e-3, "{mean}");
        assert!((variance - 1.0 / 12.0).abs().max_element() < 1.2e-3, "{variance}");
    }

    #[test]
    fn cosine_directions_have_the_moments_of_the_cosine() {
        // E[cos] = 2/3 and E[cos²] = 1/2 for density cos/pi; R2 points integrate smooth functions to about 1/n.
        let n = 4096;
        let cosines = (0..n).map(|i| cosine_hemisphere(r2_point(i, Vec2::splat(0.5)), Vec3::Y).y);
        let (first, second) = cosines.fold((0.0, 0.0), |(a, b), c| (a + c, b + c * c));
        assert!((first / n as f32 - 2.0 / 3.0).abs() < 2e-3, "{}", first / n as f32);
        assert!((second / n as f32 - 0.5).abs() < 2e-3, "{}", second / n as f32);
    }

    #[test]
    fn the_disc_is_covered_evenly() {
        let n = 4096;
        let inside = (0..n).filter(|&i| disc(r2_point(i, Vec2::ZERO)).length() < 0.5).count();
        assert!((inside as f32 / n as f32 - 0.25).abs() < 5e-3, "{inside}");
    }
}
