//! Stretch: how many millimetres of surface one texel covers along u and along v
//! (d'Eon, Luebke & Enderton 2007, section 5.1; the paper stores the reciprocal).
//!
//! The derivatives of a flat triangle are constant, so this is exact per triangle where the paper takes screen-space
//! differences.

use crate::passes::atlas::{Atlas, NO_CHART};
use cutis_scene::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels that stand still in space would have no size; nothing smaller than a micrometre is believed.
const MIN_STRETCH_MM: f32 = 1e-3;

/// Millimetres per texel along u and v, for every texel of the atlas. Empty texels hold 0.
pub fn stretch_mm_per_texel(object: &Object, atlas: &Atlas) -> Vec<Vec2> {
    let texels = atlas.size as f32;
    let per_triangle: Vec<Vec2> = (0..object.mesh.triangles.len())
        .into_par_iter()
        .map(|t| {
            let [along_u, along_v] = derivatives_mm(object, t);
            (Vec2::new(along_u.length(), along_v.length()) / texels).max(Vec2::splat(MIN_STRETCH_MM))
        })
        .collect();
    let of = |triangle: u32| if triangle == NO_CHART { Vec2::ZERO } else { per_triangle[triangle as usize] };
    atlas.surface.par_iter().map(|s| of(s.triangle)).collect()
}

/// dX/du and dX/dv of a triangle, mm per unit of the texture.
pub fn derivatives_mm(object: &Object, triangle: usize) -> [Vec3; 2] {
    let [p0, p1, p2] = object.mesh.corners_mm(triangle);
    let [t0, t1, t2] = object.mesh.corner_uvs(triangle);
    let (e1, e2, d1, d2) = (p1 - p0, p2 - p0, t1 - t0, t2 - t0);
    let determinant = d1.perp_dot(d2);
    if determinant == 0.0 {
        return [Vec3::ZERO; 2];
    }
    [(e1 * d2.y - e2 * d1.y) / determinant, (e2 * d1.x - e1 * d2.x) / determinant]
}
