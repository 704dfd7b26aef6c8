//! Levenberg–Marquardt on the logarithms of the variances.
//!
//! Damping after Nielsen 1999 (report IMM-REP-1999-05, not opened) as commonly restated: the parameter follows the ratio of
//! the gain seen to the gain expected.

use super::problem::{Derivatives, Problem, Solution};
use super::seven_tap::SevenTap;
use nalgebra::{DMatrix, DVector};

/// Steps, taken or refused, before giving up: far more than any measured profile has needed.
const STEPS_MAX: usize = 300;
/// To the end: the last step promises less than this part of the cost; steps square the distance, so it leaves 1e-10 at most.
pub(super) const GAIN_LAST: f64 = 1e-5;
/// A small gain expected means "arrived" only where damping does not hold the step back.
const DAMPING_CALM: f64 = 1e-2;
/// Stop when ln v would move by less: the cost is quadratic around a minimum, so this is 1e-14 of it.
const STEP_MIN: f64 = 1e-7;
/// First damping, of the largest curvature.
const DAMPING_FIRST: f64 = 1e-3;
/// Least damping after a step that led uphill: less would hardly change it.
const DAMPING_REFUSED: f64 = 1e-2;
/// Damping falls at most so fast, by a step as good as expected.
const DAMPING_FALL: f64 = 0.1;
/// Longest step of one ln v: a factor e in the variance; beyond, the quadratic model is a fairy tale.
const STEP_MAX: f64 = 1.0;

/// Walks downhill from `start` until a step promises no more than `gain_last`, a part of the cost.
pub(super) fn descend(problem: &Problem, start: Solution, gain_last: f64) -> Solution {
    let mut here = start;
    let (mut damping, mut growth) = (DAMPING_FIRST, 2.0);
    let mut model = Model::new(problem, &here);
    for _ in 0..STEPS_MAX {
        let Some(step) = model.step(damping, problem.limits(), &here.ln_variances) else {
            // Positive only with the first damping.
            if damping > DAMPING_FIRST {
                break;
            }
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let expected = model.gain(&step);
        if step.amax() < STEP_MIN {
            break;
        }
        let is_last = damping < DAMPING_CALM && expected <= gain_last * here.cost;
        let there = problem.solve(&moved(problem, &here.ln_variances, &step));
        match there.filter(|there| there.cost < here.cost) {
            Some(there) => {
                let ratio = (here.cost - there.cost) / expected;
                damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(DAMPING_FALL);
                growth = 2.0;
                here = there;
                if is_last {
                    break;
                }
                model = Model::new(problem, &here);
            }
            None if is_last => break,
            None => {
                damping = (damping * growth).max(DAMPING_REFUSED);
                growth *= 2.0;
            }
        }
    }
    here
}

/// The quadratic model of the cost around a point.
struct Model {
    gradient: DVector<f64>,
    curvature: DMatrix<f64>,
}

impl Model {
    /// With the true curvature where that is positive, else Gauss and Newton's.
    fn new(problem: &Problem, at: &Solution) -> Self {
        let Derivatives { gradient, curvature, gauss_newton } = problem.derivatives(at);
        let positive = damped(&curvature, DAMPING_FIRST).cholesky().is_some();
        Self { gradient, curvature: if positive { curvature } else { gauss_newton } }
    }

    /// Damped step towards the minimum of the model, limited in length; `None` once rounding has eaten the curvature.
    fn step(&self, damping: f64, limits: Option<SevenTap>, at: &[f64]) -> Option<DVector<f64>> {
        let damped = damped(&self.curvature, damping);
        let step = match limits {
            Some(limits) => limits.step(at, &self.gradient, &damped)?,
            None => damped.cholesky()?.solve(&-&self.gradient),
        };
        let length = step.amax();
        length.is_finite().then(|| step * (STEP_MAX / length.max(STEP_MAX)))
    }

    /// Fall of the cost |r|² that the model expects.
    fn gain(&self, step: &DVector<f64>) -> f64 {
        -2.0 * self.gradient.dot(step) - step.dot(&(&self.curvature * step))
    }
}

/// Scale-free per parameter (Marquardt); the floor keeps terms without weight from making it singular.
fn damped(curvature: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut damped = curvature.clone();
    let largest = damped.diagonal().amax();
    for i in 0..damped.nrows() {
        damped[(i, i)] += damping * damped[(i, i)].abs().max(1e-9 * largest);
    }
    damped
}

fn moved(problem: &Problem, ln_variances: &[f64], step: &DVector<f64>) -> Vec<f64> {
    let there: Vec<f64> = ln_variances.iter().zip(step.iter()).map(|(v, s)| v + s).collect();
    problem.allowed(&there)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{FitMethod, Gaussian, GaussianSum};

    #[test]
    fn finds_the_gaussians_a_sum_was_made_of() {
        let term = |(weight, variance_mm2)| Gaussian { weight, variance_mm2 };
        let sum = GaussianSum::new([(0.2, 0.03), (0.3, 0.4), (0.4, 2.0)].map(term).to_vec());
        for method in [FitMethod::Optimal, FitMethod::Energy] {
            let problem = Problem::new(&[&sum], method).unwrap();
            let end = descend(&problem, problem.solve(&[-2.0, 0.0, 1.5]).unwrap(), GAIN_LAST);
            // The cost is quadratic around the truth; steps stop when it falls no more, at rounding.
            assert!(end.cost < 1e-18, "{}", end.cost);
            for (found, truth) in end.variances_mm2().iter().zip([0.03, 0.4, 2.0]) {
                assert!((found / truth - 1.0).abs() < 1e-6, "{found} against {truth}");
            }
        }
    }
}
