//! The surface unrolled: for every texel of an object's texture the triangle under it, and for every coarser level of
//! that texture which chart a texel belongs to and how far it is from that chart's edge.
//!
//! A texel belongs to the triangle that covers its centre. Around every chart two more rings of texels are *padded*:
//! they repeat the nearest point of the chart's edge, so that a bilinear read near the edge finds values of its own
//! surface. A read never mixes charts: it leaves out neighbours that belong to another one.

use cutis_scene::{Object, SurfacePoint};
use glam::Vec2;
use rayon::prelude::*;
use std::ops::{Add, Mul};
use std::sync::Arc;

/// Marks a texel that no chart covers.
pub const NO_CHART: u32 = u32::MAX;

/// Rings of padding around every chart, texels.
const PADDING: usize = 2;

/// A chart of fewer texels hardly holds light.
const LEAST_CHART_TEXELS: f32 = 1.0;

/// Rows of texels that one task rasterises.
const BAND_ROWS: usize = 32;

/// Where a texel lies on the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexelSurface {
    /// Triangle, or [`NO_CHART`] for an empty texel.
    pub triangle: u32,
    /// Barycentric weight of the triangle's second corner.
    pub b1: f32,
    /// Barycentric weight of the triangle's third corner.
    pub b2: f32,
}

/// A texel that nothing covers.
const EMPTY: TexelSurface = TexelSurface { triangle: NO_CHART, b1: 0.0, b2: 0.0 };

/// The unrolled surface at full size.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// Width and height in texels.
    pub size: usize,
    /// Place of each texel on the mesh.
    pub surface: Vec<TexelSurface>,
    /// Chart of each texel.
    pub charts: Arc<ChartMap>,
}

/// Which chart every texel of a square map belongs to.
#[derive(Debug, Clone)]
pub struct ChartMap {
    /// Width and height in texels.
    pub size: usize,
    /// Chart of each texel, or [`NO_CHART`].
    pub chart: Vec<u32>,
    /// Along u: texels of the same chart on both sides without a gap, the smaller of the two.
    pub reach_u: Vec<u16>,
    /// The same along v.
    pub reach_v: Vec<u16>,
}

impl Atlas {
    /// Rasterises the object into its own texture.
    pub fn new(object: &Object, size: usize) -> Self {
        let mut surface = vec![EMPTY; size * size];
        let buckets = triangles_by_band(object, size);
        surface.par_chunks_mut(BAND_ROWS * size).zip(&buckets).enumerate().for_each(
            |(band, (rows, triangles))| {
                for &triangle in triangles {
                    rasterise(object, triangle, size, band * BAND_ROWS, rows);
                }
            },
        );
        for _ in 0..PADDING {
            pad(object, size, &mut surface);
        }
        claim_for_thin_parts(object, size, &mut surface);
        let chart = surface.par_iter().map(|s| chart_of(object, s)).collect();
        Self { size, surface, charts: Arc::new(ChartMap::new(size, chart)) }
    }

    /// The surface under a texel, if a chart covers it.
    pub fn surface_point(&self, object: &Object, texel: usize) -> Option<SurfacePoint> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.surface_point(s.triangle, s.b1, s.b2))
    }

    /// Place of that surface in the material's maps.
    pub fn map_uv_under(&self, object: &Object, texel: usize) -> Option<Vec2> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.map_uv_at(s.triangle, s.b1, s.b2))
    }

    /// Place of that surface in the maps of light: the texel's middle, but where it pads a chart.
    pub fn atlas_uv_under(&self, object: &Object, texel: usize) -> Option<Vec2> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.atlas_uv_at(s.triangle, s.b1, s.b2))
    }

    /// The surface under a texel of a smaller map that belongs to `chart`: `times` as wide as one of these. Of the texels
    /// of that chart the most central one stands for all.
    pub fn point_under(
        &self,
        object: &Object,
        chart: u32,
        [x, y]: [usize; 2],
        times: usize,
    ) -> Option<SurfacePoint> {
        if chart == NO_CHART {
            return None;
        }
        let off_centre = |i: usize| (2 * i + 1).abs_diff(times);
        let own = (0..times * times)
            .map(|i| [i % times, i / times])
            .filter(|[dx, dy]| self.charts.chart[(times * y + dy) * self.size + times * x + dx] == chart);
        let [dx, dy] = own.min_by_key(|[dx, dy]| off_centre(*dx) + off_centre(*dy))?;
        self.surface_point(object, (times * y + dy) * self.size + times * x + dx)
    }
}

