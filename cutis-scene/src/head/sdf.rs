//! Small tools for sculpting with distance functions: shapes, soft unions and cuts, swept curves, clay bumps.
//!
//! Values are in mm, negative inside. Only near the surface do they approximate a distance; the mesher divides by the
//! gradient's length, so a factor of two does no harm. Shapes and soft operators after Quilez, "Distance functions"
//! and "Smooth minimum" (iquilezles.org; from memory, not opened while writing).

use glam::{Mat3, Vec2, Vec3};

/// Union whose joint is filled with a fillet about `k_mm` wide.
pub fn soft_union(a: f32, b: f32, k_mm: f32) -> f32 {
    let h = (k_mm - (a - b).abs()).max(0.0) / k_mm;
    a.min(b) - h * h * k_mm * 0.25
}

/// `a` without `b`, the edge rounded over about `k_mm`.
pub fn soft_cut(a: f32, b: f32, k_mm: f32) -> f32 {
    -soft_union(-a, b, k_mm)
}

/// The common part of both, the edge rounded over about `k_mm`.
pub fn soft_intersection(a: f32, b: f32, k_mm: f32) -> f32 {
    -soft_union(-a, -b, k_mm)
}

/// Ellipsoid about the origin. First-order distance, exact on the surface.
pub fn ellipsoid(p: Vec3, radii_mm: Vec3) -> f32 {
    let k0 = (p / radii_mm).length();
    let k1 = (p / (radii_mm * radii_mm)).length();
    // At the very centre both vanish: the smallest radius is the depth there.
    if k1 < 1e-9 { -radii_mm.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// A bell of height 1 over an ellipsoidal neighbourhood: clay to add where it is subtracted from a distance.
pub fn bell(p: Vec3, radii_mm: Vec3) -> f32 {
    (-(p / radii_mm).length_squared()).exp()
}

/// Profile of a groove of depth 1 at a distance from its middle line.
pub fn groove(distance_mm: f32, width_mm: f32) -> f32 {
    let t = distance_mm / width_mm;
    (-t * t).exp()
}

/// 0 below `from`, 1 above `to`, smooth between.
pub fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// |x| rounded off over `radius_mm`, so that mirrored halves meet without a crease.
pub fn soft_abs(x: f32, radius_mm: f32) -> f32 {
    x.hypot(radius_mm)
}

/// Rotation about the x axis that lifts +z towards +y by `degrees`.
pub fn pitch(degrees: f32) -> Mat3 {
    Mat3::from_rotation_x(-degrees.to_radians())
}

/// A tube of changing radius along a smooth curve.
pub struct Sweep {
    spans: Vec<Span>,
    bounds: [Vec3; 2],
}

/// A few consecutive pieces of a sweep and the box around them.
struct Span {
    pieces: Vec<Piece>,
    bounds: [Vec3; 2],
}

/// A straight piece: a cone with round ends.
struct Piece {
    start: Vec3,
    along: Vec3,
    inverse_square: f32,
    radius: f32,
    widening: f32,
}

impl Sweep {
    /// A tube through `knots` (x, y, z, radius; mm), eight straight pieces between two knots.
    pub fn new(knots: &[[f32; 4]]) -> Self {
        let beads: Vec<_> =
            spline(knots, 8).into_iter().map(|k| (Vec3::new(k[0], k[1], k[2]), k[3])).collect();
        let spans =
            (0..beads.len() - 1).step_by(4).map(|i| span(&beads[i..(i + 5).min(beads.len())])).collect();
        Self { spans, bounds: bounds(&beads) }
    }

    /// Distance to the tube; further than `reach_mm` from its box only the distance to the box.
    pub fn distance(&self, p: Vec3, reach_mm: f32) -> f32 {
        let outside = to_box(p, &self.bounds);
        if outside > reach_mm {
            return outside;
        }
        self.spans.iter().fold(f32::MAX, |best, span| {
            // Inside a box the tube may be nearer than the box: only boxes off the point are skipped.
            if to_box(p, &span.bounds) > best.max(0.0) {
                return best;
            }
            span.pieces.iter().fold(best, |best, piece| best.min(piece.distance(p)))
        })
    }
}

impl Piece {
    fn distance(&self, p: Vec3) -> f32 {
        let q = p - self.start;
        let t = (q.dot(self.along) * self.inverse_square).clamp(0.0, 1.0);
        (q - self.along * t).length() - (self.radius + self.widening * t)
    }
}

fn span(beads: &[(Vec3, f32)]) -> Span {
    let pieces = beads.windows(2).map(|pair| {
        let ((start, radius), (end, end_radius)) = (pair[0], pair[1]);
        let along = end - start;
        Piece {
            start,
            along,
            inverse_square: along.length_squared().max(1e-12).recip(), // two knots in one place: no direction
            radius,
            widening: end_radius - radius,
        }
    });
    Span { pieces: pieces.collect(), bounds: bounds(beads) }
}

fn bounds(beads: &[(Vec3, f32)]) -> [Vec3; 2] {
    beads.iter().fold([Vec3::MAX, Vec3::MIN], |[lo, hi], &(p, r)| [lo.min(p - r), hi.max(p + r)])
}

fn to_box(p: Vec3, [lo, hi]: &[Vec3; 2]) -> f32 {
    (*lo - p).max(p - *hi).max(Vec3::ZERO).length()
}

/// A curve in a plane, open or closed.
pub struct Curve2 {
    points: Vec<Vec2>,
}

impl Curve2 {
    /// An open curve through the knots.
    pub fn open(knots: &[[f32; 2]]) -> Self {
        Self { points: spline(knots, 5).into_iter().map(Vec2::from).collect() }
    }

    /// A closed curve through the knots.
    pub fn closed(knots: &[[f32; 2]]) -> Self {
        let n = knots.len();
        // Three extra knots make the ends smooth too; the doubled pieces are then dropped.
        let wrapped: Vec<_> = (0..n + 3).map(|i| knots[(i + n - 1) % n]).collect();
        let points = spline(&wrapped, 5);
        Self { points: points[5..=5 * (n + 1)].iter().map(|&p| Vec2::from(p)).collect() }
    }

    /// Distance to the curve, mm.
    pub fn distance(&self, p: Vec2) -> f32 {
        self.points.windows(2).fold(f32::MAX, |best, s| best.min(segment_square(p, s[0], s[1]))).sqrt()
    }

    /// Distance to a closed curve, negative inside, mm.
    pub fn signed_distance(&self, p: Vec2) -> f32 {
        let crossings = self.points.windows(2).filter(|s| {
            (s[0].y > p.y) != (s[1].y > p.y)
                && p.x < s[0].x + (p.y - s[0].y) / (s[1].y - s[0].y) * (s[1].x - s[0].x)
        });
        let inside = crossings.count() % 2 == 1;
        if inside { -self.distance(p) } else { self.distance(p) }
    }
}

fn segment_square(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let ab = b - a;
    let t = ((p - a).dot(ab) / ab.length_squared()).clamp(0.0, 1.0);
    (p - a - ab * t).length_squared()
}

/// Catmull–Rom spline through the knots, `pieces` samples from one to the next.
fn spline<const N: usize>(knots: &[[f32; N]], pieces: usize) -> Vec<[f32; N]> {
    let knot = |i: isize| knots[i.clamp(0, knots.len() as isize - 1) as usize];
    let mut samples = Vec::with_capacity(knots.len() * pieces);
    for i in 0..knots.len() as isize - 1 {
        let k = [knot(i - 1), knot(i), knot(i + 1), knot(i + 2)];
        for step in 0..pieces {
            let t = step as f32 / pieces as f32;
            samples.push(std::array::from_fn(|c| catmull_rom(k.map(|k| k[c]), t)));
        }
    }
    samples.push(knot(knots.len() as isize - 1));
    samples
}

fn catmull_rom([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    let (linear, square) = (c - a, 2.0 * a - 5.0 * b + 4.0 * c - d);
    let cube = 3.0 * (b - c) + d - a;
    b + 0.5 * t * (linear + t * (square + t * cube))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soft_union_only_adds_and_a_soft_cut_only_takes() {
        for (a, b) in [(1.0, 2.0), (-3.0, 0.5), (0.1, 0.1)] {
            assert!(soft_union(a, b, 1.0) <= a.min(b));
            assert!(soft_cut(a, b, 1.0) >= a.max(-b));
        }
        assert!((soft_union(5.0, 1.0, 2.0) - 1.0).abs() < 1e-6, "far apart nothing is filled");
    }

    #[test]
    fn an_ellipsoid_is_zero_at_its_poles() {
        let r = Vec3::new(3.0, 5.0, 7.0);
        for p in [Vec3::X * 3.0, Vec3::Y * 5.0, Vec3::NEG_Z * 7.0] {
            assert!(ellipsoid(p, r).abs() < 1e-5);
        }
    }

    #[test]
    fn a_closed_curve_knows_its_inside() {
        let ring = Curve2::closed(&[[10.0, 0.0], [0.0, 10.0], [-10.0, 0.0], [0.0, -10.0]]);
        assert!(ring.signed_distance(Vec2::ZERO) < -8.0);
        assert!(ring.signed_distance(Vec2::new(15.0, 1.0)) > 4.0);
    }
}
