//! All samplers against the profiles they draw from: density, distribution, and the estimators a renderer makes of them.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::*;
use crate::oracle::{chi_square_is_plausible, simpson};
use crate::presets::measured_media::MEASURED_MEDIA;
use crate::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};
use crate::{Dipole, FitMethod, GaussianSum, Medium, Profile, RingProfile, Stack, TissueLayer, fit};
use core::f64::consts::{PI, SQRT_2, TAU};
use proptest::prelude::*;

/// Standard errors that an estimate may be off: by chance 1 in 370 is off farther; seeds are fixed.
const ERRORS: f64 = 3.0;

/// Numbers in [0, 1) with 24 bits, by SplitMix64 as in `simulate`, written apart from it.
fn uniforms(seed: u64, count: usize) -> Vec<f32> {
    let number = |i: u64| {
        let mut z =
            seed.wrapping_mul(0xD1B5_4A32_D192_ED03).wrapping_add(i.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 40) as f32) * (1.0 / 16_777_216.0)
    };
    (1..=count as u64).map(number).collect()
}

fn drawn(sampler: &dyn RadialSampler, seed: u64, count: usize) -> Vec<f32> {
    let mut radii_mm = vec![0.0; count];
    sampler.radii_mm(&uniforms(seed, count), &mut radii_mm);
    radii_mm
}

/// Every channel of every measured medium.
fn measured() -> impl Iterator<Item = (String, Medium, Dipole)> {
    MEASURED_MEDIA.into_iter().flat_map(|(name, channels)| {
        let of = move |(i, m): (usize, Medium)| (format!("{name} {i}"), m, Dipole::new(&m).unwrap());
        channels.into_iter().enumerate().map(of)
    })
}

fn table(dipole: &Dipole) -> TabulatedSampler {
    TabulatedSampler::new(dipole, dipole.depth_real_mm()).unwrap()
}

fn gaussians(dipole: &Dipole) -> (GaussianSum, GaussianSampler) {
    let sum = fit(dipole, 4, FitMethod::Energy).unwrap().sum;
    let sampler = GaussianSampler::new(&sum).unwrap();
    (sum, sampler)
}

/// Edges of rings by half octaves around a length; light within a ring by Simpson's rule over ln r.
fn shares(profile: &dyn Profile, total: f64, length_mm: f64, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let edges_mm: Vec<f64> = (-14..=16).map(|i| length_mm * 2f64.powf(0.5 * f64::from(i))).collect();
    let ring = |from: f64, to: f64| {
        let light = |t: f64| TAU * profile.at_mm(t.exp()) * (2.0 * t).exp();
        simpson(from.ln(), to.ln(), steps, light) / total
    };
    let mut shares = vec![ring(1e-4 * length_mm, edges_mm[0])];
    shares.extend(edges_mm.windows(2).map(|pair| ring(pair[0], pair[1])));
    shares.push(1.0 - shares.iter().sum::<f64>());
    (edges_mm, shares)
}

/// Fails if samples do not follow a profile, whose light within rings takes `steps` of Simpson's rule each.
fn follows(sampler: &dyn RadialSampler, profile: &dyn Profile, length_mm: f64, steps: usize, seed: u64) {
    follows_total(sampler, profile, profile.total(), length_mm, steps, seed);
}

fn follows_total(
    sampler: &dyn RadialSampler,
    profile: &dyn Profile,
    total: f64,
    length_mm: f64,
    steps: usize,
    seed: u64,
) {
    let (edges_mm, shares) = shares(profile, total, length_mm, steps);
    let mut counts = vec![0u64; shares.len()];
    for r_mm in drawn(sampler, seed, 100_000) {
        counts[edges_mm.partition_point(|&edge| edge <= f64::from(r_mm))] += 1;
    }
    chi_square_is_plausible(&counts, &shares);
}

#[test]
fn samples_follow_the_profiles_of_all_measured_media() {
    // 36 media, three samplers: 108 tests at 1 in 100,000 each would fail together once in 900 honest seeds.
    for (seed, (_, _, dipole)) in (0..).step_by(3).zip(measured()) {
        let l = dipole.depth_real_mm();
        follows(&DipoleSampler::new(&dipole), &dipole, l, 16, seed);
        follows(&table(&dipole), &dipole, l, 16, seed + 1);
        let (sum, sampler) = gaussians(&dipole);
        follows(&sampler, &sum, l, 16, seed + 2);
    }
}

