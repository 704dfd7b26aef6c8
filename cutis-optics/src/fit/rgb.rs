//! One set of variances for red, green and blue.

use super::problem::Problem;
use super::{FitError, FitMethod, check_count, starts};
use crate::{Dipole, Medium, Profile, RgbGaussianSum};

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

/// Fits `gaussians` shared variances to three profiles: no negative weight, Σ w = R_d in every channel, the least sum of
/// squared relative power errors.
pub fn fit_rgb(profiles: [&dyn Profile; 3], gaussians: usize) -> Result<RgbFit, FitError> {
    check_count(gaussians)?;
    let problem = Problem::new(&profiles, FitMethod::Energy)?;
    let solution = starts::best_solution(&problem, gaussians)?;
    let weights = [0, 1, 2].map(|c| problem.weights(&solution, c));
    let row = |(i, v)| (v, [weights[0][i], weights[1][i], weights[2][i]]);
    let rows = solution.variances_mm2().into_iter().enumerate().map(row);
    let kernel = RgbGaussianSum::from_rows(rows.filter(|(_, w)| w.iter().any(|w| *w != 0.0)).collect());
    Ok(RgbFit {
        method: FitMethod::Energy,
        relative_rms_power_error: [0, 1, 2]
            .map(|c| problem.grid().relative_error(profiles[c], &kernel.channel(c))),
        energy: kernel.totals(),
        total_diffuse_reflectance: profiles.map(|p| p.total()),
        kernel,
    })
}

/// The kernel of three media seen through the dipole, ready for a renderer; six Gaussians are a good number.
pub fn rgb_kernel(media: &[Medium; 3], gaussians: usize) -> Result<RgbGaussianSum, FitError> {
    let dipole =
        |channel: usize| Dipole::new(&media[channel]).map_err(|source| FitError::Medium { channel, source });
    let [red, green, blue] = [dipole(0)?, dipole(1)?, dipole(2)?];
    Ok(fit_rgb([&red, &green, &blue], gaussians)?.kernel)
}
