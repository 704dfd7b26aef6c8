//! The plate of the ear as a height over its plane: hollow, antihelix with its two branches, lobe; and its outline.
//!
//! Drawn with curves, then tabulated, since every sample of the sculpture near an ear asks for it.

use super::sdf::{Curve2, smoothstep};
use glam::{Vec2, Vec4};
use rayon::prelude::*;

/// Depth of the hollow below the plate, mm.
const CONCHA_DEPTH_MM: f32 = 12.0;
/// Edge of a table cell: a tenth of the finest ridge, mm.
const CELL_MM: f32 = 0.3;
/// Corner of the table in (u, v), mm.
const TABLE_ORIGIN_MM: Vec2 = Vec2::new(-32.0, -50.0);
/// Cells of the table along u and v; it covers everything within the ear's reach.
const TABLE_SIZE: [usize; 2] = [320, 330];

/// The plate at one place (u, v).
pub struct PlatePoint {
    height_mm: f32,
    /// Turns a height over the plate into a distance from it: the cosine of the plate's slope.
    cosine: f32,
    /// Signed distance to the outline, positive outside, mm.
    pub outside_mm: f32,
    /// Signed distance to the edge of the hollow, positive outside, mm.
    pub outside_concha_mm: f32,
}

impl PlatePoint {
    /// Distance of a point at height `w_mm` from the plate's middle, mm; positive on the outer side.
    pub fn off_mm(&self, w_mm: f32) -> f32 {
        (w_mm - self.height_mm) * self.cosine
    }
}

/// The tabulated plate.
pub struct EarPlate {
    /// Height, cosine, distance to the outline, distance to the hollow; u fastest.
    table: Vec<Vec4>,
}

impl EarPlate {
    /// Draws and tabulates.
    pub fn new() -> Self {
        let drawing = Drawing::new();
        let [nu, nv] = TABLE_SIZE;
        let place = |i: usize| TABLE_ORIGIN_MM + Vec2::new((i % nu) as f32, (i / nu) as f32) * CELL_MM;
        let heights: Vec<f32> = (0..nu * nv).into_par_iter().map(|i| drawing.height_mm(place(i))).collect();
        // Ridges and hollows are drawn with distances to curves, which have creases of their own.
        let heights = blurred(&blurred(&heights, 1), nu);
        let entry = |i: usize| {
            let at = |step: isize| heights[i.saturating_add_signed(step).min(nu * nv - 1)];
            let slope = Vec2::new(at(1) - at(-1), at(nu as isize) - at(-(nu as isize))) / (2.0 * CELL_MM);
            let cosine = (1.0 + slope.length_squared()).sqrt().recip();
            let q = place(i);
            Vec4::new(
                heights[i],
                cosine,
                drawing.outline.signed_distance(q),
                drawing.concha.signed_distance(q),
            )
        };
        Self { table: (0..nu * nv).into_par_iter().map(entry).collect() }
    }

    /// Reads the table with quadratic B-splines, which keep slopes continuous.
    pub fn at(&self, uv: Vec2) -> PlatePoint {
        let [nu, nv] = TABLE_SIZE;
        let limit = Vec2::new(nu as f32 - 2.0, nv as f32 - 2.0);
        let q = ((uv - TABLE_ORIGIN_MM) / CELL_MM).clamp(Vec2::ONE, limit);
        let nearest = q.round();
        let (wu, wv) = (b_spline(q.x - nearest.x), b_spline(q.y - nearest.y));
        let first = (nearest.y as usize - 1) * nu + nearest.x as usize - 1;
        let row = |j: usize| {
            let r = &self.table[first + j * nu..first + j * nu + 3];
            (r[0] * wu[0] + r[1] * wu[1] + r[2] * wu[2]) * wv[j]
        };
        let sum = row(0) + row(1) + row(2);
        PlatePoint { height_mm: sum.x, cosine: sum.y, outside_mm: sum.z, outside_concha_mm: sum.w }
    }
}

/// Mean over `2 BLUR + 1` neighbours that are `step` entries apart.
fn blurred(values: &[f32], step: usize) -> Vec<f32> {
    /// Reaches 0.6 mm to either side.
    const BLUR: usize = 2;
    let last = values.len() - 1;
    let mean = |i: usize| {
        let around = (0..=2 * BLUR).map(|k| values[(i + k * step).saturating_sub(BLUR * step).min(last)]);
        around.sum::<f32>() / (2 * BLUR + 1) as f32
    };
    (0..values.len()).map(mean).collect()
}

/// Weights of the three nearest samples; `t` is the offset from the middle one, within ±0.5.
fn b_spline(t: f32) -> [f32; 3] {
    [0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)]
}

/// The curves of the plate in (u, v), mm.
struct Drawing {
    outline: Curve2,
    concha: Curve2,
    antihelix: Curve2,
    lower_crus: Curve2,
    /// Root of the helix, which divides the hollow.
    root: Curve2,
}

impl Drawing {
    fn new() -> Self {
        Self {
            outline: Curve2::closed(&[
                [0.0, -22.0],
                [1.0, 0.0],
                [2.0, 14.0],
                [6.0, 25.0],
                [15.0, 31.5],
                [25.0, 29.5],
                [32.0, 21.0],
                [34.5, 9.0],
                [33.0, -4.0],
                [28.5, -15.0],
                [23.0, -23.0],
                [17.0, -30.0],
                [9.0, -32.0],
                [3.0, -28.5],
            ]),
            concha: Curve2::closed(&[
                [1.0, -8.0],
                [2.0, 4.0],
                [8.0, 9.0],
                [16.0, 8.5],
                [20.5, 3.0],
                [20.5, -6.0],
                [16.5, -13.0],
                [10.0, -15.5],
                [6.5, -18.0],
                [3.5, -14.0],
            ]),
            antihelix: Curve2::open(&[
                [11.0, -18.5],
                [17.0, -16.0],
                [22.0, -9.0],
                [24.0, 0.0],
                [23.0, 8.0],
                [19.5, 16.0],
                [15.5, 23.0],
            ]),
            root: Curve2::open(&[[13.0, -1.0], [8.5, 2.5], [4.8, 7.0]]),
            lower_crus: Curve2::open(&[[23.0, 7.0], [17.0, 11.0], [10.0, 13.0], [4.0, 13.0]]),
        }
    }

    fn height_mm(&self, q: Vec2) -> f32 {
        let concha = smoothstep(1.0, -7.0, self.concha.signed_distance(q));
        let ridge = |d: f32, width: f32| (-(d / width).powi(2)).exp();
        let antihelix = ridge(self.antihelix.distance(q), 3.4);
        let crus = ridge(self.lower_crus.distance(q), 2.6);
        let fossa = ridge((q - Vec2::new(12.0, 19.0)).length(), 4.5);
        let lobe = smoothstep(-18.0, -26.0, q.y);
        let dish = ((q - Vec2::new(16.0, 0.0)).length() / 30.0).powi(2);
        // The larger of two ridges, rounded, so that the fork has no notch.
        let ridges = (antihelix.powi(4) + (0.8 * crus).powi(4)).sqrt().sqrt();
        let root = ridge(self.root.distance(q), 2.6) * smoothstep(15.0, 6.0, q.x);
        dish * 1.5 - concha * (CONCHA_DEPTH_MM - 7.0 * root) + 3.6 * ridges - fossa - 2.0 * lobe
    }
}
