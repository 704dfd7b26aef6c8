//! Stacks of layers as powers of one Gaussian.

use super::Powers;
use crate::multipole::Response;
use crate::{Dipole, Multipole, Pole, Profile, Stack};

/// e^-21 = 1e-9: what is smaller than this of a slab is left to its last term.
const NEGLIGIBLE_EXPONENT: f64 = 21.0;

/// How finely, how far and how long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowersSettings {
    /// The variance that all others are multiples of, mm².
    pub unit_mm2: f64,
    /// Most terms of one sum.
    pub terms_max: usize,
    /// Energy that the series of reflections may miss (eq. 13).
    pub epsilon: f64,
}

impl PowersSettings {
    /// Settings for a half-space, as for a stack of nothing else.
    pub fn for_half_space(dipole: &Dipole) -> Self {
        Self::for_lengths(dipole.depth_real_mm(), dipole.sigma_tr_per_mm())
    }

    /// Settings for a stack: the unit is a tenth of the square of the shortest mean free path, so that the nearest source is
    /// met to 2 e^(-sqrt(20 pi)) = 0.07 %, and the terms reach to where 1 % of the slowest decay is left, as far as 448 go.
    /// For skin the result is within 0.7 % (relative RMS power error); more terms and a finer unit make it as exact as one
    /// likes.
    pub fn for_stack(stack: &Stack) -> Self {
        Self::for_lengths(stack.shortest_mean_free_path_mm(), stack.slowest_decay_per_mm())
    }

    fn for_lengths(mean_free_path_mm: f64, slowest_decay_per_mm: f64) -> Self {
        const UNITS_PER_MEAN_FREE_PATH_2: f64 = 10.0;
        const REACH_EXPONENT: f64 = 4.6;
        // Time grows with the square of it.
        const TERMS: f64 = 448.0;
        let unit_mm2 = mean_free_path_mm * mean_free_path_mm / UNITS_PER_MEAN_FREE_PATH_2;
        let reach_mm2 = 2.0 * REACH_EXPONENT / (slowest_decay_per_mm * slowest_decay_per_mm);
        let terms_max = (reach_mm2 / unit_mm2).clamp(16.0, TERMS) as usize;
        Self { unit_mm2, terms_max, epsilon: 1e-4 }
    }
}

/// Reflectance and transmittance of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct PowersFit {
    /// R of light from above.
    pub reflectance: Powers,
    /// T of light from above; empty for a half-space.
    pub transmittance: Powers,
    /// Reflections to and fro that were summed at each interface, the lowest interface first.
    pub reflections: Vec<usize>,
}

/// Why there is no sum.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PowersError {
    /// A number that cannot be.
    #[error("{quantity} must be {range}, got {value}")]
    OutOfRange {
        /// The setting at fault.
        quantity: &'static str,
        /// What is allowed.
        range: &'static str,
        /// What was given.
        value: f64,
    },
}

/// What a part of a stack does, both ways.
struct Part {
    down: [Powers; 2],
    up: [Powers; 2],
}

impl Stack {
    /// The stack as powers of one Gaussian.
    ///
    /// # Errors
    /// If the unit is not above 0, there are no terms or more than 65536, or epsilon does not lie in (0, 1).
    pub fn as_powers(&self, settings: &PowersSettings) -> Result<PowersFit, PowersError> {
        settings.check()?;
        let slabs = self.slabs().iter().rev().map(|slab| Part::of_slab(slab, settings));
        let bottom = self.bottom().map(|dipole| Part::of_half_space(dipole, settings));
        let mut reflections = Vec::new();
        let whole = bottom.into_iter().chain(slabs).reduce(|lower, upper| {
            let (part, summed) = upper.over(&lower, settings);
            reflections.push(summed);
            part
        });
        let [reflectance, transmittance] = whole.expect("a stack has at least one layer").down;
        Ok(PowersFit { reflectance, transmittance, reflections })
    }
}

impl PowersSettings {
    fn check(&self) -> Result<(), PowersError> {
        let refuse = |quantity, range, value| Err(PowersError::OutOfRange { quantity, range, value });
        if !(self.unit_mm2 > 0.0 && self.unit_mm2.is_finite()) {
            return refuse("unit_mm2", "above 0 mm²", self.unit_mm2);
        }
        if !(1..=65536).contains(&self.terms_max) {
            return refuse("terms_max", "1 to 65536", self.terms_max as f64);
        }
        if !(self.epsilon > 0.0 && self.epsilon < 1.0) {
            return refuse("epsilon", "between 0 and 1", self.epsilon);
        }
        Ok(())
    }
}

