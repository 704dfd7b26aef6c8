//! Seams as gaps: along them the light of both sides is held together, so that as much flows out of one chart as into the other.
//!
//! Bilinear light of two charts does not quite meet at their seam. The symmetric terms of Nitsche (1971) mend that: what flows
//! across, by the slopes of both sides, times the gap, and a spring that pulls the gap shut. The slope of a cell that a seam has left
//! little of is a poor witness: one beside it is asked instead. Sides count by what their witnesses can bear (Annavarapu, Hautefeuille
//! & Dolbow 2012), and what those cannot bear is left out, so that light never grows.

use super::cells::{Cell, Cells};
use super::metric::{Metric, derivatives_mm_per_texel};
use super::seam_edges::{SeamEdge, seam_edges};
use super::shore::{Read, Shore, centre};
use super::witness::{Witness, Witnesses};
use cutis_scene::Object;
use glam::{DMat3, DVec3, Mat4, Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Places along a seam per texel.
const PLACES_PER_TEXEL: f32 = 2.0;
/// Strength of the spring, by the width of a texel.
const SPRING: f32 = 1.5;
/// Slopes that a cell cannot bear at all, by the area of a texel.
const UNBEARABLE: f32 = 1e6;

/// A place of a seam, seen from both sides.
#[derive(Debug, Clone)]
pub struct Gap {
    sides: [Side; 2],
}

/// A place of a seam, seen from one side.
#[derive(Debug, Clone)]
struct Side {
    triangle: u32,
    /// The corner of the triangle at which the seam's edge begins.
    corner: u8,
    cell: u32,
    /// Place in the cell's square.
    place: Vec2,
    /// Who tells the slope.
    witness: Witness,
    /// The nearest place in the witness's square.
    witness_place: Vec2,
    /// Part of the edge that it stands for.
    part: f32,
}

/// A gap by texels: light on one side less that on the other, and what flows from there to here, per mm of the seam.
#[derive(Debug, Clone)]
pub struct Jump {
    /// Texels, the gap's weight of each, and the flow's, 1/mm.
    pub terms: Vec<(u32, f32, f32)>,
    /// Length of the seam that it stands for, mm.
    pub length_mm: f32,
    /// Strength of the spring, 1/mm.
    pub spring_per_mm: f32,
    /// The witnesses on both sides.
    pub witnesses: [Witness; 2],
    /// Part of each witness's energy that its flow takes at most.
    pub load: f32,
}

/// Places along all seams.
pub fn gaps(shore: &Shore, cells: &Cells, whole: &[bool]) -> Vec<Gap> {
    let witnesses = Witnesses { shore, cells, whole };
    seam_edges(&shore.ground).par_iter().flat_map_iter(|edge| along_edge(&witnesses, edge)).collect()
}

fn along_edge(witnesses: &Witnesses, edge: &SeamEdge) -> Vec<Gap> {
    let count = edge.place_count(PLACES_PER_TEXEL, witnesses.shore.size());
    let part = 1.0 / count as f32;
    let gap = |[here, beyond]: [Vec2; 2]| {
        let here = side(witnesses, edge.sides[0], here, part)?;
        let beyond = side(witnesses, edge.sides[1], beyond, part)?;
        Some(Gap { sides: [here, beyond] })
    };
    edge.places(count).filter_map(gap).collect()
}

fn side(witnesses: &Witnesses, (triangle, corner): (u32, u8), at: Vec2, part: f32) -> Option<Side> {
    let (size, cells) = (witnesses.shore.size(), witnesses.cells);
    let origin = (at - 0.5).floor().clamp(Vec2::ZERO, Vec2::splat(size as f32 - 2.0));
    let cell = cells.of(origin.y as usize * size + origin.x as usize, triangle)?;
    let place = at - 0.5 - origin;
    // Texture coordinates may leave the map.
    let is_on_map = place.min_element() >= -0.5 && place.max_element() <= 1.5;
    let witness = witnesses.at(cell, triangle, at);
    let witness_place = (at - centre(witness.first(&cells.all), size)).clamp(Vec2::ZERO, Vec2::ONE);
    is_on_map.then_some(Side { triangle, corner, cell, place, witness, witness_place, part })
}

impl Gap {
    /// By texels, for the pose of the mesh, with the slopes of witnesses; nothing is linked where a side has no extent.
    pub fn jump(
        &self,
        object: &Object,
        size: usize,
        metrics: &[Metric],
        cells: &[Cell],
        slopes: impl Fn(Witness) -> Mat4,
    ) -> Jump {
        let nothing = Measures { flows: [Vec2::ZERO; 2], length_mm: 0.0, spring_per_mm: 0.0, load: 0.0 };
        let Measures { flows, length_mm, spring_per_mm, load } =
            self.measures(object, size, metrics, cells, slopes).unwrap_or(nothing);
        let witnesses = self.sides.each_ref().map(|side| side.witness);
        let mut jump = Jump { terms: Vec::new(), length_mm, spring_per_mm, witnesses, load };
        for (side, (sign, flow)) in self.sides.iter().zip([1.0, -1.0].into_iter().zip(flows)) {
            jump.add(&cells[side.cell as usize].corners, side.gap_shares() * sign, Vec4::ZERO);
            jump.add(&side.witness.corners(cells, size), Vec4::ZERO, side.slope_shares(flow));
        }
        jump
    }

    fn measures(
        &self,
        object: &Object,
        size: usize,
        metrics: &[Metric],
        cells: &[Cell],
        slopes: impl Fn(Witness) -> Mat4,
    ) -> Option<Measures> {
        let [here, beyond] = &self.sides;
        let p = object.mesh.corners_mm(here.triangle as usize);
        let corner = usize::from(here.corner);
        let length_mm = (p[(corner + 1) % 3] - p[corner]).length() * here.part;
        let outwards =
            |side: &Side| side.outwards(object, size, metrics, cells[side.cell as usize].conductivity());
        let (out, into) = (outwards(here)?, outwards(beyond)?);
        // By the coarser side, which cannot tell more.
        let (fine, coarse) = (out.length().max(into.length()), out.length().min(into.length()));
        let spring_per_mm = SPRING * 2.0 * coarse * fine / (coarse + fine);
        let burdens = [(here, out), (beyond, into)].map(|(side, step)| {
            let most = UNBEARABLE * step.length_squared();
            burden(&slopes(side.witness), side.slope_shares(step)).min(most).max(f32::MIN_POSITIVE)
        });
        let sum = burdens[0] + burdens[1];
        let load = length_mm / spring_per_mm * burdens[0] * burdens[1] / sum;
        let flows = [out * (burdens[1] / sum), -into * (burdens[0] / sum)];
        load.is_finite().then_some(Measures { flows, length_mm, spring_per_mm, load })
    }
}

/// What follows from the pose at a place of a seam.
struct Measures {
    /// What flows from there to here by the slopes of each side, texels per mm.
    flows: [Vec2; 2],
    length_mm: f32,
    spring_per_mm: f32,
    load: f32,
}

/// The most that a slope's square can be by a cell's energy: d·S⁻¹·d, where one corner stands still.
fn burden(slopes: &Mat4, slope: Vec4) -> f32 {
    let of = |v: Vec4| DVec3::new(f64::from(v.y), f64::from(v.z), f64::from(v.w));
    let energy = DMat3::from_cols(of(slopes.y_axis), of(slopes.z_axis), of(slopes.w_axis));
    let burden = of(slope).dot(energy.inverse() * of(slope));
    if burden.is_finite() && burden > 0.0 { burden as f32 } else { f32::INFINITY }
}

impl Side {
    /// One millimetre straight out of the triangle across its edge, in texels, as far as the metric is believed, times how well
    /// heat flows.
    fn outwards(&self, object: &Object, size: usize, metrics: &[Metric], conductivity: f32) -> Option<Vec2> {
        let [xu, xv] = derivatives_mm_per_texel(object, self.triangle as usize, size)?;
        let p = object.mesh.corners_mm(self.triangle as usize);
        let i = usize::from(self.corner);
        let edge = (p[(i + 1) % 3] - p[i]).try_normalize()?;
        let inwards: Vec3 = p[(i + 2) % 3] - p[i];
        let out = -(inwards - edge * inwards.dot(edge)).try_normalize()?;
        // Slopes along u and v become slopes along the surface by the inverse of the metric.
        let Metric { a, area_mm2 } = metrics[self.triangle as usize];
        let (u, v) = (xu.dot(out), xv.dot(out));
        let texels = Vec2::new(a.x * u + a.y * v, a.y * u + a.z * v) * (conductivity / area_mm2);
        texels.is_finite().then_some(texels)
    }

    /// Shares of its cell's corners in the light of the place.
    fn gap_shares(&self) -> Vec4 {
        let Vec2 { x, y } = self.place;
        Vec4::new((1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y)
    }

    /// Shares of its witness's corners in the slope along a step.
    fn slope_shares(&self, step: Vec2) -> Vec4 {
        let Vec2 { x, y } = self.witness_place;
        let along_u = Vec4::new(y - 1.0, 1.0 - y, -y, y);
        let along_v = Vec4::new(x - 1.0, -x, 1.0 - x, x);
        along_u * step.x + along_v * step.y
    }
}

impl Jump {
    /// Adds what corners share in the gap and in the flow.
    fn add(&mut self, corners: &[Read; 4], gaps: Vec4, flows: Vec4) {
        for (k, read) in corners.iter().enumerate() {
            for &(texel, weight) in read {
                let (gap, flow) = (gaps[k] * weight, flows[k] * weight);
                match self.terms.iter_mut().find(|(known, ..)| *known == texel) {
                    Some((_, gaps, flows)) => (*gaps, *flows) = (*gaps + gap, *flows + flow),
                    None => self.terms.push((texel, gap, flow)),
                }
            }
        }
    }
}
