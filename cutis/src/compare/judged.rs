//! Entries against the reference.

use super::drawn::Drawn;
use crate::measure::{Measured, Seen};
use cutis_render::difference::{RELATIVE_EPSILON, luminance};
use miette::{Result, miette};
use serde::Serialize;

/// Part of all pixels that the scale of the luminance errors shows in full.
const SHOWN_IN_FULL: f64 = 0.99;
/// Largest and smallest end of that scale, as parts of the reference.
const SCALE_RANGE: (f64, f64) = (0.01, 2.0);
/// Noise of a reference is no matter below this part of an error: it adds in squares, a third adds 5 %.
const QUIET_PART: f64 = 1.0 / 3.0;

/// What of the light is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// All of it.
    Picture,
    /// What came from below the surface.
    Diffuse,
}

impl Part {
    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Diffuse => "diffuse part",
        }
    }
}

/// An entry against the reference: the picture, and the diffuse part where both have one.
pub fn judge(test: &Drawn, reference: &Drawn, pixels_per_degree: f64) -> Result<Vec<(Part, Measured)>> {
    let of = |part, a: &Seen, b: &Seen| {
        let measured = Measured::new(a, b, pixels_per_degree);
        let (test, reference) = (&test.entry, &reference.entry);
        measured
            .map(|measured| (part, measured))
            .map_err(|error| miette!("{test} against {reference}: {error}"))
    };
    let picture = of(Part::Picture, &test.picture, &reference.picture)?;
    let diffuse = test.diffuse.as_ref().zip(reference.diffuse.as_ref());
    let diffuse = diffuse.map(|(a, b)| of(Part::Diffuse, a, b)).transpose()?;
    Ok([Some(picture), diffuse].into_iter().flatten().collect())
}

/// How sure a simulated reference is of itself.
#[derive(Debug, Clone, Serialize)]
pub struct Noise {
    /// Mean over pixels of the luminance's standard error, as a part of √(Y² + epsilon).
    pub mean_relative: f64,
    /// Root of the mean squared standard error over pixels and channels: the RMSE that noise alone makes.
    pub rms_w_per_m2_sr: f64,
}

impl Noise {
    /// Of a picture that knows its standard errors.
    pub fn of(drawn: &Drawn) -> Option<Self> {
        let errors = drawn.standard_errors.as_ref()?;
        let pixels = errors.len() as f64;
        let relative = errors.iter().zip(&drawn.picture.light).map(|(error, colour)| {
            let y = f64::from(luminance(*colour));
            f64::from(luminance(error.truncate())) / (y * y + RELATIVE_EPSILON).sqrt()
        });
        let squares = errors.iter().map(|error| f64::from(error.truncate().length_squared()));
        Some(Self {
            mean_relative: relative.sum::<f64>() / pixels,
            rms_w_per_m2_sr: (squares.sum::<f64>() / (3.0 * pixels)).sqrt(),
        })
    }

    /// Whether a picture with this RMSE can be judged by it.
    pub fn can_judge(&self, rmse: f64) -> bool {
        self.rms_w_per_m2_sr <= QUIET_PART * rmse
    }
}

/// One scale for the luminance errors of all entries, so that their maps compare: the end of it, as a part of the
/// reference, is a round number that nearly all pixels stay below.
pub fn luminance_scale<'a>(all: impl Iterator<Item = &'a Measured>) -> f64 {
    let largest = all.map(|measured| high_end(&measured.luminance_errors)).fold(0.0, f64::max);
    round_up(largest.clamp(SCALE_RANGE.0, SCALE_RANGE.1))
}

fn high_end(errors: &[f32]) -> f64 {
    let mut sizes: Vec<f32> = errors.iter().map(|e| e.abs()).collect();
    let index = ((sizes.len() as f64 * SHOWN_IN_FULL) as usize).min(sizes.len() - 1);
    f64::from(*sizes.select_nth_unstable_by(index, f32::total_cmp).1)
}

/// The next of 1, 2, 5, 10, 20, … hundredths.
fn round_up(value: f64) -> f64 {
    let percent = value * 100.0;
    let decade = 10_f64.powf(percent.log10().floor());
    // A number that is round already stays, whatever its logarithm was rounded to.
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * decade >= percent * (1.0 - 1e-9));
    step.unwrap_or(10.0) * decade / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::entry::Entry;
    use cutis_render::TechniqueName;
    use glam::Vec4;

    #[test]
    fn scales_end_at_round_numbers() {
        for (value, end) in [(0.01, 0.01), (0.011, 0.02), (0.2, 0.2), (0.21, 0.5), (0.51, 1.0), (2.0, 2.0)] {
            assert!((round_up(value) - end).abs() < 1e-12, "{value}");
        }
    }

    #[test]
    fn a_few_wild_pixels_do_not_set_the_scale() {
        let mut errors = vec![0.1_f32; 1000];
        errors[..5].fill(-50.0);
        assert!((high_end(&errors) - 0.1).abs() < 1e-6);
        assert!(high_end(&[0.5]) == 0.5);
    }

    #[test]
    fn noise_is_that_of_the_standard_errors() {
        let pixels = vec![Vec4::ONE, Vec4::new(0.0, 0.0, 0.0, 1.0)];
        let drawn = Drawn {
            backend: "cpu".to_owned(),
            adapter: "none".to_owned(),
            techniques: Default::default(),
            entry: Entry::usual(TechniqueName::TextureSpace),
            samples_per_pixel: 1,
            picture: Seen::developed(2, 1, pixels, 0.0),
            diffuse: None,
            standard_errors: Some(vec![Vec4::splat(0.1), Vec4::splat(0.1)]),
            milliseconds: 0.0,
            passes: Vec::new(),
            peak_memory_mib: None,
            warnings: Vec::new(),
        };
        let noise = Noise::of(&drawn).expect("it knows");
        // 0.1 of light of 1, and 0.1 of none, where the root of the epsilon, 0.1, stands in.
        assert!((noise.mean_relative - 0.5 * (0.1 / 1.01_f64.sqrt() + 1.0)).abs() < 1e-6, "{noise:?}");
        assert!((noise.rms_w_per_m2_sr - 0.1).abs() < 1e-6, "{noise:?}");
        assert!(Noise::of(&Drawn { standard_errors: None, ..drawn }).is_none());
    }

    #[test]
    fn a_noisy_reference_judges_no_small_errors() {
        let noise = Noise { mean_relative: 0.1, rms_w_per_m2_sr: 0.01 };
        assert!(noise.can_judge(0.031) && !noise.can_judge(0.029));
    }
}
