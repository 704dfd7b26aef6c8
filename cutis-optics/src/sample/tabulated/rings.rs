//! A profile cut into rings, as many and where its cumulative distribution needs them.
//!
//! Symbols: y = sqrt(-ln(1 - xi)), in which the radius of a Gaussian is a straight line, that of a profile which goes as 1/r
//! towards the beam a parabola, and an exponential tail another one. Between two edges r(y) is the cubic through both radii
//! with both slopes, dr/dy = y (1 - xi)/(pi r p(r)); rings are halved until the light inside their middle says that this is r
//! to the tolerance. Slopes are held to 2.5 times the ring's own, which keeps the cubic growing (Fritsch & Carlson 1980,
//! doi:10.1137/0717021, not opened, allow 3; at 3 it may stand still in the middle, where the density has no end).

use crate::Profile;
use core::f64::consts::TAU;
use gauss_quad::GaussLegendre;
use std::sync::LazyLock;

/// Error of the radius that is let pass in the middle of a ring, half of what is promised anywhere in it: this part of the mean free path …
pub(super) const ERROR_OF_MEAN_FREE_PATH: f64 = 2e-6;
/// … and this of the radius, a fraction of what the last digits of `xi` mean there.
pub(super) const ERROR_OF_RADIUS: f64 = 1e-7;
/// Share beyond the outermost edge that no `xi` in f32 reaches: half of its last digit, and half of that.
const OUT_OF_REACH: f64 = 1.0 / 67_108_864.0;
/// Part of the lesser side (within or beyond) by which the light of a ring may differ from that of its halves.
const QUADRATURE_ERROR: f64 = 1e-7;
/// Share of all light that half of the last digit of `xi` means: what is finer, as the rounding errors of a numeric profile
/// far out, is not worth a halving.
const HALF_A_DIGIT: f64 = 1.0 / 33_554_432.0;
/// Halvings at most: a kink of the profile is met to this power of 2 of its ring.
const HALVINGS: usize = 16;
/// The innermost ring, in mean free paths: a tenth of the tolerance.
const INNERMOST: f64 = 5e-7;
/// From here on rings may be the last, in mean free paths.
const OUTSKIRTS: f64 = 4.0;
/// Below this share of all light, a ring that holds more than the one before it holds rounding errors only: those of a
/// numeric profile do not fall with the radius, but rings grow.
const TAIL: f64 = 1e-4;
/// A ring that holds less of the light is the last.
const NEGLIGIBLE: f64 = 1e-12;

/// Nodes and weights on [0, 1]; exact for polynomials to the ninth power.
static FIVE_NODES: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    let nodes = core::num::NonZeroUsize::new(5).expect("is not 0");
    GaussLegendre::new(nodes).iter().map(|&(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect()
});

/// The light between two radii: at once, and by halves.
#[derive(Debug, Clone, Copy)]
struct Ring {
    from_mm: f64,
    to_mm: f64,
    at_once: f64,
    halves: [f64; 2],
}

/// The distribution at an edge between rings.
#[derive(Debug, Clone, Copy)]
struct Edge {
    r_mm: f64,
    within: f64,
    beyond: f64,
    y: f64,
    /// dr/dy, mm.
    slope_mm: f64,
}

/// The radius between two edges: `cubic_mm` are the coefficients of powers of y - `y_from`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub y_from: f64,
    pub y_to: f64,
    pub cubic_mm: [f64; 4],
}

impl Piece {
    /// The cubic between two edges.
    fn between(from: &Edge, to: &Edge) -> Self {
        let width = to.y - from.y;
        let steepness_mm = (to.r_mm - from.r_mm) / width;
        let held = |slope_mm: f64| slope_mm.min(2.5 * steepness_mm);
        let (at_from, at_to) = (held(from.slope_mm), held(to.slope_mm));
        let second = (3.0 * steepness_mm - 2.0 * at_from - at_to) / width;
        let third = (at_from + at_to - 2.0 * steepness_mm) / (width * width);
        Self { y_from: from.y, y_to: to.y, cubic_mm: [from.r_mm, at_from, second, third] }
    }

    /// r at a y inside.
    pub fn radius_mm(&self, y: f64) -> f64 {
        let d = y - self.y_from;
        let [a, b, c, e] = self.cubic_mm;
        a + d * (b + d * (c + d * e))
    }
}

impl Ring {
    fn between(profile: &dyn Profile, from_mm: f64, to_mm: f64, at_once: f64) -> Self {
        let middle_mm = 0.5 * (from_mm + to_mm);
        let halves = [light(profile, from_mm, middle_mm), light(profile, middle_mm, to_mm)];
        Self { from_mm, to_mm, at_once, halves }
    }

    fn middle_mm(&self) -> f64 {
        0.5 * (self.from_mm + self.to_mm)
    }

    fn light(&self) -> f64 {
        self.halves[0] + self.halves[1]
    }

    fn halved(&self, profile: &dyn Profile) -> [Self; 2] {
        let middle_mm = self.middle_mm();
        [
            Self::between(profile, self.from_mm, middle_mm, self.halves[0]),
            Self::between(profile, middle_mm, self.to_mm, self.halves[1]),
        ]
    }
}

