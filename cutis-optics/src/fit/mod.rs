//! Sums of Gaussians fitted to diffusion profiles (d'Eon, Luebke & Enderton 2007, section 4).
//!
//! Minimises ∫ r (R(r) - Σ w_i G(v_i, r))² dr (eq. 6) over all weights and variances, and reports
//! sqrt(∫ r (R - G)² dr / ∫ r R² dr) (eq. 10). By Parseval both integrals are (1/4 pi²) ∫ k (R(k) - Σ w_i e^(-v_i k²/2))² dk,
//! so the fit never leaves spatial frequency and no profile is ever transformed.
//!
//! How: Levenberg–Marquardt over ln v; for given variances the best weights are a linear problem and are eliminated
//! (variable projection, Golub & Pereyra 1973, doi:10.1137/0710036, not opened). The landscape has local minima: a
//! coarse grid of geometric sequences is screened, and the best start is run to the end; scattered starts find nothing better.
//!
//! The residual is summed over a quadrature in k rather than expanded into Gaussian–Gaussian inner products: those have a
//! closed form, but an error of 1e-6 would be the difference of numbers equal to twelve digits.

mod fast;
mod frequency_grid;
mod joint;
mod levenberg_marquardt;
mod problem;
mod seven_tap;
mod starts;
mod weights;

use crate::{Gaussian, GaussianSum, MediumError, Profile};
use frequency_grid::FrequencyGrid;
use problem::{Problem, Solution};

pub use joint::{JointFit, RgbFit, fit_joint, fit_rgb, fit_weights, rgb_kernel};

/// Most Gaussians that a fit accepts: past this the sum reaches rounding error for every measured profile.
pub const GAUSSIANS_MAX: usize = 16;

/// How a sum is found, and what it must keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitMethod {
    /// The least error; the weights are free, some energy is lost.
    Optimal,
    /// Σ w = R_d exactly (eq. 9) and no weight negative: what a renderer should use.
    Energy,
    /// Four Gaussians for every pole, by the formulas of appendix A: no optimisation, errors of percents. Only for profiles
    /// that have poles ([`Profile::poles`]).
    Fast,
    /// Multiples of one variance ([`crate::powers`]): layers combined as polynomials. Only for dipoles, slabs and stacks.
    Powers,
}

/// What a fit is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitSettings {
    /// Most terms.
    pub gaussians: usize,
    /// How to find them.
    pub method: FitMethod,
    /// Shortest mean free path of the material, mm, where the sum is for a chain of seven-tap blurs: v_1 ≤ l² and
    /// v_i ≤ 4 v_(i-1) (section 5.1). Only with [`FitMethod::Optimal`] and [`FitMethod::Energy`].
    pub seven_tap_mm: Option<f64>,
}

