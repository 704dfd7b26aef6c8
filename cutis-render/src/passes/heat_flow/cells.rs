//! Cells: squares between four texels, or the parts of them that one chart covers. Inside a cell light is bilinear.
//!
//! A cell at the edge of a chart is the exact polygon that the chart cuts from the square; corners beyond the edge read what lies
//! there across the seam. What heat flows in a cell follows from integrals over it of products of the corners' slopes.

use super::metric::{Metric, conductivity};
use super::shore::{Read, Shore, centre};
use crate::passes::atlas::{barycentric, inside};
use cutis_scene::Object;
use glam::{Mat4, Vec2, Vec4};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Cells of less than this part of a square are rounding.
const LEAST_AREA: f32 = 1e-7;

/// Integrals over a part of the unit square.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    one: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
}

/// A part of a cell in one triangle.
#[derive(Debug, Clone, Copy)]
struct Piece {
    triangle: u32,
    moments: Moments,
}

/// What one chart has of a square.
#[derive(Debug, Clone)]
pub struct Cell {
    /// What its corners read, along u, then along v.
    pub corners: [Read; 4],
    /// The first texel of its square.
    pub first: usize,
    /// The chart that it is of.
    pub chart: u32,
    /// The part of its square that it is.
    pub part_of_square: f32,
    /// Its middle, from the first texel of its square, texels.
    middle_of_square: Vec2,
    /// How much better heat flows here than by the medium.
    conductivity: f32,
    pieces: Vec<Piece>,
}

impl Moments {
    /// Of the square itself.
    pub const WHOLE: Self = Self { one: 1.0, x: 0.5, y: 0.5, xx: 1.0 / 3.0, xy: 0.25, yy: 1.0 / 3.0 };

    /// Of a convex polygon, corner by corner.
    fn of(polygon: &[Vec2]) -> Self {
        let mut sum = Self::default();
        for i in 2..polygon.len() {
            let [a, b, c] = [polygon[0], polygon[i - 1], polygon[i]];
            let third = (b - a).perp_dot(c - a).abs() / 6.0;
            // The middles of the edges are exact for squares.
            [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5].into_iter().for_each(|p| sum.add(p, third));
        }
        sum
    }

    fn add(&mut self, p: Vec2, weight: f32) {
        self.one += weight;
        self.x += weight * p.x;
        self.y += weight * p.y;
        self.xx += weight * p.x * p.x;
        self.xy += weight * p.x * p.y;
        self.yy += weight * p.y * p.y;
    }

    /// Of each corner's share of the light, along u, then along v.
    pub fn shares(&self) -> Vec4 {
        Vec4::new(self.one - self.x - self.y + self.xy, self.x - self.xy, self.y - self.xy, self.xy)
    }

    /// Of a·(slopes of the shares of two corners), for all pairs of corners.
    pub fn slopes(&self, metric: &Metric) -> Mat4 {
        // Along u a share falls or rises by 1 - y at the first two corners and by y at the others; along v likewise.
        let across = |m: [f32; 3], high: [bool; 2]| match high {
            [false, false] => m[0] - 2.0 * m[1] + m[2],
            [true, true] => m[2],
            _ => m[1] - m[2],
        };
        let mixed = |high_y: bool, high_x: bool| match [high_y, high_x] {
            [false, false] => self.one - self.x - self.y + self.xy,
            [false, true] => self.x - self.xy,
            [true, false] => self.y - self.xy,
            [true, true] => self.xy,
        };
        let sign = |high: bool| if high { 1.0 } else { -1.0 };
        let place = |k: usize| [k & 1 == 1, k & 2 == 2];
        let of = |i: usize, j: usize| {
            let ([xi, yi], [xj, yj]) = (place(i), place(j));
            let uu = sign(xi) * sign(xj) * across([self.one, self.y, self.yy], [yi, yj]);
            let vv = sign(yi) * sign(yj) * across([self.one, self.x, self.xx], [xi, xj]);
            let uv = sign(xi) * sign(yj) * mixed(yi, xj) + sign(yi) * sign(xj) * mixed(yj, xi);
            metric.a.x * uu + metric.a.y * uv + metric.a.z * vv
        };
        // The same to the last bit for both orders of a pair.
        let ordered = |i: usize, j: usize| of(i.min(j), i.max(j));
        Mat4::from_cols_array(&std::array::from_fn(|n| ordered(n / 4, n % 4)))
    }
}

impl Cell {
    /// How much better heat flows here than by the medium.
    pub fn conductivity(&self) -> f32 {
        self.conductivity
    }

