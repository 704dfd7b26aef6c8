//! The surface under every texel: whose centres triangles cover, what thin parts claim, and the padding around.

use super::triangle::{barycentric, nearest_on_triangle};
use super::{NO_CHART, TexelSurface};
use cutis_scene::Object;
use glam::Vec2;
use rayon::prelude::*;

/// Rings of padding around every chart, texels.
const PADDING: usize = 2;

/// Rows of texels that one task rasterises.
const BAND_ROWS: usize = 32;

/// A texel that nothing covers.
const EMPTY: TexelSurface = TexelSurface { triangle: NO_CHART, b1: 0.0, b2: 0.0 };

/// Of an object on a map of `size` texels along each side.
pub fn texels(object: &Object, size: usize) -> Vec<TexelSurface> {
    let mut surface = vec![EMPTY; size * size];
    let buckets = triangles_by_band(object, size);
    surface.par_chunks_mut(BAND_ROWS * size).zip(&buckets).enumerate().for_each(
        |(band, (rows, triangles))| {
            for &triangle in triangles {
                rasterise(object, triangle, size, band * BAND_ROWS, rows);
            }
        },
    );
    // Charts without any texel come first, before others' padding takes what is left.
    let mut has_texels = vec![false; object.charts.count as usize];
    let covered = surface.iter().filter(|s| s.triangle != NO_CHART);
    covered.for_each(|s| has_texels[object.charts.of_triangle[s.triangle as usize] as usize] = true);
    claim_for_thin_parts(object, size, |chart| !has_texels[chart as usize], &mut surface);
    for _ in 0..PADDING {
        pad(object, size, &mut surface);
    }
    claim_for_thin_parts(object, size, |_| true, &mut surface);
    surface
}

/// Triangles whose box touches each band of rows, in the mesh's order.
fn triangles_by_band(object: &Object, size: usize) -> Vec<Vec<u32>> {
    let mut buckets = vec![Vec::new(); size.div_ceil(BAND_ROWS)];
    for t in 0..object.mesh.triangles.len() {
        let rows = object.mesh.corner_atlas_uvs(t).map(|uv| uv.y * size as f32);
        let lo = rows[0].min(rows[1]).min(rows[2]).max(0.0);
        let hi = rows[0].max(rows[1]).max(rows[2]).min(size as f32 - 1.0);
        if lo <= hi {
            let last = buckets.len() - 1;
            for bucket in &mut buckets[lo as usize / BAND_ROWS..=(hi as usize / BAND_ROWS).min(last)] {
                bucket.push(t as u32);
            }
        }
    }
    buckets
}

/// Claims the free texels whose centres a triangle covers. `rows` are the texels from row `first_row` on.
fn rasterise(object: &Object, triangle: u32, size: usize, first_row: usize, rows: &mut [TexelSurface]) {
    let [a, b, c] = object.mesh.corner_atlas_uvs(triangle as usize).map(|uv| uv * size as f32 - 0.5);
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    let clamp = |x: f32, last: usize| x.clamp(0.0, last as f32) as usize;
    let last_row = (first_row + rows.len() / size).min(size) - 1;
    for y in clamp(lo.y.ceil(), size).max(first_row)..=clamp(hi.y.floor(), size - 1).min(last_row) {
        for x in clamp(lo.x.ceil(), size)..=clamp(hi.x.floor(), size - 1) {
            let p = Vec2::new(x as f32, y as f32);
            let [b1, b2] = barycentric([a, b, c], p);
            let texel = &mut rows[(y - first_row) * size + x];
            // Both sides of a shared edge may claim its texels (the slack is rounding): the first triangle has them.
            if b1 >= -1e-6 && b2 >= -1e-6 && b1 + b2 <= 1.0 + 1e-6 && texel.triangle == NO_CHART {
                *texel = TexelSurface {
                    triangle,
                    b1: b1.clamp(0.0, 1.0),
                    b2: b2.clamp(0.0, 1.0 - b1.clamp(0.0, 1.0)),
                };
            }
        }
    }
}

/// Parts of some charts that are so thin that they cover no texel's centre far and wide take the texels that their edges run
/// through, where those are free: else they would have no light.
fn claim_for_thin_parts(
    object: &Object,
    size: usize,
    of: impl Fn(u32) -> bool,
    surface: &mut [TexelSurface],
) {
    let charts = &object.charts.of_triangle;
    for triangle in (0..object.mesh.triangles.len() as u32).filter(|&t| of(charts[t as usize])) {
        let corners = object.mesh.corner_atlas_uvs(triangle as usize);
        for edge in 0..3 {
            let (from, to) = (corners[edge] * size as f32, corners[(edge + 1) % 3] * size as f32);
            // No edge on a map is longer than twice its side.
            let steps = from.distance(to).min(2.0 * size as f32).ceil().max(1.0) as usize;
            for place in (0..steps).map(|i| from.lerp(to, i as f32 / steps as f32)) {
                if !(place.min_element() >= 0.0 && place.max_element() <= size as f32) {
                    continue;
                }
                // The map's far edges belong to its last texels.
                let at = place.floor().min(Vec2::splat(size as f32 - 1.0));
                let texel = at.y as usize * size + at.x as usize;
                if surface[texel].triangle == NO_CHART {
                    let (b1, b2, _) = nearest_on_triangle(corners, (at + 0.5) / size as f32);
                    surface[texel] = TexelSurface { triangle, b1, b2 };
                }
            }
        }
    }
}

