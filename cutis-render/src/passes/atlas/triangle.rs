//! Weights of a triangle's corners at places of the texture.

use glam::Vec2;

/// Weights of the second and the third corner of a triangle at a point of its plane; not numbers if it has no area.
pub fn barycentric([a, b, c]: [Vec2; 3], p: Vec2) -> [f32; 2] {
    let area = (b - a).perp_dot(c - a);
    [(c - p).perp_dot(a - p) / area, (a - p).perp_dot(b - p) / area]
}

/// Weights of corners of which none is outside; of a triangle without an area, which has none, the first corner's.
pub fn inside(weights: [f32; 2]) -> [f32; 2] {
    let [b1, b2] = weights.map(|b| if b.is_finite() { b.clamp(0.0, 1.0) } else { 0.0 });
    [b1, b2.min(1.0 - b1)]
}

/// Barycentric weights (second, third corner) of the triangle's point nearest to an outside point, and the squared
/// distance.
pub fn nearest_on_triangle(corners: [Vec2; 3], p: Vec2) -> (f32, f32, f32) {
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