impl ChartMap {
    /// Measures how far every texel is from the edge of its chart.
    pub fn new(size: usize, chart: Vec<u32>) -> Self {
        let (reach_u, reach_v) =
            rayon::join(|| reach_along_rows(&chart, size), || reach_along_columns(&chart, size));
        Self { size, chart, reach_u, reach_v }
    }

    /// The map at half the size. A coarse texel belongs to the chart that most of its four texels belong to, and of
    /// several the one with the lowest number.
    pub fn halved(&self) -> Self {
        let half = self.size / 2;
        let chart = (0..half * half)
            .into_par_iter()
            .map(|i| most_common(self.children(i % half, i / half).map(|child| self.chart[child])))
            .collect();
        Self::new(half, chart)
    }

    /// The four texels under a texel of the halved map.
    pub fn children(&self, x: usize, y: usize) -> [usize; 4] {
        let first = 2 * y * self.size + 2 * x;
        [first, first + 1, first + self.size, first + self.size + 1]
    }

    /// The four texels around `uv`, and their weights in a bilinear read.
    pub fn around(&self, uv: Vec2) -> [(usize, f32); 4] {
        let p = uv * self.size as f32 - 0.5;
        let floor = p.floor();
        let f = p - floor;
        let last = self.size as i32 - 1;
        let column = [floor.x as i32, (floor.x as i32).saturating_add(1)].map(|x| x.clamp(0, last) as usize);
        let row = [floor.y as i32, (floor.y as i32).saturating_add(1)]
            .map(|y| y.clamp(0, last) as usize * self.size);
        [
            (row[0] + column[0], (1.0 - f.x) * (1.0 - f.y)),
            (row[0] + column[1], f.x * (1.0 - f.y)),
            (row[1] + column[0], (1.0 - f.x) * f.y),
            (row[1] + column[1], f.x * f.y),
        ]
    }

    /// Bilinear read of `map` at `uv` from texels of one chart only. `None` if none of the four belongs to it.
    pub fn sample<T>(&self, map: &[T], uv: Vec2, chart: u32) -> Option<T>
    where
        T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>,
    {
        let (mut sum, mut weight) = (T::default(), 0.0);
        for (texel, w) in self.around(uv) {
            if self.chart[texel] == chart {
                sum = sum + map[texel] * w;
                weight += w;
            }
        }
        // Below a thousandth the quotient would only magnify rounding.
        (weight > 1e-3).then(|| sum * weight.recip())
    }
}

/// For every chart of an object whether it is large enough to hold light on a map of that size.
pub fn charts_that_hold_light(object: &Object, size: usize) -> Vec<bool> {
    let of_triangle = &object.charts.of_triangle;
    let mut texels = vec![0.0f32; of_triangle.iter().max().map_or(0, |&last| last as usize + 1)];
    for (triangle, &chart) in of_triangle.iter().enumerate() {
        let [a, b, c] = object.mesh.corner_atlas_uvs(triangle).map(|uv| uv * size as f32);
        texels[chart as usize] += 0.5 * (b - a).perp_dot(c - a).abs();
    }
    texels.into_iter().map(|texels| texels >= LEAST_CHART_TEXELS).collect()
}

