#![allow(clippy::unwrap_used, reason = "tests")]
use super::*;
use crate::oracle::simpson;
use crate::presets::measured_media::MEASURED_MEDIA;
use crate::{Dipole, Medium, Stack, TissueLayer};
use proptest::prelude::*;

fn dipole(sigma_a: f64, sigma_s: f64, n: f64) -> Dipole {
    Dipole::new(&Medium::new(sigma_a, sigma_s, n).unwrap()).unwrap()
}

#[test]
fn marble_green_meets_the_paper() {
    let marble = dipole(0.0041, 2.62, 1.5);
    let four = fit(&marble, 4, FitMethod::Optimal).unwrap();
    // d'Eon et al. 2007: 1.25 %; our reading of the optimum: 1.2535 %, sum 0.7485. Half a unit of the last digit printed.
    assert!((four.relative_rms_power_error - 0.012535).abs() < 5e-7, "{}", four.relative_rms_power_error);
    assert!((four.energy - 0.7485).abs() < 5e-5, "{}", four.energy);
    let eight = fit(&marble, 8, FitMethod::Optimal).unwrap();
    // The paper's 0.093 % is not the optimum; ours must be the better one.
    assert!((eight.relative_rms_power_error - 0.000340).abs() < 5e-7, "{}", eight.relative_rms_power_error);
}

/// Eq. 10 as printed, in the radius, by Simpson in ln r: shares neither transform nor grid with the fit.
#[test]
fn error_in_frequency_is_the_error_in_radius() {
    let skin = dipole(0.17, 0.88, 1.3);
    for method in [FitMethod::Optimal, FitMethod::Energy] {
        let f = fit(&skin, 4, method).unwrap();
        let power = |g: &dyn Fn(f64) -> f64| {
            simpson(1e-7_f64.ln(), 200_f64.ln(), 20_000, |t| (g(t.exp()) * t.exp()).powi(2))
        };
        let miss = power(&|r| skin.at_mm(r) - f.sum.at_mm(r));
        let radial = (miss / power(&|r| skin.at_mm(r))).sqrt();
        assert!((f.relative_rms_power_error / radial - 1.0).abs() < 1e-6, "{method:?} {radial}");
    }
}

#[test]
fn error_does_not_depend_on_the_unit_of_length() {
    // alpha' and index fix the error; a factor in both coefficients only rescales r.
    let error = |scale: f64| {
        fit(&dipole(0.17 * scale, 0.88 * scale, 1.3), 4, FitMethod::Optimal).unwrap().relative_rms_power_error
    };
    for scale in [1e-6, 1e-2, 1e3, 1e6] {
        // The optimiser stops within 1e-9 of the cost.
        assert!((error(scale) / error(1.0) - 1.0).abs() < 1e-6, "{scale}");
    }
}

#[test]
fn energy_fit_keeps_energy_sign_and_nearly_the_error() {
    for (name, channels) in MEASURED_MEDIA {
        for medium in channels {
            let d = Dipole::new(&medium).unwrap();
            for count in [1, 4, 8] {
                let kept = fit(&d, count, FitMethod::Energy).unwrap();
                let free = fit(&d, count, FitMethod::Optimal).unwrap();
                assert!((kept.energy / d.total() - 1.0).abs() < 16.0 * f64::EPSILON, "{name} {count}");
                assert!(kept.sum.terms.iter().all(|g| g.weight > 0.0), "{name} {count}");
                let (kept, free) = (kept.relative_rms_power_error, free.relative_rms_power_error);
                // A constraint can only cost; the optimiser's own slack is 1e-9.
                assert!(kept > free * (1.0 - 1e-6), "{name} {count}: {kept} below {free}");
                // Seen: 1.05 to 1.5 with four and more. A fit stuck in a poor minimum is off by ten or more. Below 1e-5 the
                // heavy row of the energy leaves nothing to see: its square, 1e6, times rounding is 1e-10 of the cost.
                assert!(
                    count == 1 || kept < 1.6 * free || kept < 1e-5,
                    "{name} {count}: {kept} far above {free}"
                );
            }
        }
    }
}