#[test]
fn samples_follow_a_layered_and_a_simulated_profile() {
    let layer = |sigma_a, sigma_s, thickness_mm| TissueLayer {
        medium: Medium::new(sigma_a, sigma_s, 1.4).unwrap(),
        thickness_mm,
    };
    let stack = Stack::in_air(&[layer(0.3, 6.0, 0.25), layer(0.1, 3.0, f64::INFINITY)]).unwrap();
    follows(&TabulatedSampler::new(&stack, 0.16).unwrap(), &stack, 0.16, 16, 1001);

    let layer = Layer {
        sigma_a_per_mm: 0.1,
        sigma_s_per_mm: 1.0,
        g: 0.0,
        refractive_index: 1.4,
        thickness_mm: f64::INFINITY,
    };
    let grid =
        Grid { rings: Rings::even(0.1, 60).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
    let slab = LayeredSlab::in_air(vec![layer]).unwrap();
    let rings = RingProfile::from_estimates(&Simulation { slab, grid, seed: 1 }.run(20_480));
    // Between middles of rings it is a power of the radius: its own integral is not quite that of the rings. It has kinks,
    // and ends at 6 mm.
    let light = |t: f64| TAU * rings.at_mm(t.exp()) * (2.0 * t).exp();
    let total = simpson(1e-6_f64.ln(), 6_f64.ln(), 200_000, light);
    let sampler = TabulatedSampler::new(&rings, 1.0 / 1.1).unwrap();
    follows_total(&sampler, &rings, total, 6.0 / 256.0, 2000, 1002);
}

/// ∫ p 2 pi r dr over ln r.
fn integral(sampler: &dyn RadialSampler, from_mm: f64, to_mm: f64) -> f64 {
    let density = |t: f64| TAU * f64::from(sampler.pdf_per_mm2(t.exp() as f32)) * (2.0 * t).exp();
    simpson(from_mm.ln(), to_mm.ln(), 4000, density)
}

#[test]
fn densities_integrate_to_one_and_to_the_distribution() {
    for (name, _, dipole) in measured() {
        let l = dipole.depth_real_mm();
        let samplers: [&dyn RadialSampler; 3] =
            [&DipoleSampler::new(&dipole), &table(&dipole), &gaussians(&dipole).1];
        for (i, sampler) in samplers.into_iter().enumerate() {
            // The radii are rounded to f32, at most 3e-8 of the density's slope; Simpson's rule adds 1e-9. The table's density
            // has kinks where pieces meet. Beyond 1e7 l, without absorption, there is 1e-7 of the light.
            let limit = if i == 1 { 2e-5 } else { 1e-6 };
            let whole = integral(sampler, 1e-5 * l, 1e7 * l);
            assert!((whole - 1.0).abs() < limit, "{name}, sampler {i}: {whole}");
            for r in [0.1, 1.0, 5.0] {
                let (sum, cdf) = (integral(sampler, 1e-5 * l, r * l), f64::from(sampler.cdf((r * l) as f32)));
                assert!((sum - cdf).abs() < limit, "{name}, sampler {i}, {r} l: {sum} and {cdf}");
            }
        }
    }
}

#[test]
fn densities_are_those_of_the_profile() {
    let mut worst = [0.0_f64; 2];
    for (_, _, dipole) in measured() {
        let samplers: [&dyn RadialSampler; 2] = [&DipoleSampler::new(&dipole), &table(&dipole)];
        for (worst, sampler) in worst.iter_mut().zip(samplers) {
            for i in -60..=60 {
                let r = (dipole.depth_real_mm() * 2f64.powf(f64::from(i) / 10.0)) as f32;
                // Far out, where the next sample is one in a million, the table's last pieces are as good as xi.
                if sampler.cdf(r) < 1.0 - 1e-6 {
                    let p = dipole.at_mm(f64::from(r)) / dipole.total();
                    *worst = worst.max((f64::from(sampler.pdf_per_mm2(r)) / p - 1.0).abs());
                }
            }
        }
    }
    eprintln!("densities: dipole off by {:.1e}, table by {:.1e}", worst[0], worst[1]);
    // The exact one is rounded once.
    assert!(worst[0] < f64::from(f32::EPSILON) && worst[1] < 0.02, "{worst:?}");
}

/// The radius by bisection of the light beyond, in f64.
fn exact_radius_mm(dipole: &Dipole, xi: f32) -> f64 {
    let beyond = |r: f64| {
        let of = |z: f64| z / r.hypot(z) * (-dipole.sigma_tr_per_mm() * r.hypot(z)).exp();
        let (a, b) = (dipole.depth_real_mm(), dipole.height_virtual_mm());
        (of(a) + of(b)) / (of_total(dipole, a) + of_total(dipole, b))
    };
    let (mut low, mut high) = (0.0, 1e9 * dipole.depth_real_mm());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if beyond(middle) > 1.0 - f64::from(xi) { &mut low } else { &mut high }) = middle;
    }
    low
}

fn of_total(dipole: &Dipole, z_mm: f64) -> f64 {
    (-dipole.sigma_tr_per_mm() * z_mm).exp()
}

