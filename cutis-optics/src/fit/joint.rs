//! One set of variances for several profiles: red, green and blue, or any number of wavelengths.

use super::problem::{Problem, Solution};
use super::{FitError, FitMethod, check_count, check_mean_free_path, starts};
use crate::{Dipole, Gaussian, GaussianSum, Medium, Profile, RgbGaussianSum};

/// Several profiles over shared variances.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct JointFit {
    /// How it was fitted.
    pub method: FitMethod,
    /// The variances, growing, mm².
    pub variances_mm2: Vec<f64>,
    /// Weights, one list for each profile.
    pub weights: Vec<Vec<f64>>,
    /// Relative RMS power error of each profile.
    pub relative_rms_power_error: Vec<f64>,
    /// Σ w of each profile.
    pub energy: Vec<f64>,
    /// Totals of the profiles themselves.
    pub total_diffuse_reflectance: Vec<f64>,
}

/// A kernel fitted to three profiles at once.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RgbFit {
    /// How it was fitted; always [`FitMethod::Energy`].
    pub method: FitMethod,
    /// Shared variances and the weights of each channel. Variances that no channel uses are left out.
    pub kernel: RgbGaussianSum,
    /// Relative RMS power error of red, green, blue.
    pub relative_rms_power_error: [f64; 3],
    /// Σ w of red, green, blue.
    pub energy: [f64; 3],
    /// R_d of the profiles themselves.
    pub total_diffuse_reflectance: [f64; 3],
}

/// Fits `gaussians` shared variances to any number of profiles: no negative weight, Σ w = R_d for every profile, the least
/// sum of squared relative power errors. Variances that no profile uses are left out, unless the sums are for a chain of
/// seven-tap blurs (`seven_tap_mm`, see [`super::FitSettings`]).
///
/// # Errors
/// If the number of Gaussians is out of range, there is no profile, or one has no total or scale.
pub fn fit_joint(
    profiles: &[&dyn Profile],
    gaussians: usize,
    seven_tap_mm: Option<f64>,
) -> Result<JointFit, FitError> {
    check_count(gaussians)?;
    check_mean_free_path(seven_tap_mm)?;
    let mut problem = Problem::new(profiles, FitMethod::Energy)?;
    problem.limit(seven_tap_mm);
    let solution = starts::best_solution(&problem, gaussians)?;
    Ok(JointFit::new(&problem, &solution, profiles))
}

/// The best weights for variances that are given, mm²: free ones ([`FitMethod::Optimal`]), or not negative with Σ w = R_d
/// ([`FitMethod::Energy`]).
///
/// # Errors
/// As [`fit_joint`]; if a variance is not above 0; or if the method has no weights to choose.
pub fn fit_weights(
    profiles: &[&dyn Profile],
    variances_mm2: &[f64],
    method: FitMethod,
) -> Result<JointFit, FitError> {
    check_count(variances_mm2.len())?;
    if let Some(&value) = variances_mm2.iter().find(|v| !(**v > 0.0 && v.is_finite())) {
        return Err(FitError::Variance { value });
    }
    if !matches!(method, FitMethod::Optimal | FitMethod::Energy) {
        return Err(FitError::NoChoice { method });
    }
    let problem = Problem::new(profiles, method)?;
    let mut sorted: Vec<f64> = variances_mm2.iter().map(|v| v.ln()).collect();
    sorted.sort_by(f64::total_cmp);
    let solution = problem.solve(&sorted).ok_or(FitError::NoSolution { count: sorted.len() })?;
    Ok(JointFit::new(&problem, &solution, profiles))
}

impl JointFit {
    fn new(problem: &Problem, solution: &Solution, profiles: &[&dyn Profile]) -> Self {
        let weights: Vec<Vec<f64>> = (0..profiles.len()).map(|i| problem.weights(solution, i)).collect();
        let variances_mm2 = solution.variances_mm2();
        let chained = problem.limits().is_some();
        let is_used = |i: &usize| chained || weights.iter().any(|w| w[*i] != 0.0);
        let mut used: Vec<usize> = (0..variances_mm2.len()).filter(is_used).collect();
        used.sort_by(|&i, &j| variances_mm2[i].total_cmp(&variances_mm2[j]));
        let chosen = |values: &[f64]| used.iter().map(|&i| values[i]).collect::<Vec<_>>();
        let weights: Vec<Vec<f64>> = weights.iter().map(|w| chosen(w)).collect();
        let mut fit = Self {
            method: problem.method(),
            variances_mm2: chosen(&variances_mm2),
            energy: weights.iter().map(|w| w.iter().sum()).collect(),
            weights,
            relative_rms_power_error: Vec::new(),
            total_diffuse_reflectance: profiles.iter().map(|p| p.total()).collect(),
        };
        fit.relative_rms_power_error =
            (0..profiles.len()).map(|i| problem.relative_error(i, &fit.sum(i))).collect();
        fit
    }

    /// One profile as a sum of its own; terms of weight 0 are left out.
    ///
    /// # Panics
    /// If there are not so many profiles.
    pub fn sum(&self, profile: usize) -> GaussianSum {
        let term = |(&variance_mm2, &weight): (&f64, &f64)| Gaussian { weight, variance_mm2 };
        let terms = self.variances_mm2.iter().zip(&self.weights[profile]).map(term);
        GaussianSum { terms: terms.filter(|g| g.weight != 0.0).collect() }
    }
}

/// Fits `gaussians` shared variances to red, green and blue; see [`fit_joint`].
///
/// # Errors
/// As [`fit_joint`].
pub fn fit_rgb(profiles: [&dyn Profile; 3], gaussians: usize) -> Result<RgbFit, FitError> {
    Ok(RgbFit::from_joint(&fit_joint(&profiles, gaussians, None)?))
}

impl RgbFit {
    /// A fit of three profiles, as red, green and blue.
    ///
    /// # Panics
    /// If there are fewer than three.
    pub fn from_joint(joint: &JointFit) -> Self {
        let row = |(i, &v): (usize, &f64)| (v, [0, 1, 2].map(|c| joint.weights[c][i]));
        let three = |values: &[f64]| [values[0], values[1], values[2]];
        Self {
            method: joint.method,
            kernel: RgbGaussianSum::from_rows(joint.variances_mm2.iter().enumerate().map(row).collect()),
            relative_rms_power_error: three(&joint.relative_rms_power_error),
            energy: three(&joint.energy),
            total_diffuse_reflectance: three(&joint.total_diffuse_reflectance),
        }
    }
}

/// The kernel of three media seen through the dipole, ready for a renderer; six Gaussians are a good number.
///
/// # Errors
/// As [`fit_joint`], or if a medium cannot be.
pub fn rgb_kernel(media: &[Medium; 3], gaussians: usize) -> Result<RgbGaussianSum, FitError> {
    let dipole =
        |channel: usize| Dipole::new(&media[channel]).map_err(|source| FitError::Medium { channel, source });
    let [red, green, blue] = [dipole(0)?, dipole(1)?, dipole(2)?];
    Ok(fit_rgb([&red, &green, &blue], gaussians)?.kernel)
}