/// The pieces of r(y), inside first, of a profile with that mean free path; none of one without light. What is below 0 is
/// taken for 0.
pub(super) fn pieces(profile: &dyn Profile, mean_free_path_mm: f64) -> Vec<Piece> {
    let mut rings = doubling_rings(profile, mean_free_path_mm);
    for _ in 0..HALVINGS {
        let edges = edges(profile, &rings);
        let is_good = |(i, ring): (usize, &Ring)| ring.is_good(&edges[i], &edges[i + 1], mean_free_path_mm);
        let good: Vec<bool> = rings.iter().enumerate().map(is_good).collect();
        if good.iter().all(|&good| good) {
            break;
        }
        let parts =
            |(ring, good): (&Ring, bool)| if good { vec![*ring] } else { ring.halved(profile).to_vec() };
        rings = rings.iter().zip(good).flat_map(parts).collect();
    }
    let edges = edges(profile, &rings);
    // Rings without light, and those out of reach, have no width in y.
    edges
        .windows(2)
        .filter(|pair| pair[1].y > pair[0].y)
        .map(|pair| Piece::between(&pair[0], &pair[1]))
        .collect()
}

impl Ring {
    /// Whether the cubic meets the middle, and the integral has settled.
    fn is_good(&self, from: &Edge, to: &Edge, mean_free_path_mm: f64) -> bool {
        if to.y <= from.y {
            return true;
        }
        let middle_mm = self.middle_mm();
        let y = y_of(from.within + self.halves[0], to.beyond + self.halves[1]);
        let off_mm = (Piece::between(from, to).radius_mm(y) - middle_mm).abs();
        let lesser = (from.within + self.light()).min(to.beyond + self.light());
        let digit = HALF_A_DIGIT * (from.within + from.beyond);
        let digit_mm = digit * (self.to_mm - self.from_mm) / self.light();
        off_mm <= ERROR_OF_MEAN_FREE_PATH * mean_free_path_mm + ERROR_OF_RADIUS * middle_mm + digit_mm
            && (self.at_once - self.light()).abs() <= QUADRATURE_ERROR * lesser + digit
    }
}

/// Rings each as wide as all before it, out to where there is nothing more.
fn doubling_rings(profile: &dyn Profile, mean_free_path_mm: f64) -> Vec<Ring> {
    let ring =
        |from_mm: f64, to_mm: f64| Ring::between(profile, from_mm, to_mm, light(profile, from_mm, to_mm));
    let mut rings = vec![ring(0.0, INNERMOST * mean_free_path_mm)];
    let mut sum = rings[0].light();
    // 2^70 times the innermost is 6e14 mean free paths.
    for _ in 0..70 {
        let before = rings[rings.len() - 1];
        let next = ring(before.to_mm, 2.0 * before.to_mm);
        let is_noise = next.light() < TAIL * sum && next.light() > before.light();
        if next.from_mm > OUTSKIRTS * mean_free_path_mm && is_noise {
            break;
        }
        sum += next.light();
        rings.push(next);
        if next.from_mm > OUTSKIRTS * mean_free_path_mm && next.light() <= NEGLIGIBLE * sum {
            break;
        }
    }
    rings
}

/// 2 pi ∫ r R dr between two radii.
fn light(profile: &dyn Profile, from_mm: f64, to_mm: f64) -> f64 {
    let width_mm = to_mm - from_mm;
    let at = |&(unit, weight): &(f64, f64)| {
        let r_mm = from_mm + unit * width_mm;
        weight * r_mm * profile.at_mm(r_mm).max(0.0)
    };
    TAU * width_mm * FIVE_NODES.iter().map(at).sum::<f64>()
}

/// y by the light within and beyond, neither of which loses digits; it ends where `xi` does.
fn y_of(within: f64, beyond: f64) -> f64 {
    (within / beyond.max(OUT_OF_REACH * (within + beyond))).ln_1p().sqrt()
}

fn edges(profile: &dyn Profile, rings: &[Ring]) -> Vec<Edge> {
    let mut beyond: Vec<f64> =
        rings.iter().rev().scan(0.0, |sum, ring| Some(add(sum, ring.light()))).collect();
    beyond.reverse();
    beyond.push(0.0);
    let first = Edge { r_mm: 0.0, within: 0.0, beyond: beyond[0], y: 0.0, slope_mm: f64::INFINITY };
    let outer = rings.iter().zip(&beyond[1..]).scan(0.0, |sum, (ring, &beyond)| {
        let within = add(sum, ring.light());
        let (r_mm, y) = (ring.to_mm, y_of(within, beyond));
        let slope_mm = 2.0 * y * beyond / (TAU * r_mm * profile.at_mm(r_mm).max(0.0));
        // Where there is no light, the cubic is as steep as it may be.
        let slope_mm = if slope_mm.is_nan() { f64::INFINITY } else { slope_mm };
        Some(Edge { r_mm, within, beyond, y, slope_mm })
    });
    let mut edges: Vec<Edge> = core::iter::once(first).chain(outer).collect();
    // The innermost ring is a straight line.
    edges[0].slope_mm = edges[1].r_mm / edges[1].y;
    edges
}

fn add(sum: &mut f64, more: f64) -> f64 {
    *sum += more;
    *sum
}
