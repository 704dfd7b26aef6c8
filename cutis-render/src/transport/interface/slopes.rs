//! Facets with Gaussian slopes: Beckmann's distribution, and what is seen of it from a direction.
//!
//! Slopes have the density exp(-(x² + y²)/m²)/(pi m²). From direction w, which may lie below the horizon, a facet of slopes
//! (x, y) is seen as large as (w_z - w_x x - w_y y)+, so that along the azimuth of w the slope has the density
//! (c - s x)+ exp(-x²/m²), up to a factor, with c and s cosine and sine of the angle to the normal; across it, it stays
//! Gaussian. Source: Heitz, Hanika, d'Eon & Dachsbacher 2016, doi:10.1145/2897824.2925943 (not opened).

use crate::transport::random::Random;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Sine below which a direction counts as vertical.
const VERTICAL: f64 = 1e-9;

/// Facets with root-mean-square slope m.
#[derive(Debug, Clone, Copy)]
pub struct Slopes {
    m: f64,
}

impl Slopes {
    pub fn new(m: f64) -> Self {
        Self { m }
    }

    /// Area of the facets seen from `w` per area of the flat surface, projected along `w`; at least the cosine.
    pub fn projected_area(&self, w: DVec3) -> f64 {
        let sin = w.truncate().length();
        if sin < VERTICAL {
            return w.z.max(0.0);
        }
        let a = w.z / (self.m * sin);
        let area = 0.5 * libm::erfc(-a) * w.z + self.m * sin * (-a * a).exp() / (2.0 * PI.sqrt());
        // Where almost nothing is seen both terms cancel.
        area.max(w.z).max(0.0)
    }

    /// Smith's Lambda of a direction that is not level: below -1 where it points down.
    pub fn lambda(&self, w: DVec3) -> f64 {
        self.projected_area(w) / w.z - 1.0
    }

    /// Density of the normals `facet` among all, 1/sr (Beckmann).
    pub fn density_per_sr(&self, facet: DVec3) -> f64 {
        if facet.z <= 0.0 {
            return 0.0;
        }
        let (cos2, m2) = (facet.z * facet.z, self.m * self.m);
        let tan2 = (1.0 - cos2).max(0.0) / cos2;
        (-tan2 / m2).exp() / (PI * m2 * cos2 * cos2)
    }

    /// Density of the normals `facet` among those seen from `w`, 1/sr.
    pub fn visible_density_per_sr(&self, w: DVec3, facet: DVec3) -> f64 {
        let area = self.projected_area(w);
        let seen = w.dot(facet);
        if seen <= 0.0 || area <= 0.0 { 0.0 } else { seen * self.density_per_sr(facet) / area }
    }

    /// A normal with that density.
    pub fn sample_visible(&self, w: DVec3, random: &mut Random) -> DVec3 {
        let (sin, across) = (w.truncate().length(), random.gaussian_pair());
        if sin < VERTICAL {
            return normal(across * self.m);
        }
        let along = sample_slope_along(w.z / (self.m * sin), random);
        let azimuth = w.truncate() / sin;
        normal((azimuth * along + azimuth.perp() * across.y) * self.m)
    }
}

/// The normal of a facet.
fn normal(slopes: DVec2) -> DVec3 {
    (-slopes).extend(1.0).normalize()
}

