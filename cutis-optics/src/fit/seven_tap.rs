//! Variances that a chain of seven-tap blurs can make (d'Eon, Luebke & Enderton 2007, section 5.1): v_1 ≤ l², so that the
//! first blur does not undersample, and v_i ≤ 4 v_(i-1), so that no later one does.
//!
//! In x_1 = ln v_1, x_i = ln v_i - ln v_(i-1) these are plain upper bounds, and steps are taken in x.

use nalgebra::{DMatrix, DVector};

/// Bounds on the variances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SevenTap {
    /// ln of the square of the shortest mean free path, mm².
    pub(super) ln_first_mm2: f64,
}

impl SevenTap {
    /// The nearest variances (ln) that are allowed, from the narrowest on; sorted.
    pub(super) fn allowed(self, ln_variances: &[f64]) -> Vec<f64> {
        let mut sorted = ln_variances.to_vec();
        sorted.sort_by(f64::total_cmp);
        let mut bound = self.ln_first_mm2;
        for ln_v in &mut sorted {
            *ln_v = ln_v.min(bound);
            bound = *ln_v + 4f64.ln();
        }
        sorted
    }

    /// A step that minimises the quadratic model of `gradient` and `curvature` (already damped), variables at their bounds
    /// left where they are if they want to go beyond.
    pub(super) fn step(
        self,
        ln_variances: &[f64],
        gradient: &DVector<f64>,
        curvature: &DMatrix<f64>,
    ) -> Option<DVector<f64>> {
        let n = ln_variances.len();
        // ln v = L x, L the lower triangle of ones.
        let l = DMatrix::from_fn(n, n, |i, j| if j <= i { 1.0 } else { 0.0 });
        let (gradient, curvature) = (l.tr_mul(gradient), l.tr_mul(curvature) * &l);
        let room = |i: usize| match i {
            0 => self.ln_first_mm2 - ln_variances[0],
            _ => ln_variances[i - 1] + 4f64.ln() - ln_variances[i],
        };
        let x = bounded_minimum(&gradient, &curvature, (0..n).map(|i| room(i).max(0.0)).collect())?;
        Some(l * x)
    }
}

/// Minimum of g·x + x·H x/2 below the bounds, which are not negative: variables that would pass theirs are put there, one
/// round after the other, and the others make the best of it.
fn bounded_minimum(g: &DVector<f64>, h: &DMatrix<f64>, bounds: Vec<f64>) -> Option<DVector<f64>> {
    let n = bounds.len();
    let mut x = DVector::zeros(n);
    let mut free: Vec<usize> = (0..n).collect();
    while !free.is_empty() {
        let force = -(g + h * &x).select_rows(&free);
        let solved = h.select_rows(&free).select_columns(&free).cholesky()?.solve(&force);
        let passes = |place: usize| solved[place] > bounds[free[place]];
        if !(0..free.len()).any(passes) {
            free.iter().zip(solved.iter()).for_each(|(&i, &step)| x[i] = step);
            break;
        }
        let (bound, rest): (Vec<usize>, Vec<usize>) = (0..free.len()).partition(|&place| passes(place));
        bound.iter().for_each(|&place| x[free[place]] = bounds[free[place]]);
        free = rest.iter().map(|&place| free[place]).collect();
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use crate::presets::measured_media::MEASURED_MEDIA;
    use crate::{Dipole, FitMethod, FitSettings, Profile, fit, fit_with};

    fn keeps_bounds(variances_mm2: &[f64], mean_free_path_mm: f64) -> bool {
        // Rounding of ln and exp.
        let at_most = |v: f64, bound: f64| v <= bound * (1.0 + 1e-12);
        at_most(variances_mm2[0], mean_free_path_mm.powi(2))
            && variances_mm2.windows(2).all(|v| at_most(v[1], 4.0 * v[0]))
    }

    #[test]
    fn bounds_are_kept_and_cost_only_what_they_must() {
        for (name, media) in MEASURED_MEDIA {
            let dipole = Dipole::new(&media[1]).unwrap();
            let l_mm = dipole.depth_real_mm();
            for gaussians in [3, 5] {
                for method in [FitMethod::Optimal, FitMethod::Energy] {
                    let settings = FitSettings { gaussians, method, seven_tap_mm: Some(l_mm) };
                    let bound = fit_with(&dipole, &settings).unwrap();
                    let free = fit(&dipole, gaussians, method).unwrap();
                    let variances: Vec<f64> = bound.sum.terms.iter().map(|g| g.variance_mm2).collect();
                    assert!(keeps_bounds(&variances, l_mm), "{name} {gaussians}: {variances:?}");
                    let (kept, best) = (bound.relative_rms_power_error, free.relative_rms_power_error);
                    assert!(kept > best * (1.0 - 1e-6), "{name} {gaussians}: {kept} beats {best}");
                    let variances: Vec<f64> = free.sum.terms.iter().map(|g| g.variance_mm2).collect();
                    if keeps_bounds(&variances, l_mm) {
                        assert!(kept < best * (1.0 + 1e-6), "{name} {gaussians}: {kept} though free {best}");
                    }
                }
            }
        }
    }

    #[test]
    fn at_the_bounds_nothing_near_is_better() {
        // Three Gaussians for cream: both ratios lie at 4. All allowed neighbours are worse.
        let dipole = Dipole::new(&MEASURED_MEDIA[3].1[1]).unwrap();
        let settings = FitSettings {
            gaussians: 3,
            method: FitMethod::Optimal,
            seven_tap_mm: Some(dipole.depth_real_mm()),
        };
        let best = fit_with(&dipole, &settings).unwrap();
        let v: Vec<f64> = best.sum.terms.iter().map(|g| g.variance_mm2).collect();
        assert!(v[1] / v[0] > 3.999 && v[2] / v[1] > 3.999, "{v:?}");
        for first in [0.9, 0.99, 1.01, 1.1] {
            for ratio in [3.6, 3.96, 4.0] {
                let moved = [v[0] * first, v[0] * first * 4.0, v[0] * first * 4.0 * ratio];
                if moved[0] > dipole.depth_real_mm().powi(2) || (first == 1.0 && ratio == 4.0) {
                    continue;
                }
                let other = crate::fit_weights(&[&dipole], &moved, FitMethod::Optimal).unwrap();
                assert!(other.relative_rms_power_error[0] > best.relative_rms_power_error, "{moved:?}");
            }
        }
        assert!(best.energy > 0.5 * dipole.total());
    }
}