#[test]
fn more_gaussians_never_fit_worse() {
    let skin = dipole(0.032, 0.74, 1.3);
    for method in [FitMethod::Optimal, FitMethod::Energy] {
        let error = |count| fit(&skin, count, method).unwrap().relative_rms_power_error;
        let errors: Vec<f64> = (1..=10).map(error).collect();
        assert!(errors.windows(2).all(|w| w[1] < w[0]), "{method:?} {errors:?}");
    }
}

#[test]
fn joint_fit_keeps_every_total_and_shares_variances() {
    for (name, channels) in MEASURED_MEDIA {
        let d = channels.map(|m| Dipole::new(&m).unwrap());
        let f = fit_rgb([&d[0], &d[1], &d[2]], 6).unwrap();
        assert!(f.kernel.len() <= 6, "{name}");
        for c in 0..3 {
            assert!((f.energy[c] / d[c].total() - 1.0).abs() < 16.0 * f64::EPSILON, "{name} {c}");
            assert!(f.kernel.weights.iter().all(|w| w[c] >= 0.0), "{name} {c}");
            let alone = fit(&d[c], 6, FitMethod::Energy).unwrap().relative_rms_power_error;
            assert!(f.relative_rms_power_error[c] > alone * (1.0 - 1e-6), "{name} {c} beats its own fit");
        }
    }
}

#[test]
fn joint_fit_improves_with_every_two_gaussians() {
    for (name, channels) in MEASURED_MEDIA {
        let d = channels.map(|m| Dipole::new(&m).unwrap());
        let worst = |count| {
            let errors = fit_rgb([&d[0], &d[1], &d[2]], count).unwrap().relative_rms_power_error;
            errors.into_iter().fold(0.0, f64::max)
        };
        let errors = [2, 4, 6, 8].map(worst);
        // Seen: two more terms are worth a factor of 2.9 to 11. A fit stuck in a poor minimum gains less, or loses.
        assert!(errors.windows(2).all(|w| w[1] < 0.5 * w[0]), "{name} {errors:?}");
        assert!(errors[2] < 0.0095, "{name}: the default of six must stay below one percent, got {errors:?}");
    }
}

#[test]
fn joint_fit_of_equal_channels_is_the_single_fit() {
    let skin = dipole(0.17, 0.88, 1.3);
    let (joint, alone) = (fit_rgb([&skin; 3], 5).unwrap(), fit(&skin, 5, FitMethod::Energy).unwrap());
    for c in 0..3 {
        let ratio = joint.relative_rms_power_error[c] / alone.relative_rms_power_error;
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    }
}

/// Eight wavelengths of one skin, say: absorption from strong to weak.
fn eight_dipoles() -> Vec<Dipole> {
    (0..8).map(|i| dipole(0.02 * 1.7_f64.powi(i), 1.0 - 0.05 * f64::from(i), 1.4)).collect()
}

#[test]
fn any_number_of_wavelengths_share_variances() {
    let dipoles = eight_dipoles();
    let profiles: Vec<&dyn Profile> = dipoles.iter().map(|d| d as &dyn Profile).collect();
    let f = fit_joint(&profiles, 8, None).unwrap();
    assert!(f.variances_mm2.len() <= 8 && f.variances_mm2.windows(2).all(|v| v[0] < v[1]));
    for (i, d) in dipoles.iter().enumerate() {
        assert!((f.energy[i] / d.total() - 1.0).abs() < 16.0 * f64::EPSILON, "{i}");
        assert!(f.weights[i].iter().all(|&w| w >= 0.0), "{i}");
        // What is reported is what is had.
        let again = relative_rms_power_error(d, &f.sum(i)).unwrap();
        assert!((again / f.relative_rms_power_error[i] - 1.0).abs() < 1e-6, "{i}: {again}");
        let alone = fit(d, 8, FitMethod::Energy).unwrap().relative_rms_power_error;
        assert!(f.relative_rms_power_error[i] > alone * (1.0 - 1e-6), "{i} beats its own fit");
        // Seen: 0.025 % at worst.
        assert!(f.relative_rms_power_error[i] < 0.0004, "{i}: {}", f.relative_rms_power_error[i]);
    }
}