    /// Its middle, texels.
    pub fn middle(&self, size: usize) -> Vec2 {
        centre(self.first, size) + self.middle_of_square
    }

    /// Its area by corner, mm², and its slopes, of the metric of every triangle.
    pub fn integrals(&self, metrics: &[Metric]) -> (Vec4, Mat4) {
        self.pieces.iter().fold((Vec4::ZERO, Mat4::ZERO), |(areas, slopes), piece| {
            let metric = &metrics[piece.triangle as usize];
            let slopes = slopes + piece.moments.slopes(&metric.conducting(self.conductivity));
            // Shares of next to nothing may be rounded below it, which large texels would make much of.
            (areas + piece.moments.shares().max(Vec4::ZERO) * metric.area_mm2, slopes)
        })
    }

    /// The texel of each corner that reads just one.
    fn signature(corners: &[Read; 4]) -> [u32; 4] {
        corners.each_ref().map(|read| if read.len() == 1 { read[0].0 } else { u32::MAX })
    }
}

/// All cells of squares that edges of charts may cut.
#[derive(Debug, Clone)]
pub struct Cells {
    /// In the order of their squares.
    pub all: Vec<Cell>,
    of_pieces: HashMap<(usize, u32), u32>,
}

impl Cells {
    /// Of an object.
    pub fn new(object: &Object, shore: &Shore) -> Self {
        let all = cut_cells(object, shore);
        let pieces = all.iter().enumerate().flat_map(|(number, cell)| {
            cell.pieces.iter().map(move |piece| ((cell.first, piece.triangle), number as u32))
        });
        let of_pieces = pieces.collect();
        Self { all, of_pieces }
    }

    /// The cells of a square, by its first texel, with their numbers.
    pub fn at(&self, first: usize) -> impl Iterator<Item = (u32, &Cell)> {
        let from = self.all.partition_point(|cell| cell.first < first);
        let cells = self.all[from..].iter().take_while(move |cell| cell.first == first);
        (from as u32..).zip(cells)
    }

    /// The cell that a triangle has a piece in, by the first texel of its square.
    pub fn of(&self, first: usize, triangle: u32) -> Option<u32> {
        self.of_pieces.get(&(first, triangle)).copied()
    }
}

fn cut_cells(object: &Object, shore: &Shore) -> Vec<Cell> {
    let found: Vec<(usize, u32, Piece, [Read; 4])> = (0..object.mesh.triangles.len() as u32)
        .into_par_iter()
        .flat_map_iter(|triangle| pieces(shore, triangle).into_iter())
        .map(|(first, piece, corners)| {
            (first, object.charts.of_triangle[piece.triangle as usize], piece, corners)
        })
        .collect();
    // Both sides of a slit are parts of one chart, but see other corners.
    let mut cells: BTreeMap<(usize, u32, [u32; 4]), Cell> = BTreeMap::new();
    for (first, chart, piece, corners) in found {
        let cell = cells.entry((first, chart, Cell::signature(&corners)));
        let new = || Cell {
            corners,
            first,
            chart,
            part_of_square: 0.0,
            middle_of_square: Vec2::ZERO,
            conductivity: 1.0,
            pieces: Vec::new(),
        };
        cell.or_insert_with(new).pieces.push(piece);
    }
    cells.into_values().map(|cell| summed_up(object, cell, shore.size())).collect()
}

/// With what follows from all of its pieces; how well heat flows is the mean over them, each by its middle.
fn summed_up(object: &Object, mut cell: Cell, size: usize) -> Cell {
    let middle = |Piece { moments, .. }: &Piece| Vec2::new(moments.x, moments.y);
    cell.part_of_square = cell.pieces.iter().map(|piece| piece.moments.one).sum();
    cell.middle_of_square = cell.pieces.iter().map(middle).sum::<Vec2>() / cell.part_of_square;
    let of = |piece: &Piece| {
        let place = (centre(cell.first, size) + middle(piece) / piece.moments.one) / size as f32;
        let [b1, b2] = inside(barycentric(object.mesh.corner_atlas_uvs(piece.triangle as usize), place));
        piece.moments.one * conductivity(object, object.map_uv_at(piece.triangle, b1, b2))
    };
    cell.conductivity = if object.material.mean_free_path_scale.texture.is_none() {
        conductivity(object, Vec2::ZERO)
    } else {
        cell.pieces.iter().map(of).sum::<f32>() / cell.part_of_square
    };
    cell
}

