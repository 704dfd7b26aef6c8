//! How wide the texels of light lie on the surface: where they are slivers, or far wider than elsewhere, light is less true.

use crate::passes::heat_flow::metric::{Metric, derivatives_mm_per_texel};
use cutis_scene::Object;

/// Part of the surface at either end whose texels are not told: a few slivers hide in every atlas.
const LEFT_OUT: f64 = 0.01;

/// Widths of texels, mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TexelWidths {
    /// The narrower way across texels under all but 1 % of the surface is no less than this.
    pub narrowest_mm: f64,
    /// The wider way across texels under all but 1 % of the surface is no more than this.
    pub widest_mm: f64,
    /// All of them, if charts shared what they have of the texture evenly.
    pub even_mm: f64,
}

impl TexelWidths {
    /// Of maps of `size` texels along each side. All are 0 where nothing has an area in the texture.
    pub fn new(object: &Object, size: usize) -> Self {
        let (mut narrow, mut wide) = (Vec::new(), Vec::new());
        let (mut surface_mm2, mut texels) = (0.0, 0.0);
        for triangle in 0..object.mesh.triangles.len() {
            let Some(x) = derivatives_mm_per_texel(object, triangle, size) else { continue };
            let metric = Metric::new(x);
            let area_mm2 = f64::from(object.mesh.area_mm2(triangle));
            if metric.area_mm2 > 0.0 {
                surface_mm2 += area_mm2;
                texels += area_mm2 / f64::from(metric.area_mm2);
                narrow.push((f64::from(metric.narrowest_mm()), area_mm2));
                wide.push((f64::from(metric.widest_mm()), area_mm2));
            }
        }
        if surface_mm2 <= 0.0 {
            return Self { narrowest_mm: 0.0, widest_mm: 0.0, even_mm: 0.0 };
        }
        Self {
            narrowest_mm: quantile(narrow, LEFT_OUT * surface_mm2),
            widest_mm: quantile(wide, (1.0 - LEFT_OUT) * surface_mm2),
            even_mm: (surface_mm2 / texels).sqrt(),
        }
    }
}

/// The width up to which triangles have that area together.
fn quantile(mut widths: Vec<(f64, f64)>, area_mm2: f64) -> f64 {
    widths.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut sum = 0.0;
    let reached = widths.iter().find(|(_, own_mm2)| {
        sum += own_mm2;
        sum >= area_mm2
    });
    reached.or(widths.last()).map_or(0.0, |(width, _)| *width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Material, Mesh};
    use glam::{Vec2, Vec3};

    /// Strips of 8 mm by 1 mm in a texture of 64 texels, each with its share of it; turned by an angle there.
    fn strips(shares: &[Vec2], angle: f32) -> Object {
        let mut mesh = Mesh::default();
        for (i, share) in shares.iter().enumerate() {
            let first = mesh.positions_mm.len() as u32;
            for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
                mesh.positions_mm.push(Vec3::new(8.0 * corner.x, corner.y, 5.0 * i as f32));
                mesh.uvs.push(0.4 + Vec2::from_angle(angle).rotate(corner * *share));
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first + 1, first + 3, first + 2]]);
        }
        Object::new("strips", mesh, Material::default())
    }

    /// A strip of 8 mm on 32 texels, and of 1 mm on 8, however it lies.
    #[test]
    fn both_widths_are_told_whatever_the_direction() {
        for angle in [0.0, 0.3, 1.0] {
            let TexelWidths { narrowest_mm, widest_mm, even_mm } =
                TexelWidths::new(&strips(&[Vec2::new(0.5, 0.125)], angle), 64);
            assert!((narrowest_mm - 0.125).abs() < 1e-5, "{narrowest_mm}");
            assert!((widest_mm - 0.25).abs() < 1e-5, "{widest_mm}");
            assert!((even_mm - (0.125f64 * 0.25).sqrt()).abs() < 1e-5, "{even_mm}");
        }
    }

    /// One of 200 strips with texels a hundred times as narrow is left out, three of them are not.
    #[test]
    fn a_few_slivers_are_not_told() {
        let (usual, narrow) = (Vec2::new(0.125, 0.0625), Vec2::new(0.125, 6.25));
        let with = |count: usize| {
            let shares: Vec<Vec2> = (0..200).map(|i| if i < count { narrow } else { usual }).collect();
            TexelWidths::new(&strips(&shares, 0.0), 64).narrowest_mm
        };
        assert!((with(1) - 0.25).abs() < 1e-5 && (with(3) - 0.0025).abs() < 1e-5, "{} {}", with(1), with(3));
    }
}
