//! Which triangle owns which texel, and where in space every texel lies.

use crate::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels beyond the border of a chart that are filled as its continuation.
const MARGIN: usize = 5;
/// Owner of a texel far from every chart.
pub const NOBODY: u32 = u32::MAX;

/// A texture's view of the surface.
pub struct TexelMap {
    /// Width and height.
    pub size: u32,
    /// Triangle of each texel, row by row.
    pub owner: Vec<u32>,
}

impl TexelMap {
    /// Finds the owners of `size`² texels; charts are continued a few texels into the gutter.
    pub fn new(object: &Object, size: u32) -> Self {
        let mut map = Self { size, owner: vec![NOBODY; (size * size) as usize] };
        for t in 0..object.mesh.triangles.len() {
            map.claim(t as u32, object.mesh.corner_map_uvs(t).map(|uv| uv * size as f32 - 0.5));
        }
        for _ in 0..MARGIN {
            map.grow();
        }
        map
    }

    fn claim(&mut self, triangle: u32, corners: [Vec2; 3]) {
        let [a, b, c] = corners;
        let area = (b - a).perp_dot(c - a);
        let (lo, hi) = (
            a.min(b).min(c).ceil().max(Vec2::ZERO),
            a.max(b).max(c).min(Vec2::splat(self.size as f32 - 1.0)),
        );
        for y in lo.y as u32..(hi.y + 1.0) as u32 {
            for x in lo.x as u32..(hi.x + 1.0) as u32 {
                let p = Vec2::new(x as f32, y as f32);
                let weight = |s: Vec2, e: Vec2| (e - s).perp_dot(p - s) / area;
                if weight(a, b) >= 0.0 && weight(b, c) >= 0.0 && weight(c, a) >= 0.0 {
                    self.owner[(y * self.size + x) as usize] = triangle;
                }
            }
        }
    }

    /// Gives every ownerless texel the owner of a neighbour.
    fn grow(&mut self) {
        let (n, old) = (self.size as usize, self.owner.clone());
        self.owner.par_iter_mut().enumerate().filter(|(_, o)| **o == NOBODY).for_each(|(i, owner)| {
            let (x, y) = (i % n, i / n);
            let around = [
                (x > 0).then(|| old[i - 1]),
                (x + 1 < n).then(|| old[i + 1]),
                (y > 0).then(|| old[i - n]),
                (y + 1 < n).then(|| old[i + n]),
            ];
            *owner = around.into_iter().flatten().find(|&o| o != NOBODY).unwrap_or(NOBODY);
        });
    }

    /// The owner of a texel and the barycentric weights of its second and third corner; outside the triangle they
    /// continue its plane.
    pub fn place(&self, object: &Object, texel: usize) -> Option<(u32, f32, f32)> {
        let t = self.owner[texel];
        if t == NOBODY {
            return None;
        }
        let [a, b, c] = object.mesh.corner_map_uvs(t as usize);
        let p = Vec2::new((texel as u32 % self.size) as f32 + 0.5, (texel as u32 / self.size) as f32 + 0.5)
            / self.size as f32;
        let area = (b - a).perp_dot(c - a);
        Some((t, (p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area))
    }

    /// Position of every owned texel on (or beside) its triangle, mm; NaN for the others.
    pub fn positions_mm(&self, object: &Object) -> Vec<Vec3> {
        let of = |texel| {
            self.place(object, texel).map_or(Vec3::NAN, |(t, b1, b2)| {
                let [a, b, c] = object.mesh.corners_mm(t as usize);
                a + (b - a) * b1 + (c - a) * b2
            })
        };
        (0..self.owner.len()).into_par_iter().map(of).collect()
    }
}