impl Part {
    fn of_half_space(dipole: &Dipole, settings: &PowersSettings) -> Self {
        let poles = dipole.poles().expect("a dipole has poles");
        let beyond = |v: f64| poles.iter().map(|pole| pole.weight_beyond(v)).sum();
        let terms = settings.terms_max;
        let reflectance =
            Powers::of_poles(settings.unit_mm2, terms, |_| poles.iter().copied(), beyond, dipole.total());
        let none = || Powers { unit_mm2: settings.unit_mm2, weights: Vec::new() };
        Self { down: [reflectance, none()], up: [none(), none()] }
    }

    fn of_slab(slab: &Multipole, settings: &PowersSettings) -> Self {
        let Response { reflectance_down, transmittance_down, reflectance_up, transmittance_up } =
            slab.response(0.0);
        let turned = slab.upside_down();
        Self {
            down: [
                of_images(slab, settings, reflectance_down, Multipole::reflectance_poles),
                of_images(slab, settings, transmittance_down, Multipole::transmittance_poles),
            ],
            up: [
                of_images(&turned, settings, reflectance_up, Multipole::reflectance_poles),
                of_images(&turned, settings, transmittance_up, Multipole::transmittance_poles),
            ],
        }
    }

    /// This part on top of another, and how many reflections between them were summed.
    fn over(&self, lower: &Self, settings: &PowersSettings) -> (Self, usize) {
        let [r1, t1] = &self.down;
        let [r1_up, t1_up] = &self.up;
        let [r2, t2] = &lower.down;
        let [r2_up, t2_up] = &lower.up;
        let times = |a: &Powers, b: &Powers| a.convolved(b, settings.terms_max);
        let (through, up, down, back) = (
            times(t1, t2),
            times(t2_up, t1_up),
            times(&times(t1, t1_up), r2),
            times(&times(t2_up, t2), r1_up),
        );
        let largest = [&through, &up, &down, &back].iter().map(|p| p.energy()).fold(0.0, f64::max);
        let (series, reflections) = to_and_fro(&times(r2, r1_up), largest, settings);
        let all = |first: &Powers| first.plus(&times(first, &series));
        let part =
            Self { down: [r1.plus(&all(&down)), all(&through)], up: [r2_up.plus(&all(&back)), all(&up)] };
        (part, reflections)
    }
}

/// Reflectance of a half-space.
pub(crate) fn of_half_space(dipole: &Dipole, settings: &PowersSettings) -> Powers {
    let poles = dipole.both();
    let beyond = |v: f64| poles.iter().map(|pole| pole.weight_beyond(v)).sum();
    Powers::of_poles(settings.unit_mm2, settings.terms_max, |_| poles, beyond, dipole.total())
}

/// X + X² + … + X^n, with n the first for which what is left out of the whole series, times `energy`, is below epsilon
/// (eq. 13).
fn to_and_fro(x: &Powers, energy: f64, settings: &PowersSettings) -> (Powers, usize) {
    let ratio = x.energy();
    let none = Powers { unit_mm2: x.unit_mm2, weights: Vec::new() };
    // 1/(1 - x) - Σ x^i up to n is x^(n+1)/(1 - x).
    let missing = |n: i32| energy * ratio.powi(n + 1) / (1.0 - ratio);
    let (mut series, mut power, mut n) = (none, x.clone(), 0);
    while missing(n) >= settings.epsilon {
        series = series.plus(&power);
        n += 1;
        if missing(n) >= settings.epsilon {
            power = power.convolved(x, settings.terms_max);
        }
    }
    (series, n as usize)
}