/// Adds one ring of texels around every chart. A new texel takes the triangle of a neighbour and the point of that
/// triangle nearest to its centre.
fn pad(object: &Object, size: usize, surface: &mut Vec<TexelSurface>) {
    let grown = (0..size * size)
        .into_par_iter()
        .map(|i| {
            if surface[i].triangle == NO_CHART {
                nearest_neighbour(object, size, surface, i)
            } else {
                surface[i]
            }
        })
        .collect();
    *surface = grown;
}

fn nearest_neighbour(object: &Object, size: usize, surface: &[TexelSurface], texel: usize) -> TexelSurface {
    let (x, y) = ((texel % size) as i64, (texel / size) as i64);
    let centre = (Vec2::new(x as f32, y as f32) + 0.5) / size as f32;
    let mut best = (f32::INFINITY, EMPTY);
    for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)] {
        let (nx, ny) = (x + dx, y + dy);
        if nx < 0 || ny < 0 || nx >= size as i64 || ny >= size as i64 {
            continue;
        }
        let neighbour = surface[ny as usize * size + nx as usize];
        if neighbour.triangle == NO_CHART {
            continue;
        }
        let uvs = object.mesh.corner_atlas_uvs(neighbour.triangle as usize);
        let (b1, b2, distance2) = nearest_on_triangle(uvs, centre);
        if distance2 < best.0 {
            best = (distance2, TexelSurface { triangle: neighbour.triangle, b1, b2 });
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::super::Atlas;
    use super::*;
    use cutis_scene::{Material, Mesh};
    use glam::Vec3;

    /// A square of half the map, and beside it needles that cover no centre: one not a texel away, one at the map's far edge.
    #[test]
    fn charts_beside_others_have_texels() {
        let size = 32;
        let mut mesh = Mesh::default();
        let mut chart = |corners: [[f32; 2]; 3]| {
            let first = mesh.positions_mm.len() as u32;
            let up = Vec3::Z * 10.0 * first as f32;
            mesh.positions_mm.extend([Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + up));
            mesh.uvs.extend(corners.map(|uv| Vec2::from_array(uv) / size as f32));
            mesh.triangles.push([first, first + 1, first + 2]);
        };
        chart([[0.0, 0.0], [16.0, 0.0], [0.0, 16.0]]);
        let needles = [[[16.6, 1.0], [16.8, 16.0], [16.7, 16.0]], [[32.0, 1.0], [32.0, 16.0], [31.9, 16.0]]];
        needles.into_iter().for_each(&mut chart);
        let object = Object::new("needles", mesh, Material::default());
        let atlas = Atlas::new(&object, size);
        let lit = vec![1.0f32; size * size];
        for (needle, [at, ..]) in (1..).zip(needles) {
            for y in 1..16 {
                let at = Vec2::new(at[0], y as f32 + 0.5) / size as f32;
                assert_eq!(atlas.charts.sample(&lit, at, needle), Some(1.0), "{needle}, {y}");
            }
        }
    }

    /// A needle between the centres of texels has light from end to end, and a point of it on the surface everywhere.
    #[test]
    fn a_chart_that_covers_no_centre_has_texels_all_along() {
        let size = 64;
        let uvs = [[10.0, 20.7], [40.0, 20.9], [40.0, 20.95]].map(|uv| Vec2::from_array(uv) / size as f32);
        let mesh = Mesh {
            positions_mm: vec![Vec3::ZERO, Vec3::new(30.0, 0.0, 0.0), Vec3::new(30.0, 0.1, 0.0)],
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let object = Object::new("needle", mesh, Material::default());
        let atlas = Atlas::new(&object, size);
        let along = vec![1.0f32; size * size];
        for x in 10..40 {
            let at = (Vec2::new(x as f32 + 0.5, 20.8)) / size as f32;
            assert_eq!(atlas.charts.sample(&along, at, 0), Some(1.0), "{x}");
            let point = atlas.surface_point(&object, 20 * size + x).expect("the needle runs through it");
            assert!((point.position_mm.x - (x as f32 - 9.5)).abs() < 1.0, "{x}: {}", point.position_mm);
        }
    }
}