fn chart_of(object: &Object, surface: &TexelSurface) -> u32 {
    if surface.triangle == NO_CHART { NO_CHART } else { object.charts.of_triangle[surface.triangle as usize] }
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

/// Parts of charts so thin that they cover no texel's centre far and wide take the texels that their edges run through, where
/// those are free: else they would have no light.
fn claim_for_thin_parts(object: &Object, size: usize, surface: &mut [TexelSurface]) {
    for triangle in 0..object.mesh.triangles.len() as u32 {
        let corners = object.mesh.corner_atlas_uvs(triangle as usize);
        for edge in 0..3 {
            let (from, to) = (corners[edge] * size as f32, corners[(edge + 1) % 3] * size as f32);
            // No edge on a map is longer than twice its side.
            let steps = from.distance(to).min(2.0 * size as f32).ceil().max(1.0) as usize;
            for place in (0..steps).map(|i| from.lerp(to, i as f32 / steps as f32)) {
                let is_on_map = place.min_element() >= 0.0 && place.max_element() < size as f32;
                let texel = place.y as usize * size + place.x as usize;
                if is_on_map && surface[texel].triangle == NO_CHART {
                    let (b1, b2, _) = nearest_on_triangle(corners, (place.floor() + 0.5) / size as f32);
                    surface[texel] = TexelSurface { triangle, b1, b2 };
                }
            }
        }
    }
}

/// Weights of the second and the third corner of a triangle at a point of its plane; not numbers if it has no area.
pub fn barycentric([a, b, c]: [Vec2; 3], p: Vec2) -> [f32; 2] {
    let area = (b - a).perp_dot(c - a);
    [(c - p).perp_dot(a - p) / area, (a - p).perp_dot(b - p) / area]
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

/// Barycentric weights (second, third corner) of the triangle's point nearest to an outside point, and the squared
/// distance.
fn nearest_on_triangle(corners: [Vec2; 3], p: Vec2) -> (f32, f32, f32) {
    let mut best = (0.0, 0.0, f32::INFINITY);
    for edge in 0..3 {
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let along = to - from;
        let f = ((p - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let distance2 = (from + along * f - p).length_squared();
        if distance2 < best.2 {
            let mut weights = [0.0; 3];
            weights[edge] = 1.0 - f;
            weights[(edge + 1) % 3] = f;
            best = (weights[1], weights[2], distance2);
        }
    }
    best
}

/// For each texel: how many of the same chart follow it in its row without a gap on both sides, the smaller count.
fn reach_along_rows(chart: &[u32], size: usize) -> Vec<u16> {
    let mut reach = vec![0u16; chart.len()];
    reach.par_chunks_mut(size).zip(chart.par_chunks(size)).for_each(|(reach, line)| {
        for i in 1..size {
            reach[i] = if line[i] == line[i - 1] { reach[i - 1].saturating_add(1) } else { 0 };
        }
        let mut run = 0u16;
        reach[size - 1] = 0;
        for i in (0..size - 1).rev() {
            run = if line[i] == line[i + 1] { run.saturating_add(1) } else { 0 };
            reach[i] = reach[i].min(run);
        }
    });
    reach
}

/// The same for columns: row by row, each from the one above it, then from the one below.
fn reach_along_columns(chart: &[u32], size: usize) -> Vec<u16> {
    let row = |y: usize| &chart[y * size..(y + 1) * size];
    let mut reach = vec![0u16; chart.len()];
    for y in 1..size {
        let (done, rest) = reach.split_at_mut(y * size);
        let above = &done[(y - 1) * size..];
        for (((to, from), a), b) in rest[..size].iter_mut().zip(above).zip(row(y)).zip(row(y - 1)) {
            *to = if a == b { from.saturating_add(1) } else { 0 };
        }
    }
    let mut run = vec![0u16; size];
    reach[(size - 1) * size..].fill(0);
    for y in (0..size - 1).rev() {
        let line = reach[y * size..(y + 1) * size].iter_mut().zip(&mut run);
        for (((to, run), a), b) in line.zip(row(y)).zip(row(y + 1)) {
            *run = if a == b { run.saturating_add(1) } else { 0 };
            *to = (*to).min(*run);
        }
    }
    reach
}

fn most_common(charts: [u32; 4]) -> u32 {
    if charts == [charts[0]; 4] {
        return charts[0];
    }
    let count = |c: u32| charts.iter().filter(|&&other| other == c).count();
    let covered = charts.into_iter().filter(|&c| c != NO_CHART);
    covered.max_by_key(|&c| (count(c), std::cmp::Reverse(c))).unwrap_or(NO_CHART)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Material, Mesh};
    use glam::Vec3;

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
