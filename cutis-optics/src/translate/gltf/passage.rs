//! How much light passes a thickness, in the words of glTF.

use crate::RgbGaussianSum;
use crate::translate::largest;

/// Transmission per channel and thickness, as glTF's volume and diffuse transmission understand it.
pub(super) struct Passage {
    /// The thickness at which it is exact.
    pub(super) thickness_mm: f64,
    /// Share of the diffuse light in the passing lobe.
    pub(super) factor: f64,
    /// Colour of that lobe before attenuation.
    pub(super) colour: [f64; 3],
    /// Distance after which `attenuation_colour` is left.
    pub(super) attenuation_distance_mm: f64,
    /// Share left after that distance.
    pub(super) attenuation_colour: [f64; 3],
}

/// What a float in a shader still tells from black, and from clear.
const DARKEST: f64 = 1e-6;
/// Largest share of the light that passes: a sheet that scatters sends back half of it at least.
const FACTOR_MAX: f64 = 0.5;

impl Passage {
    /// Read off a kernel at one standard deviation of its widest channel: T(d) there, and the slope from there to 2 d. The
    /// reflecting lobe comes first: it must be able to send back `albedo_max` beside what passes.
    pub(super) fn of(kernel: &RgbGaussianSum, albedo_max: f64) -> Self {
        let thickness_mm = largest([0, 1, 2].map(|c| spread_mm(kernel, c)));
        let [here, twice] = [1.0, 2.0].map(|x| kernel.slab(x * thickness_mm).totals());
        let attenuation_colour = [0, 1, 2].map(|c| {
            let left = if here[c] > 0.0 { twice[c] / here[c] } else { 0.0 };
            left.clamp(DARKEST, 1.0 - DARKEST)
        });
        let before = [0, 1, 2].map(|c| here[c] / attenuation_colour[c]);
        let factor = largest(before).min(1.0 - albedo_max).clamp(DARKEST, FACTOR_MAX);
        let colour = before.map(|t| (t / factor).min(1.0));
        Self { thickness_mm, factor, colour, attenuation_distance_mm: thickness_mm, attenuation_colour }
    }
}

/// Standard deviation of a channel, mm.
fn spread_mm(kernel: &RgbGaussianSum, channel: usize) -> f64 {
    let sums = kernel.rows().fold((0.0, 0.0), |(m, t), (v, w)| (m + w[channel] * v, t + w[channel]));
    if sums.1 > 0.0 { (sums.0 / sums.1).max(0.0).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::presets;

    #[test]
    fn at_the_thickness_written_and_its_double_it_is_the_kernel() {
        let kernel = presets::find("skin1").unwrap().kernel(6).unwrap();
        let passage = Passage::of(&kernel, 0.44);
        for times in [1, 2] {
            let exact = kernel.slab(f64::from(times) * passage.thickness_mm).totals();
            for (c, exact) in exact.into_iter().enumerate() {
                let ours = passage.factor * passage.colour[c] * passage.attenuation_colour[c].powi(times);
                // Where a channel is all but black the darkest colour stands for it.
                assert!((ours - exact).abs() < 1e-12 + 2.0 * DARKEST, "{c}: {ours} against {exact}");
            }
        }
        assert!(passage.factor > 0.01 && passage.factor <= FACTOR_MAX);
    }

    #[test]
    fn a_black_channel_passes_nothing_and_a_white_one_leaves_nothing() {
        let kernel = RgbGaussianSum::from_rows(vec![(1.0, [0.5, 0.0, 0.25])]);
        let passage = Passage::of(&kernel, 1.0);
        assert_eq!(passage.colour[1], 0.0);
        assert_eq!(passage.factor, DARKEST);
        assert!(passage.attenuation_colour.iter().all(|c| (DARKEST..1.0).contains(c)));
    }
}
