//! The look-up table of wrap lighting (Green 2004, listing 16-1): N·L along x and N·H along y, both from -1 to 1; light per
//! irradiance in rgb, the specular power in alpha. Both backends read the same one.

use crate::technique::wrap::WrapSettings;
use glam::{Vec2, Vec3, Vec4};

/// Entries along each side: the tint, 0.3 of the wrapped cosine wide, is met by 46 of them.
pub const SIZE: usize = 256;

/// The table for one wrap of each channel.
#[derive(Debug, Clone)]
pub struct SkinTable {
    /// [`SIZE`]² entries, rows of N·L; an entry holds the value at its middle.
    pub entries: Vec<Vec4>,
}

impl SkinTable {
    /// Evaluates the function at every entry.
    pub fn new(settings: &WrapSettings, wraps: Vec3) -> Self {
        let cos = |i: usize| 2.0 * (i as f32 + 0.5) / SIZE as f32 - 1.0;
        let entry = |i: usize| settings.light(wraps, cos(i % SIZE), cos(i / SIZE));
        Self { entries: (0..SIZE * SIZE).map(entry).collect() }
    }

    /// Bilinear read; the edge goes on outside.
    pub fn at(&self, cos_light: f32, cos_half: f32) -> Vec4 {
        let place = Vec2::new(0.5 + 0.5 * cos_light, 0.5 + 0.5 * cos_half) * SIZE as f32 - 0.5;
        let place = place.clamp(Vec2::ZERO, Vec2::splat(SIZE as f32 - 1.0));
        let corner = place.floor().min(Vec2::splat(SIZE as f32 - 2.0));
        let f = place - corner;
        let first = corner.y as usize * SIZE + corner.x as usize;
        let row = |first: usize| self.entries[first].lerp(self.entries[first + 1], f.x);
        row(first).lerp(row(first + SIZE), f.y)
    }
}

/// 0 up to `from`, 1 from `to` on, 3 t² - 2 t³ between; a step where both are one.
pub(crate) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    if from >= to {
        return f32::from(x >= to);
    }
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_formula_but_for_kinks_and_curvature() {
        let settings = WrapSettings::default();
        let wraps = Vec3::new(0.4, 0.2, 0.0);
        let table = SkinTable::new(&settings, wraps);
        // Between the middles of the outermost entries.
        let end = 1.0 - 1.0 / SIZE as f32;
        let entry = 2.0 / SIZE as f32;
        let (mut worst, mut worst_power) = (Vec3::ZERO, 0.0f32);
        for i in 0..=400 {
            for j in 0..=40 {
                let (cos_light, cos_half) = ((i as f32 / 200.0 - 1.0) * end, (j as f32 / 20.0 - 1.0) * end);
                let exact = settings.light(wraps, cos_light, cos_half);
                let off = (table.at(cos_light, cos_half) - exact).abs();
                worst = worst.max(off.truncate());
                // The power begins with a step where light does.
                if (cos_light + wraps.max_element()).abs() > entry {
                    worst_power = worst_power.max(off.w);
                }
            }
        }
        eprintln!("table: light off by {worst:?}, power by {worst_power} at most");
        // At the kink of the cosine a quarter of what an entry rises by; the smooth step of the tint bends by 6 · 0.15/0.3²
        // per squared cosine, an eighth of which times the entry's square is 8e-5.
        assert!(worst.max_element() < 0.25 * entry + 1e-4, "{worst}");
        // The power bends by 40 · 39 at most.
        assert!(worst_power < 40.0 * 39.0 * entry * entry / 8.0 + 1e-4, "{worst_power}");
    }
}
