//! Burley's profile of least error: what a Burley engine can do best for a profile of ours.

use super::Subject;
use super::least::least_error_length;
use super::loss::{LitSpectrum, WIDE_BEAM_MEAN_FREE_PATHS};
use crate::Burley;

/// Shape lengths tried, in transport mean free paths.
const LENGTHS: [f64; 2] = [1e-2, 1e3];

/// For each channel the profile of our total (not above 1) whose shape length makes the relative RMS power error least, under
/// the wide beam.
pub(super) fn fitted_burley(subject: &Subject) -> [Burley; 3] {
    let albedo = subject.albedo();
    [0, 1, 2].map(|c| {
        let l_mm = subject.mean_free_path_mm[c];
        let lit = LitSpectrum::new(subject.profiles[c], WIDE_BEAM_MEAN_FREE_PATHS * l_mm);
        let [from_mm, to_mm] = LENGTHS.map(|x| x * l_mm);
        let drawn = |d_mm: f64| Burley::new(albedo[c], d_mm).expect("a checked albedo and a length");
        drawn(least_error_length(from_mm, to_mm, |d_mm| lit.relative_error(&drawn(d_mm))))
    })
}