/// What a triangle has of squares that may be cut.
fn pieces(shore: &Shore, triangle: u32) -> Vec<(usize, Piece, [Read; 4])> {
    let size = shore.size();
    let corners = shore.ground.corners(triangle);
    // Texels' centres are the corners of squares. What lies beyond the outermost belongs to the last square.
    let last = size as f32 - 2.0;
    let index = |p: Vec2| (p - 0.5).floor().clamp(Vec2::ZERO, Vec2::splat(last)).as_uvec2();
    let lo = index(corners[0].min(corners[1]).min(corners[2]));
    let hi = index(corners[0].max(corners[1]).max(corners[2]));
    let mut all = Vec::new();
    for y in lo.y..=hi.y {
        for x in lo.x..=hi.x {
            let first = y as usize * size + x as usize;
            if !shore.may_be_cut(first) {
                continue;
            }
            let origin = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let low = Vec2::select(glam::BVec2::new(x == 0, y == 0), Vec2::splat(-0.5), Vec2::ZERO);
            let high = Vec2::select(
                glam::BVec2::new(x as usize == size - 2, y as usize == size - 2),
                Vec2::splat(1.5),
                Vec2::ONE,
            );
            let polygon = clipped(corners.map(|c| c - origin), low, high);
            let moments = Moments::of(&polygon);
            if moments.one < LEAST_AREA {
                continue;
            }
            let middle = Vec2::new(moments.x, moments.y) / moments.one + origin;
            if let Some(corners) = shore.corners_from(triangle, middle, first) {
                all.push((first, Piece { triangle, moments }, corners));
            }
        }
    }
    all
}

/// The part of a triangle in a box (Sutherland & Hodgman 1974).
fn clipped(triangle: [Vec2; 3], low: Vec2, high: Vec2) -> Vec<Vec2> {
    let mut polygon = triangle.to_vec();
    let inside = [
        |p: Vec2, low: Vec2, _: Vec2| p.x - low.x,
        |p: Vec2, low: Vec2, _: Vec2| p.y - low.y,
        |p: Vec2, _: Vec2, high: Vec2| high.x - p.x,
        |p: Vec2, _: Vec2, high: Vec2| high.y - p.y,
    ];
    for depth in inside {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (da, db) = (depth(a, low, high), depth(b, low, high));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push(a.lerp(b, da / (da - db)));
            }
        }
        polygon = kept;
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// The whole square has the well-known stiffness of a bilinear square, and half of it half the area.
    #[test]
    fn a_square_is_what_textbooks_say() {
        let whole = [Vec2::new(-3.0, -3.0), Vec2::new(9.0, -3.0), Vec2::new(-3.0, 9.0)];
        let metric = Metric { a: Vec3::new(1.0, 0.0, 1.0), area_mm2: 1.0 };
        for moments in [Moments::of(&clipped(whole, Vec2::ZERO, Vec2::ONE)), Moments::WHOLE] {
            let slopes = moments.slopes(&metric).to_cols_array_2d();
            for (found, exact) in slopes[0].iter().zip([4.0 / 6.0, -1.0 / 6.0, -1.0 / 6.0, -2.0 / 6.0]) {
                assert!((found - exact).abs() < 1e-6, "{slopes:?}");
            }
            assert!((moments.shares() - 0.25).abs().max_element() < 1e-6);
        }
        let half = [Vec2::ZERO, Vec2::X, Vec2::Y];
        assert!((Moments::of(&clipped(half, Vec2::ZERO, Vec2::ONE)).one - 0.5).abs() < 1e-6);
    }

    /// Light that rises evenly has the same energy per area in any part of the square: a·slope·slope.
    #[test]
    fn even_slopes_have_the_energy_of_their_area() {
        let polygon = [Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.3), Vec2::new(0.4, 0.95)];
        let moments = Moments::of(&clipped(polygon, Vec2::ZERO, Vec2::ONE));
        let metric = Metric { a: Vec3::new(2.0, -0.4, 0.7), area_mm2: 1.0 };
        let slope = Vec2::new(1.3, -0.6);
        let light = Vec4::new(0.0, slope.x, slope.y, slope.x + slope.y);
        let energy = light.dot(moments.slopes(&metric) * light);
        let a = metric.a;
        let exact = a.x * slope.x * slope.x + 2.0 * a.y * slope.x * slope.y + a.z * slope.y * slope.y;
        assert!((energy - exact * moments.one).abs() < 1e-6, "{energy} {}", exact * moments.one);
    }
}