/// Reflectance or transmittance of a slab: as many pairs of images as count at each variance.
fn of_images(
    slab: &Multipole,
    settings: &PowersSettings,
    total: f64,
    pair: impl Fn(&Multipole, i32) -> [Pole; 2],
) -> Powers {
    let whole_mm = slab.whole_mm();
    // All images together decay as the slowest wave between both walls, e^(-(pi/L)² v/2).
    let slowest = core::f64::consts::PI / whole_mm;
    let ends_mm2 = 2.0 * NEGLIGIBLE_EXPONENT / (slowest * slowest);
    let terms = ((ends_mm2 / settings.unit_mm2).ceil() as usize).clamp(1, settings.terms_max);
    let poles_at = |variance_mm2: f64| {
        let farthest = (2.0 * NEGLIGIBLE_EXPONENT * variance_mm2).sqrt() / (2.0 * whole_mm) + 1.0;
        let pairs = farthest.ceil() as i32;
        (-pairs..=pairs).flat_map(|i| pair(slab, i))
    };
    let beyond = |variance_mm2: f64| {
        poles_at(4.0 * variance_mm2).map(|pole| pole.weight_beyond(variance_mm2)).sum::<f64>()
    };
    let tail =
        if terms == settings.terms_max { beyond((terms as f64 + 0.5) * settings.unit_mm2) } else { 0.0 };
    Powers::of_poles(settings.unit_mm2, terms, poles_at, |_| tail, total)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{Medium, TissueLayer, relative_rms_power_error};

    /// Skin at 500 nm (THEORY of Donner et al. 2008, in 1/mm): melanin 0.5 %, half of it eumelanin, no blood in the
    /// epidermis; 0.2 % of blood, 0.75 of it with oxygen, in the dermis.
    fn skin_at_500_nm() -> Stack {
        let nm: f64 = 500.0;
        let base = 0.0244 + 8.53 * (-(nm - 154.0) / 66.2).exp();
        let melanin = 0.5 * (6.6e10 * nm.powf(-3.33) + 2.9e14 * nm.powf(-4.75));
        // Prahl: 20932.8 and 20862 cm^-1/M at 500 nm.
        let blood = 2.303 * (0.75 * 20932.8 + 0.25 * 20862.0) * 150.0 / 64500.0 / 10.0;
        let scattering = 14.74 * nm.powf(-0.22) + 2.2e11 * nm.powi(-4);
        let epidermis = Medium::new(0.005 * melanin + 0.995 * base, scattering, 1.4).unwrap();
        let dermis = Medium::new(0.002 * blood + 0.998 * base, 0.5 * scattering, 1.38).unwrap();
        let layer = |medium, thickness_mm| TissueLayer { medium, thickness_mm };
        Stack::in_air(&[layer(epidermis, 0.25), layer(dermis, f64::INFINITY)]).unwrap()
    }

    #[test]
    fn two_layer_skin_at_500_nm_misses_less_than_epsilon() {
        let skin = skin_at_500_nm();
        let finest = skin.shortest_mean_free_path_mm().powi(2);
        let mut reflections = 0;
        for epsilon in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let usual = PowersSettings { epsilon, ..PowersSettings::for_stack(&skin) };
            let fine = PowersSettings { unit_mm2: finest / 16.0, terms_max: 1536, epsilon };
            let [usual, fine] = [usual, fine].map(|settings| skin.as_powers(&settings).unwrap());
            let error = |fit: &PowersFit| relative_rms_power_error(&skin, &fit.reflectance.sum()).unwrap();
            let missing = skin.total() - usual.reflectance.energy();
            eprintln!(
                "epsilon {epsilon:e}: {:?} reflections, error {:.3} % with {} terms, {:.3} % with {}, energy -{missing:.2e}",
                usual.reflections,
                100.0 * error(&usual),
                usual.reflectance.weights.len(),
                100.0 * error(&fine),
                fine.reflectance.weights.len(),
            );
            // What is summed is positive: less than the whole, by less than epsilon.
            assert!(missing > 0.0 && missing < epsilon, "{missing} at {epsilon}");
            assert!(usual.reflections[0] > reflections, "more digits need more reflections");
            reflections = usual.reflections[0];
            // Seen: 0.65 and 0.12 %; they are those of unit and reach, whatever epsilon.
            assert!(error(&usual) < 0.008 && error(&fine) < 0.002);
        }
    }

    #[test]
    fn slabs_on_slabs_meet_the_closed_form_both_ways() {
        let layer =
            |a, s, n, thickness_mm| TissueLayer { medium: Medium::new(a, s, n).unwrap(), thickness_mm };
        let layers = [layer(0.3, 6.0, 1.4, 0.4), layer(0.1, 3.0, 1.38, 1.5), layer(0.2, 4.0, 1.44, 1.0)];
        let stack = Stack::in_air(&layers).unwrap();
        let unit_mm2 = stack.shortest_mean_free_path_mm().powi(2) / 20.0;
        let fit = stack.as_powers(&PowersSettings { unit_mm2, terms_max: 4096, epsilon: 1e-9 }).unwrap();
        assert_eq!(fit.reflections.len(), 2);
        let (r, t) = (fit.reflectance.sum(), fit.transmittance.sum());
        for k in [0.0, 0.5, 2.0, 6.0] {
            // The nearest source is met to 2 e^(-sqrt(40 pi)) = 3e-5 of a reflectance of 0.5.
            assert!((r.spectrum(k) - stack.spectrum(k)).abs() < 2e-5, "R({k}): {}", r.spectrum(k));
            assert!((t.spectrum(k) - stack.transmittance_spectrum(k)).abs() < 2e-5, "T({k})");
        }
        assert!((r.energy() - stack.total()).abs() < 2e-9);
    }

    #[test]
    fn impossible_settings_are_refused() {
        let skin = skin_at_500_nm();
        let good = PowersSettings::for_stack(&skin);
        let told = |settings| skin.as_powers(&settings).unwrap_err().to_string();
        assert!(told(PowersSettings { unit_mm2: 0.0, ..good }).contains("unit_mm2 must be above 0"));
        assert!(told(PowersSettings { terms_max: 0, ..good }).contains("terms_max must be 1 to 65536"));
        assert!(
            told(PowersSettings { epsilon: f64::NAN, ..good }).contains("epsilon must be between 0 and 1")
        );
    }
}