/// A number with density (a - y)+ e^(-y²), up to a factor.
fn sample_slope_along(a: f64, random: &mut Random) -> f64 {
    // Drawn from a simpler density that lies above, and kept as often as the two ask for.
    loop {
        let (y, kept) = if a >= 0.0 {
            // (a + |y|) e^(-y²): a Gaussian of mass a sqrt(pi), and a root of an exponential of mass 1.
            let gaussian = a * PI.sqrt();
            let y = if random.unit() * (gaussian + 1.0) < gaussian {
                random.gaussian_pair().x
            } else {
                let root = (-random.unit().ln()).sqrt();
                if random.unit() < 0.5 { root } else { -root }
            };
            (y, (a - y) / (a + y.abs()))
        } else {
            // Below the horizon only slopes below a are seen: |y| e^(-y²) from there on.
            let root = (a * a - random.unit().ln()).sqrt();
            (-root, (root + a) / root)
        };
        if random.unit() < kept {
            return y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn what_is_seen_adds_up_to_the_projected_area() {
        for m in [0.1, 0.3, 0.8] {
            let slopes = Slopes::new(m);
            for cos in [-0.4f64, -0.05, 0.05, 0.3, 0.9, 1.0] {
                let sin = (1.0 - cos * cos).sqrt();
                let w = DVec3::new(0.6 * sin, -0.8 * sin, cos);
                let (rings, sectors) = (1500, 300);
                let (step, turn) = (FRAC_PI_2 / f64::from(rings), TAU / f64::from(sectors));
                let mut sum = 0.0;
                for i in 0..rings {
                    let theta = (f64::from(i) + 0.5) * step;
                    for j in 0..sectors {
                        let azimuth = DVec2::from_angle((f64::from(j) + 0.5) * turn) * theta.sin();
                        let facet = azimuth.extend(theta.cos());
                        sum += slopes.visible_density_per_sr(w, facet) * theta.sin() * step * turn;
                    }
                }
                // The midpoint rule errs at the edge of what is seen, by a step's part.
                let expected = if slopes.projected_area(w) > 1e-12 { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 5e-3, "m {m} cos {cos}: {sum}");
            }
        }
    }

    #[test]
    fn normals_follow_what_is_seen() {
        // Shares in bins of cos and azimuth against the density's integral over the bin; chi-square of 59 degrees of freedom
        // exceeds 115 once in 50,000.
        let slopes = Slopes::new(0.4);
        let mut random = Random::new(5, 0, 0);
        for cos in [-0.2f64, 0.1, 0.5, 1.0] {
            let sin = (1.0 - cos * cos).sqrt();
            let w = DVec3::new(sin, 0.0, cos);
            let (rows, columns, fine) = (10, 6, 60);
            // Bins even in e^(-tan²/m²), which Beckmann's own distribution fills evenly: what is seen of it is more or less by
            // seen/(cos times area).
            let theta = |share: f64| (0.4 * (-(1.0 - share).ln()).sqrt()).atan();
            let mut expected = vec![0.0; rows * columns];
            for i in 0..rows * fine {
                let middle = theta((i as f64 + 0.5) / (rows * fine) as f64);
                for j in 0..columns * fine {
                    let turn = TAU * (j as f64 + 0.5) / (columns * fine) as f64;
                    let facet = (DVec2::from_angle(turn) * middle.sin()).extend(middle.cos());
                    let seen =
                        slopes.visible_density_per_sr(w, facet) / (slopes.density_per_sr(facet) * facet.z);
                    expected[i / fine * columns + j / fine] += seen / ((rows * columns * fine * fine) as f64);
                }
            }
            let mut counts = vec![0.0; rows * columns];
            let n = 20_000;
            for _ in 0..n {
                let facet = slopes.sample_visible(w, &mut random);
                let tan2 = (1.0 - facet.z * facet.z) / (facet.z * facet.z);
                let row = ((1.0 - (-tan2 / 0.16).exp()) * rows as f64) as usize;
                let turn = facet.y.atan2(facet.x).rem_euclid(TAU) / TAU;
                counts[row.min(rows - 1) * columns + ((turn * columns as f64) as usize).min(columns - 1)] +=
                    1.0;
            }
            let total: f64 = expected.iter().sum();
            let chi2: f64 = expected
                .iter()
                .zip(&counts)
                .map(|(e, c)| (e / total * f64::from(n), c))
                .filter(|(e, _)| *e > 1.0)
                .map(|(e, c): (f64, &f64)| (c - e).powi(2) / e)
                .sum();
            assert!(chi2 < 115.0, "cos {cos}: {chi2}");
        }
    }
}
