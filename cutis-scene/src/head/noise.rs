//! Noise in space: smooth lattice noise and cells, both from integer hashes, so that every run gives the same skin.

use glam::{IVec3, Vec3};

/// 32 well-mixed bits for a lattice point (finaliser by Wellons, "hash-prospector"; from memory).
fn hash(cell: IVec3, seed: u32) -> u32 {
    // Three large odd primes keep neighbouring cells apart before mixing.
    let mut h = (cell.x as u32).wrapping_mul(0x9e37_79b1)
        ^ (cell.y as u32).wrapping_mul(0x85eb_ca77)
        ^ (cell.z as u32).wrapping_mul(0xc2b2_ae3d)
        ^ seed.wrapping_mul(0x27d4_eb2f);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

/// Largest whole numbers not above; by casts, since the library's `floor` is a call on plain x86-64.
fn floor(p: Vec3) -> IVec3 {
    let cut = p.as_ivec3();
    let step = |cut: i32, p: f32| i32::from(cut as f32 > p);
    cut - IVec3::new(step(cut.x, p.x), step(cut.y, p.y), step(cut.z, p.z))
}

/// Smooth noise, about -1 to 1 with mean 0; features as large as the unit of `p`.
pub fn lattice(p: Vec3, seed: u32) -> f32 {
    let cell = floor(p);
    let t = p - cell.as_vec3();
    let w = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let value = |x, y, z| hash(cell + IVec3::new(x, y, z), seed) as f32 * (2.0 / u32::MAX as f32) - 1.0;
    let row = |y, z| value(0, y, z) + (value(1, y, z) - value(0, y, z)) * w.x;
    let layer = |z| row(0, z) + (row(1, z) - row(0, z)) * w.y;
    layer(0) + (layer(1) - layer(0)) * w.z
}

/// Octaves of [`lattice`], each half as large and half as strong as the one before.
pub fn octaves(p: Vec3, count: u32, seed: u32) -> f32 {
    (0..count).fold((0.0, 1.0), |(sum, scale), i| (sum + lattice(p / scale, seed + i) * scale, scale * 0.5)).0
}

/// What a point sees of points strewn one to a unit cell.
pub struct Cells {
    /// Distance to the nearest.
    pub nearest: f32,
    /// Distance to the second nearest.
    pub second: f32,
    /// A number in 0..1 that belongs to the nearest.
    pub id: f32,
}

/// Cellular noise (Worley 1996) over the eight cells around the nearest lattice corner: a strewn point is off its
/// cell's middle by up to 0.3, so the nearest is always found and the second nearest nearly so.
pub fn cells(p: Vec3, seed: u32) -> Cells {
    let corner = floor(p - 0.5);
    let mut found = Cells { nearest: f32::MAX, second: f32::MAX, id: 0.0 };
    for i in 0..8 {
        let cell = corner + IVec3::new(i & 1, i >> 1 & 1, i >> 2);
        let h = hash(cell, seed);
        let jitter = Vec3::new((h & 1023) as f32, (h >> 10 & 1023) as f32, (h >> 20 & 1023) as f32) / 1023.0;
        let d = (cell.as_vec3() + 0.5 + (jitter - 0.5) * 0.6 - p).length();
        if d < found.nearest {
            found = Cells { nearest: d, second: found.nearest, id: (h >> 8 & 4095) as f32 / 4095.0 };
        } else {
            found.second = found.second.min(d);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_centred_and_continuous() {
        let points: Vec<Vec3> = (0..4000).map(|i| Vec3::new(0.37, 0.11, 0.53) * i as f32).collect();
        let mean = points.iter().map(|&p| lattice(p, 1)).sum::<f32>() / 4000.0;
        // The standard deviation is about 0.35; neighbouring samples are nearly independent: 5 sigma.
        assert!(mean.abs() < 5.0 * 0.35 / 4000f32.sqrt(), "{mean}");
        assert!(points.iter().all(|&p| (lattice(p, 1) - lattice(p + 1e-3, 1)).abs() < 0.02));
    }

    #[test]
    fn the_second_cell_is_not_nearer_than_the_first() {
        assert!((0..1000).map(|i| cells(Vec3::splat(0.173 * i as f32), 3)).all(|c| c.second >= c.nearest));
    }
}