#[test]
fn tables_are_inverted_to_a_hundred_thousandth_of_the_mean_free_path() {
    let mut worst = 0.0_f64;
    for (name, _, dipole) in measured() {
        let (sampler, l) = (table(&dipole), dipole.depth_real_mm());
        for xi in uniforms(5, 2000).into_iter().chain([1e-6, 1e-4, 0.999, 0.999_99, 0.999_999, XI_MAX]) {
            let (r, exact) = (f64::from(sampler.radius_mm(xi)), exact_radius_mm(&dipole, xi));
            // What the last digit of xi means: y = sqrt(-ln(1 - xi)) is computed in f32, three of its roundings move r by
            // less than 3 * 2^-24 dr/dxi; and four roundings of the cubic.
            let digit = 1.0 / 16_777_216.0 * dipole.total() / (TAU * exact * dipole.at_mm(exact));
            let noise = 3.0 * digit + 4.0 * f64::from(f32::EPSILON) * exact;
            worst = worst.max(((r - exact).abs() - noise) / l / (1.0 + 0.05 * exact / l));
            assert!(
                (r - exact).abs() < noise + 1e-5 * l * (0.5 + 0.025 * exact / l),
                "{name}, xi {xi}: {r} for {exact}"
            );
        }
    }
    eprintln!("tables: {worst:.1e} mean free paths beyond rounding");
}

#[test]
fn a_table_sampled_and_looked_up_is_where_it_was() {
    for (name, _, dipole) in measured() {
        let sampler = table(&dipole);
        for xi in uniforms(6, 500) {
            let r = sampler.radius_mm(xi);
            let back = sampler.cdf(r);
            // Three roundings of xi's logarithm, and one of r times the density.
            let of_radius = f32::EPSILON * r * r * sampler.pdf_per_mm2(r) * core::f32::consts::TAU;
            assert!((back - xi).abs() < 4.0 * f32::EPSILON + 2.0 * of_radius, "{name}: {xi} and {back}");
        }
    }
}

/// Mean and its standard error.
fn mean(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (n, sum, squares) = values.fold((0.0, 0.0, 0.0), |(n, s, q), v| (n + 1.0, s + v, q + v * v));
    let mean: f64 = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

#[test]
fn constant_irradiance_over_the_plane_leaves_as_much_as_the_total() {
    let mut farthest = 0.0_f64;
    for (name, channels) in MEASURED_MEDIA {
        let dipoles = channels.map(|m| Dipole::new(&m).unwrap());
        // Drawn from the channel that spreads farthest, so that the others' weights have a bound.
        let widest =
            dipoles.iter().min_by(|a, b| a.sigma_tr_per_mm().total_cmp(&b.sigma_tr_per_mm())).unwrap();
        let samplers: [&dyn RadialSampler; 2] = [&DipoleSampler::new(widest), &table(widest)];
        for (seed, sampler) in (40..).zip(samplers) {
            let radii_mm = drawn(sampler, seed, 50_000);
            for (i, dipole) in dipoles.iter().enumerate() {
                let weight = |&r: &f32| dipole.at_mm(f64::from(r)) / f64::from(sampler.pdf_per_mm2(r));
                let (got, error) = mean(radii_mm.iter().map(weight));
                // The density is rounded to f32, which has no noise.
                let rounding = f64::from(f32::EPSILON) * dipole.total();
                let off = (got - dipole.total()).abs();
                farthest = farthest.max(off / (error + rounding));
                assert!(
                    off < ERRORS * error + rounding,
                    "{name} {i}: {got} ± {error} for {}",
                    dipole.total()
                );
            }
        }
    }
    eprintln!("constant irradiance: {farthest:.2} standard errors at most");
}

/// Exitance at a distance from the edge of a lit half-plane, per irradiance: 1/2 F(0) + 1/pi ∫ F(k) sin(k d)/k dk.
fn edge_profile(profile: &dyn Profile, d_mm: f64, k_end_per_mm: f64) -> f64 {
    let wave =
        |k: f64| if k == 0.0 { d_mm * profile.total() } else { profile.spectrum(k) * (k * d_mm).sin() / k };
    0.5 * profile.total() + simpson(0.0, k_end_per_mm, 20_000, wave) / PI
}

/// The share of a total that comes from the half-plane x > -d, by samples; and its standard error.
fn edge_estimate(sampler: &dyn RadialSampler, d_mm: f64, seed: u64) -> (f64, f64) {
    let angles = uniforms(seed + 1, 100_000);
    let radii_mm = drawn(sampler, seed, angles.len());
    let is_lit = |(&r, &turns): (&f32, &f32)| f64::from(r) * (TAU * f64::from(turns)).cos() > -d_mm;
    mean(radii_mm.iter().zip(&angles).map(|at| if is_lit(at) { 1.0 } else { 0.0 }))
}

#[test]
fn light_leaks_under_a_shadow_s_edge_as_it_should() {
    for (name, medium, dipole) in
        measured().filter(|(name, ..)| name.starts_with("skin") || name.starts_with("marble"))
    {
        let l = medium.transport_mean_free_path_mm();
        let (sum, by_gaussians) = gaussians(&dipole);
        for (seed, d) in (300u64..).step_by(7).zip([-5.0, -1.0, -0.1, 0.0, 0.3, 2.0].map(|d| d * l)) {
            // Beyond k = 30/l there is e^-30 of the spectrum.
            let expected = edge_profile(&dipole, d, 30.0 / l) / dipole.total();
            for sampler in [&DipoleSampler::new(&dipole) as &dyn RadialSampler, &table(&dipole)] {
                let (got, error) = edge_estimate(sampler, d, seed);
                assert!(
                    (got - expected).abs() < ERRORS * error,
                    "{name}, {d} mm: {got} ± {error} for {expected}"
                );
            }
            let part =
                |g: &crate::Gaussian| 0.5 * g.weight * libm::erfc(-d / (SQRT_2 * g.variance_mm2.sqrt()));
            let expected = sum.terms.iter().map(part).sum::<f64>() / sum.energy();
            let (got, error) = edge_estimate(&by_gaussians, d, seed + 3);
            assert!(
                (got - expected).abs() < ERRORS * error,
                "{name}, {d} mm: {got} ± {error} for {expected}"
            );
        }
    }
}

#[test]
fn many_at_once_are_the_same_bits() {
    let dipole = Dipole::new(&MEASURED_MEDIA[8].1[0]).unwrap();
    let samplers: [&dyn RadialSampler; 3] =
        [&DipoleSampler::new(&dipole), &table(&dipole), &gaussians(&dipole).1];
    let xi = uniforms(9, 1003);
    for sampler in samplers {
        let mut radii_mm = vec![0.0; xi.len()];
        sampler.radii_mm(&xi, &mut radii_mm);
        assert!(xi.iter().zip(&radii_mm).all(|(&xi, &r)| sampler.radius_mm(xi) == r));
    }
}

#[test]
fn what_has_no_length_or_no_light_has_no_table() {
    let dark = GaussianSum::default();
    for l in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(TabulatedSampler::new(&dark, l), Err(SamplerError::MeanFreePath { .. })));
    }
    assert_eq!(TabulatedSampler::new(&dark, 1.0).unwrap_err(), SamplerError::Total { total: 0.0 });
}