#[test]
fn given_variances_get_the_weights_that_the_fit_had_chosen() {
    let d = dipole(0.17, 0.88, 1.3);
    for method in [FitMethod::Optimal, FitMethod::Energy] {
        let chosen = fit(&d, 5, method).unwrap();
        let variances: Vec<f64> = chosen.sum.terms.iter().map(|g| g.variance_mm2).collect();
        let given = fit_weights(&[&d], &variances, method).unwrap();
        for (term, weight) in chosen.sum.terms.iter().zip(&given.weights[0]) {
            assert!((term.weight - weight).abs() < 1e-9, "{method:?}: {} {weight}", term.weight);
        }
    }
    // Variances far too wide next to good ones get nothing, and no weight turns negative.
    let spread = fit_weights(&[&d], &[0.01, 0.05, 0.3, 1.5, 8.0, 500.0, 3e4], FitMethod::Energy).unwrap();
    assert!(spread.weights[0].iter().all(|&w| w >= 0.0) && spread.variances_mm2.last() < Some(&3e4));
    assert!((spread.energy[0] / d.total() - 1.0).abs() < 16.0 * f64::EPSILON);
    let told = |v: &[f64], method| fit_weights(&[&d], v, method).unwrap_err().to_string();
    assert!(told(&[0.1, -1.0], FitMethod::Energy).contains("above 0 mm², got -1"));
    assert!(told(&[0.1], FitMethod::Fast).contains("nothing to choose"));
}

#[test]
fn powers_are_a_method_like_any_other() {
    let layer = |a, s, n, thickness_mm| TissueLayer { medium: Medium::new(a, s, n).unwrap(), thickness_mm };
    let stack = Stack::in_air(&[layer(0.3, 6.0, 1.4, 0.3), layer(0.1, 3.0, 1.38, f64::INFINITY)]).unwrap();
    let half_space = dipole(0.17, 0.88, 1.4);
    for (profile, limit) in [(&stack as &dyn Profile, 0.05), (&half_space, 0.05)] {
        let f = fit(profile, 12, FitMethod::Powers).unwrap();
        assert_eq!(f.sum.terms.len(), 12);
        // Eq. 13 leaves 1e-4 out.
        assert!((f.energy - profile.total()).abs() < 1.1e-4, "{}", f.energy);
        assert!(f.relative_rms_power_error < limit, "{}", f.relative_rms_power_error);
    }
    // Layers so different that the terms do not reach the sources of the lower one: all of it is in the last term.
    let far = Stack::in_air(&[layer(0.1, 100.0, 1.4, 0.05), layer(0.1, 0.2, 1.4, f64::INFINITY)]).unwrap();
    let f = fit(&far, 12, FitMethod::Powers).unwrap();
    assert!((f.energy - far.total()).abs() < 1.1e-4, "{}", f.energy);
    // A sum of Gaussians does not say what it is made of.
    let sum = fit(&half_space, 3, FitMethod::Energy).unwrap().sum;
    for method in [FitMethod::Fast, FitMethod::Powers] {
        let told = fit(&sum, 3, method).unwrap_err().to_string();
        assert!(told.contains("Energy needs none"), "{told}");
    }
}

#[test]
fn the_worst_error_is_found_where_it_is() {
    // Two Gaussians against one: the difference 0.3 (G(0.01) - G(1)) is largest at the centre.
    let term = |weight, variance_mm2| Gaussian { weight, variance_mm2 };
    let sharp = GaussianSum::new(vec![term(0.3, 0.01), term(0.7, 1.0)]);
    let blunt = GaussianSum::new(vec![term(1.0, 1.0)]);
    let worst = worst_absolute_error(&sharp, &blunt).unwrap();
    let exact = 0.3 * (100.0 - 1.0) / core::f64::consts::TAU;
    // The first radius is a thousandth of the profile's scale.
    assert!((worst.error_per_mm2 / exact - 1.0).abs() < 1e-3, "{worst:?} against {exact}");
    assert!(worst.r_mm < 0.01);
}

