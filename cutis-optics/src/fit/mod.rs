//! Sums of Gaussians fitted to diffusion profiles (d'Eon, Luebke & Enderton 2007, section 4).
//!
//! Minimises ∫ r (R(r) - Σ w_i G(v_i, r))² dr (eq. 6) over all weights and variances, and reports
//! sqrt(∫ r (R - G)² dr / ∫ r R² dr) (eq. 10). By Parseval both integrals are (1/4 pi²) ∫ k (R(k) - Σ w_i e^(-v_i k²/2))² dk,
//! so the fit never leaves spatial frequency and no profile is ever transformed.
//!
//! How: Levenberg–Marquardt over ln v; for given variances the best weights are a linear problem and are eliminated
//! (variable projection, Golub & Pereyra 1973, doi:10.1137/0710036, not opened). The landscape has local minima: a
//! deterministic grid of geometric sequences is screened and the best few starts are run to the end.
//!
//! The residual is summed over a quadrature in k rather than expanded into Gaussian–Gaussian inner products: those have a
//! closed form, but an error of 1e-6 would be the difference of numbers equal to twelve digits.

mod frequency_grid;
mod levenberg_marquardt;
mod problem;
mod rgb;
mod starts;
mod weights;

use crate::{Gaussian, GaussianSum, MediumError, Profile};
use frequency_grid::FrequencyGrid;
use problem::{Problem, Solution};

pub use rgb::{RgbFit, fit_rgb, rgb_kernel};

/// Most Gaussians that a fit accepts: past this the sum reaches rounding error for every measured profile.
pub const GAUSSIANS_MAX: usize = 16;

/// What the sum must keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitMethod {
    /// The least error; the weights are free, some energy is lost.
    Optimal,
    /// Σ w = R_d exactly (eq. 9) and no weight negative: what a renderer should use.
    Energy,
}

/// A fitted profile.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fit {
    /// How it was fitted.
    pub method: FitMethod,
    /// The terms, by growing variance. Under [`FitMethod::Energy`] those that got no weight are left out.
    pub sum: GaussianSum,
    /// Relative RMS power error, eq. 10, no unit.
    pub relative_rms_power_error: f64,
    /// Σ w.
    pub energy: f64,
    /// R_d of the profile itself.
    pub total_diffuse_reflectance: f64,
}

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// None, or more than make sense.
    #[error("the number of Gaussians must lie in 1 to {GAUSSIANS_MAX}, got {count}")]
    GaussianCount {
        /// The number asked for.
        count: usize,
    },
    /// Nothing to fit.
    #[error("the total of the profile must be finite and positive, got {total}")]
    Total {
        /// Its value at frequency 0.
        total: f64,
    },
    /// The spectrum never falls to half of its total, or is not a number somewhere.
    #[error("the spectrum of the profile has no scale: it does not fall to half of its total {total}")]
    Scale {
        /// Its value at frequency 0.
        total: f64,
    },
    /// No start led to finite numbers: seen only where channels differ in scale by some sixteen decades.
    #[error("no start of the optimiser led to a finite error with {count} Gaussians")]
    NoSolution {
        /// The number asked for.
        count: usize,
    },
    /// The medium itself is impossible.
    #[error("channel {channel} (0 red, 1 green, 2 blue)")]
    Medium {
        /// Channel at fault.
        channel: usize,
        /// What is wrong with it.
        source: MediumError,
    },
}

/// The best sum of `gaussians` terms for one profile.
pub fn fit(profile: &dyn Profile, gaussians: usize, method: FitMethod) -> Result<Fit, FitError> {
    check_count(gaussians)?;
    let problem = Problem::new(&[profile], method)?;
    let solution = starts::best_solution(&problem, gaussians)?;
    Ok(into_fit(&problem, solution, profile, method))
}

/// Relative RMS power error (eq. 10) of any sum against any profile, no unit.
pub fn relative_rms_power_error(profile: &dyn Profile, sum: &GaussianSum) -> Result<f64, FitError> {
    let grid = FrequencyGrid::covering(&[profile])?;
    Ok(grid.relative_error(profile, sum))
}

fn check_count(count: usize) -> Result<(), FitError> {
    if (1..=GAUSSIANS_MAX).contains(&count) { Ok(()) } else { Err(FitError::GaussianCount { count }) }
}

fn into_fit(problem: &Problem, solution: Solution, profile: &dyn Profile, method: FitMethod) -> Fit {
    let term = |(weight, variance_mm2): (f64, f64)| Gaussian { weight, variance_mm2 };
    let weights = problem.weights(&solution, 0);
    let terms = weights.into_iter().zip(solution.variances_mm2()).map(term);
    let sum = GaussianSum::new(terms.filter(|g| g.weight != 0.0).collect());
    Fit {
        method,
        relative_rms_power_error: problem.grid().relative_error(profile, &sum),
        energy: sum.energy(),
        total_diffuse_reflectance: profile.total(),
        sum,
    }
}

#[cfg(test)]
mod tests;
