use super::*;
use std::f64::consts::TAU;

fn direction(cos: f64, azimuth_rad: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).sqrt();
    DVec3::new(sin * azimuth_rad.cos(), sin * azimuth_rad.sin(), cos)
}

#[test]
fn a_smooth_interface_obeys_snell_and_fresnel() {
    let interface = Interface { eta: 1.5, roughness: 0.0 };
    let mut random = Random::new(1, 0, 0);
    for cos in [0.2, 0.7, 1.0, -0.3, -0.8, -1.0] {
        let from = direction(cos, 0.3);
        let n = 4000;
        let mut reflected = 0.0;
        for _ in 0..n {
            let to = interface.sample(from, &mut random);
            assert!((to.length() - 1.0).abs() < 1e-12);
            if to.z * from.z > 0.0 {
                reflected += 1.0;
                assert!((to - DVec3::new(-from.x, -from.y, from.z)).length() < 1e-12);
            } else {
                let ratio = if cos > 0.0 { 1.5 } else { 1.0 / 1.5 };
                assert!((to.truncate() * ratio + from.truncate()).length() < 1e-12, "{from} to {to}");
            }
        }
        let expected = fresnel_reflectance(1.0, interface.eta_towards(from), from.z.abs()).0;
        // Five standard errors of a share, and one count.
        let error = (expected * (1.0 - expected) / f64::from(n)).sqrt();
        assert!((reflected / f64::from(n) - expected).abs() <= 5.0 * error + 1.0 / f64::from(n), "cos {cos}");
    }
}

/// Directions along each side of a bin: walks that meet a second facet are few, and must be among them.
const FINE: usize = 120;

/// Shares of what is drawn in bins of cosine and azimuth over the sphere, against the mean of the estimated density.
#[test]
fn what_is_drawn_from_a_rough_interface_is_what_it_says() {
    let (rows, columns) = (12, 6);
    for (eta, roughness, cos) in
        [(1.4, 0.3, 0.8), (1.4, 0.3, -0.8), (1.5, 0.6, 0.3), (1.3, 0.5, -0.4), (1.4, 0.15, -0.95)]
    {
        let interface = Interface { eta, roughness };
        let mut random = Random::new(3, 1, 4);
        let from = direction(cos, 0.0);
        let mut drawn = vec![0.0; rows * columns];
        let n = 60_000;
        for _ in 0..n {
            let to = interface.sample(from, &mut random);
            let row = ((to.z + 1.0) * 0.5 * rows as f64) as usize;
            let column = to.y.atan2(to.x).rem_euclid(TAU) / TAU * columns as f64;
            drawn[row.min(rows - 1) * columns + (column as usize).min(columns - 1)] += 1.0 / f64::from(n);
        }
        let (mut told, mut total) = (vec![0.0; rows * columns], 0.0);
        // A jittered grid of directions; every bin has as much of the sphere.
        let (many_rows, many_columns) = (rows * FINE, columns * FINE);
        for i in 0..many_rows {
            for j in 0..many_columns {
                let z = -1.0 + 2.0 * (i as f64 + random.unit()) / many_rows as f64;
                let turn = TAU * (j as f64 + random.unit()) / many_columns as f64;
                let part = interface.eval_per_sr(from, direction(z, turn), &mut random) * 2.0 * TAU
                    / (many_rows * many_columns) as f64;
                told[i / FINE * columns + j / FINE] += part;
                total += part;
            }
        }
        // All the light is somewhere; the estimate of the total varies by a few thousandths.
        assert!((total - 1.0).abs() < 0.02, "eta {eta} roughness {roughness} cos {cos}: {total}");
        for (drawn, told) in drawn.iter().zip(&told) {
            // Counts vary by their root; the estimates by less. Five standard errors, and one count.
            let error = (told.max(1e-4) / f64::from(n)).sqrt() + 0.01 * told;
            assert!(
                (drawn - told).abs() < 5.0 * error,
                "eta {eta} roughness {roughness} cos {cos}: {drawn} {told}"
            );
        }
    }
}

#[test]
fn light_and_eye_may_be_exchanged() {
    // Basic radiance: density(a -> b) cos a n_a² = density(b -> a) cos b n_b².
    let interface = Interface { eta: 1.4, roughness: 0.4 };
    let mut random = Random::new(2, 7, 1);
    let mean = |from, to, random: &mut Random| {
        let n = 40_000;
        (0..n).map(|_| interface.eval_per_sr(from, to, random)).sum::<f64>() / f64::from(n)
    };
    for (a, b) in [(0.7, 0.5), (0.8, -0.9), (-0.9, -0.6)] {
        let (from, to) = (direction(a, 0.2), direction(b, 2.9));
        let squared_index = |z: f64| if z < 0.0 { 1.96 } else { 1.0 };
        let there = mean(from, to, &mut random) * a.abs() * squared_index(a);
        let back = mean(to, from, &mut random) * b.abs() * squared_index(b);
        // The estimates vary by their own size: 0.5 % for the mean; 4 of them for the difference.
        assert!((there / back - 1.0).abs() < 0.03, "{a} {b}: {there} {back}");
    }
}

#[test]
fn a_matched_index_lets_light_pass() {
    let interface = Interface { eta: 1.0, roughness: 0.5 };
    let from = direction(0.3, 1.0);
    assert_eq!(interface.sample(from, &mut Random::new(0, 0, 0)), -from);
    assert!(interface.is_sharp());
}

#[test]
fn one_bounce_is_the_textbook_lobe() {
    // With facets nearly flat and light from above, hardly any light bounces twice: F D G2/(4 cos cos) of Walter et al. 2007,
    // with Smith's height-correlated G2.
    let interface = Interface { eta: 1.5, roughness: 0.2 };
    let (from, to) = (direction(0.9, 0.0), direction(0.85, 2.6));
    let slopes = slopes::Slopes::new(0.2);
    let facet = (from + to).normalize();
    let reflectance = fresnel_reflectance(1.0, 1.5, from.dot(facet)).0;
    let masking = 1.0 / (1.0 + slopes.lambda(from) + slopes.lambda(to));
    let textbook = reflectance * slopes.density_per_sr(facet) * masking / (4.0 * from.z);
    let mut random = Random::new(9, 0, 0);
    let n = 100_000;
    let ours = (0..n).map(|_| interface.eval_per_sr(from, to, &mut random)).sum::<f64>() / f64::from(n);
    assert!((ours / textbook - 1.0).abs() < 0.01, "{ours} {textbook}");
}