#[test]
fn impossible_requests_are_refused_in_words() {
    let skin = dipole(0.17, 0.88, 1.3);
    for count in [0, GAUSSIANS_MAX + 1, usize::MAX] {
        let told = fit(&skin, count, FitMethod::Optimal).unwrap_err().to_string();
        assert!(told.contains("1 to 16"), "{told}");
    }
    let bad = Medium { sigma_a_per_mm: -1.0, sigma_s_reduced_per_mm: 1.0, refractive_index: 1.3 };
    let good = Medium { sigma_a_per_mm: 0.1, ..bad };
    assert!(matches!(rgb_kernel(&[good, bad, good], 6), Err(FitError::Medium { channel: 1, .. })));
    let empty = GaussianSum::default();
    assert!(matches!(fit(&empty, 4, FitMethod::Optimal), Err(FitError::Total { .. })));
}

/// Found by chance: seen from the finest channel, two wide Gaussians were one and the same column.
#[test]
fn columns_that_coincide_in_one_channel_are_no_obstacle() {
    let media =
        [(2.0e8, 4.8e8), (1.2e-12, 2.1e-9), (1.0, 1.0)].map(|(a, s)| Medium::new(a, s, 1.655).unwrap());
    assert!(rgb_kernel(&media, 4).is_ok());
}

/// Found by chance: scales sixteen decades apart once let rounding through as a negative weight, and one channel's energy
/// row drowned another's shape.
#[test]
fn channels_of_wildly_different_scale_all_get_a_shape() {
    let media =
        [(2e8, 2800.0), (0.0099, 1.2e-7), (3.1e-4, 4.7e-8)].map(|(a, s)| Medium::new(a, s, 2.7).unwrap());
    let d = media.map(|m| Dipole::new(&m).unwrap());
    let f = fit_rgb([&d[0], &d[1], &d[2]], 4).unwrap();
    assert!(f.kernel.weights.iter().flatten().all(|&w| w >= 0.0), "{:?}", f.kernel);
    // One Gaussian for a profile of its own misses by about a tenth; with four for three none does worse.
    assert!(f.relative_rms_power_error.iter().all(|&e| e < 0.15), "{:?}", f.relative_rms_power_error);
}

proptest! {
    // A joint fit takes 0.1 s: a few are enough to see that nothing overflows.
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn media_within_nine_decades_get_a_kernel(
        ln_a in prop::array::uniform3(-30.0..9.0_f64), ln_s in prop::array::uniform3(-11.0..9.0_f64), n in 0.5..3.0_f64,
    ) {
        let media = [0, 1, 2].map(|c| Medium::new(ln_a[c].exp(), ln_s[c].exp(), n).unwrap());
        let kernel = rgb_kernel(&media, 4).unwrap();
        for (medium, total) in media.iter().zip(kernel.totals()) {
            let exact = Dipole::new(medium).unwrap().total();
            prop_assert!((total / exact - 1.0).abs() < 16.0 * f64::EPSILON);
        }
        prop_assert!(kernel.rows().all(|(v, w)| v.is_finite() && v > 0.0 && w.iter().all(|w| *w >= 0.0)));
    }

    #[test]
    fn media_eighteen_decades_apart_get_a_kernel_or_an_answer(
        ln_a in prop::array::uniform3(-40.0..20.7_f64), ln_s in prop::array::uniform3(-20.7..20.7_f64),
    ) {
        let media = [0, 1, 2].map(|c| Medium::new(ln_a[c].exp(), ln_s[c].exp(), 1.4).unwrap());
        match rgb_kernel(&media, 4) {
            Ok(kernel) => prop_assert!(kernel.weights.iter().flatten().all(|w| *w >= 0.0 && w.is_finite())),
            Err(error) => prop_assert_eq!(error, FitError::NoSolution { count: 4 }),
        }
    }
}