/// What must be true of any sampler, at any `xi`.
fn is_sound(sampler: &dyn RadialSampler, xi: f32) {
    let r = sampler.radius_mm(xi);
    let (pdf, cdf) = (sampler.pdf_per_mm2(r), sampler.cdf(r));
    assert!(r.is_finite() && r >= 0.0, "xi {xi}: {r} mm");
    assert!(pdf.is_finite() && pdf > 0.0, "xi {xi}, {r} mm: {pdf}");
    assert!((0.0..=1.0).contains(&cdf), "xi {xi}, {r} mm: {cdf}");
    assert!(sampler.cdf(2.0 * r) >= cdf && sampler.cdf(0.0) == 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
    #[test]
    fn samplers_of_any_medium_are_sound(
        scattering in -9.0..9.0_f64, absorption in -6.0..2.0_f64, n in 1.0..1.6_f64, xi in 0.0..1.0_f32, tiny in -140..0_i32,
    ) {
        let sigma_s = 10f64.powf(scattering);
        let medium = Medium::new((sigma_s * 10f64.powf(absorption)).min(1e9), sigma_s, n).unwrap();
        let dipole = Dipole::new(&medium).unwrap();
        let samplers: [&dyn RadialSampler; 2] = [&DipoleSampler::new(&dipole), &table(&dipole)];
        for sampler in samplers {
            for xi in [xi, xi * 2f32.powi(tiny), XI_MAX, 0.0] {
                is_sound(sampler, xi);
            }
        }
    }

    #[test]
    fn tables_grow_with_xi(absorption in -6.0..1.0_f64, from in 0.0..1.0_f32, to in 0.0..1.0_f32) {
        let sampler = table(&Dipole::new(&Medium::new(10f64.powf(absorption), 1.0, 1.4).unwrap()).unwrap());
        let (low, high) = (sampler.radius_mm(from.min(to)), sampler.radius_mm(from.max(to)));
        // Where two numbers share all digits of y, rounding may exchange them.
        prop_assert!(low <= high * (1.0 + 4.0 * f32::EPSILON), "{low} and {high}");
    }
}