/// A fitted profile.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fit {
    /// How it was fitted.
    pub method: FitMethod,
    /// The terms, by growing variance. Under [`FitMethod::Energy`] those that got no weight are left out, unless the sum is
    /// for a chain of blurs.
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
    /// A variance that cannot be.
    #[error("variances must be finite and above 0 mm², got {value}")]
    Variance {
        /// What was given, mm².
        value: f64,
    },
    /// A mean free path that cannot be.
    #[error("the mean free path for seven taps must be finite and above 0 mm, got {value}")]
    MeanFreePath {
        /// What was given, mm.
        value: f64,
    },
    /// The method takes its variances or weights from formulas.
    #[error("the method {method:?} leaves nothing to choose: Optimal and Energy do")]
    NoChoice {
        /// The method asked for.
        method: FitMethod,
    },
    /// The method builds on the poles of a profile.
    #[error(
        "the method {method:?} has to know the poles a profile is made of, and this one tells none; Energy needs none"
    )]
    Unknown {
        /// The method asked for.
        method: FitMethod,
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

/// A sum of at most `gaussians` terms for one profile.
///
/// [`FitMethod::Fast`] and [`FitMethod::Powers`] give as many terms as they have, and where these are too many, a sparser set
/// ([`GaussianSum::sparse`]).
///
/// # Errors
/// If the number is out of range, the profile has no total or scale, or the method does not know what it is made of.
pub fn fit(profile: &dyn Profile, gaussians: usize, method: FitMethod) -> Result<Fit, FitError> {
    fit_with(profile, &FitSettings { gaussians, method, seven_tap_mm: None })
}

/// As [`fit`], with all there is to set.
///
/// # Errors
/// As [`fit`]; or if the mean free path is not above 0, or given to a method that chooses no variances.
pub fn fit_with(profile: &dyn Profile, settings: &FitSettings) -> Result<Fit, FitError> {
    let &FitSettings { gaussians, method, seven_tap_mm } = settings;
    check_count(gaussians)?;
    check_mean_free_path(seven_tap_mm)?;
    let sum = match method {
        FitMethod::Optimal | FitMethod::Energy => {
            let mut problem = Problem::new(&[profile], method)?;
            problem.limit(seven_tap_mm);
            let solution = starts::best_solution(&problem, gaussians)?;
            return Ok(into_fit(&problem, solution, profile, method));
        }
        _ if seven_tap_mm.is_some() => return Err(FitError::NoChoice { method }),
        FitMethod::Fast => profile.poles().map(|poles| fast::fast(&poles)),
        FitMethod::Powers => profile.powers().map(|powers| powers.sum()),
    };
    let sum = sum.ok_or(FitError::Unknown { method })?.sparse(gaussians);
    if !sum.energy().is_finite() {
        return Err(FitError::NoSolution { count: gaussians });
    }
    Ok(Fit {
        method,
        relative_rms_power_error: relative_rms_power_error(profile, &sum)?,
        energy: sum.energy(),
        total_diffuse_reflectance: profile.total(),
        sum,
    })
}

/// Largest |R(r) - Σ w G| over the plane, 1/mm², and where, mm: on 200 radii from the point lit to where a hundred times the
/// profile's own scale is passed.
///
/// # Errors
/// If the profile has no total or scale.
pub fn worst_absolute_error(profile: &dyn Profile, sum: &GaussianSum) -> Result<WorstError, FitError> {
    const RADII: i32 = 200;
    let (half_per_mm, _) = FrequencyGrid::covering(&[profile])?.k_half_range_per_mm();
    // From a thousandth of the scale 1/k_half on, evenly in the logarithm.
    let radius_mm = |i: i32| (f64::from(i) / f64::from(RADII - 1) * 1e5f64.ln()).exp() * 1e-3 / half_per_mm;
    let errors = (0..RADII).map(|i| {
        let r_mm = radius_mm(i);
        WorstError { r_mm, error_per_mm2: (profile.at_mm(r_mm) - sum.at_mm(r_mm)).abs() }
    });
    let worst = errors.max_by(|a, b| a.error_per_mm2.total_cmp(&b.error_per_mm2));
    Ok(worst.expect("there are radii"))
}

/// Where a sum misses a profile most.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstError {
    /// Distance from the point lit, mm.
    pub r_mm: f64,
    /// By how much it misses, 1/mm².
    pub error_per_mm2: f64,
}

/// Relative RMS power error (eq. 10) of any sum against any profile, no unit.
pub fn relative_rms_power_error(profile: &dyn Profile, sum: &GaussianSum) -> Result<f64, FitError> {
    let grid = FrequencyGrid::covering(&[profile])?;
    Ok(grid.relative_error(profile, sum))
}

fn check_count(count: usize) -> Result<(), FitError> {
    if (1..=GAUSSIANS_MAX).contains(&count) { Ok(()) } else { Err(FitError::GaussianCount { count }) }
}

fn check_mean_free_path(mean_free_path_mm: Option<f64>) -> Result<(), FitError> {
    match mean_free_path_mm.filter(|l| !(*l > 0.0 && l.is_finite())) {
        Some(value) => Err(FitError::MeanFreePath { value }),
        None => Ok(()),
    }
}

fn into_fit(problem: &Problem, solution: Solution, profile: &dyn Profile, method: FitMethod) -> Fit {
    let term = |(weight, variance_mm2): (f64, f64)| Gaussian { weight, variance_mm2 };
    let weights = problem.weights(&solution, 0);
    let terms = weights.into_iter().zip(solution.variances_mm2()).map(term);
    // A chain of blurs goes through every variance, also those that no weight asks for.
    let chained = problem.limits().is_some();
    let sum = GaussianSum::new(terms.filter(|g| chained || g.weight != 0.0).collect());
    Fit {
        method,
        relative_rms_power_error: problem.relative_error(0, &sum),
        energy: sum.energy(),
        total_diffuse_reflectance: profile.total(),
        sum,
    }
}

#[cfg(test)]
mod tests;
