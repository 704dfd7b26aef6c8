//! Multipole diffusion profile of one slab, in closed form in spatial frequency, and by poles in the radius.
//!
//! Symbols: d thickness, l transport mean free path (depth of the real source), z0 = 2 A_top D and zd = 2 A_bottom D
//! extrapolation lengths beyond both faces, L = d + z0 + zd, q = sqrt(k² + sigma_tr²). Poles stand at
//! z_r = 2 i L + l and z_v = 2 i L - l - 2 z0 for every whole i.
//! Source: Donner & Jensen 2005, doi:10.1145/1073204.1073308 (not opened), as restated by d'Eon, Luebke & Enderton 2007.
//! The closed form is ours: each pole transforms to sgn(z) e^(-|z| q) / 2 (see [`crate::Dipole`]), and the geometric series
//! of all of them is a quotient of hyperbolic sines,
//! R(k) = alpha'/2 [sinh q(L - l) + sinh q(L - l - 2 z0)] / sinh qL,
//! T(k) = alpha'/2 [sinh q(L - d + l) - sinh q(L - d - l - 2 z0)] / sinh qL,
//! which four exponentials a = e^(-q l), b = e^(-q (d - l)), c = e^(-2 q z0), e = e^(-2 q zd) bring to products:
//! R = alpha'/2 a (1 + c)(1 - b² e) / (1 - a² b² c e), T = alpha'/2 b (1 + e)(1 - a² c) / (1 - a² b² c e).
//! Upside down, c and e change places.
//! Valid for l < d: a source below the slab would make the transmittance negative ([`TooThin`]). Reduced albedo above 0.95,
//! as the dipole.

use crate::medium::reflection_parameter;
use crate::{Boundary, Medium, MediumError, Pole, Profile};
use wide::f64x4;

/// Pairs of poles on either side of the slab that are summed in the radius: what is left out is below e^(-200 sigma_tr L),
/// and without absorption below 1e-6 of the first.
const POLES: i32 = 100;

/// Pairs left out hold less than e^-14 = 1e-6.
const CONVERGED_EXPONENT: f64 = 14.0;

/// q L below which 1 - e^(-q x) loses too many digits: 1e-13 are left there.
const SLOW: f64 = 1e-3;
/// q L below which q itself may be nothing.
const STANDING: f64 = 1e-150;

/// What a part of a stack does to light of one spatial frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Reflectance of light from above.
    pub reflectance_down: f64,
    /// Transmittance of light from above.
    pub transmittance_down: f64,
    /// Reflectance of light from below.
    pub reflectance_up: f64,
    /// Transmittance of light from below.
    pub transmittance_up: f64,
}

/// One slab between two media.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multipole {
    albedo_reduced: f64,
    sigma_tr_per_mm: f64,
    /// l, mm.
    source_depth_mm: f64,
    thickness_mm: f64,
    /// z0, mm.
    beyond_top_mm: f64,
    /// zd, mm.
    beyond_bottom_mm: f64,
    too_thin: Option<TooThin>,
}

/// Why a slab is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MultipoleError {
    /// The medium or the ratio of indices at a face.
    #[error(transparent)]
    Medium(#[from] MediumError),
    /// Not a thickness.
    #[error("thickness must be finite and above 0 mm, got {value}")]
    Thickness {
        /// What was given, mm.
        value: f64,
    },
}

/// A slab too thin for diffusion: light crosses it before it is diffuse.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a slab of {thickness_mm} mm is thinner than its transport mean free path of {mean_free_path_mm:.4} mm: its reflectance is too high and its transmittance too low; take monte-carlo instead"
)]
pub struct TooThin {
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// l, mm.
    pub mean_free_path_mm: f64,
}

impl Multipole {
    /// A slab of `medium` between two boundaries.
    ///
    /// Where the slab is thinner than its mean free path the source is put in its middle, so that there is a number and no
    /// energy is lost; [`Multipole::too_thin`] tells.
    ///
    /// # Errors
    /// If the medium or a ratio cannot be real, or the thickness is not finite and positive.
    pub fn new(
        medium: &Medium,
        thickness_mm: f64,
        above: Boundary,
        below: Boundary,
    ) -> Result<Self, MultipoleError> {
        let medium = medium.validated()?;
        if !(thickness_mm > 0.0 && thickness_mm.is_finite()) {
            return Err(MultipoleError::Thickness { value: thickness_mm });
        }
        let mean_free_path_mm = medium.transport_mean_free_path_mm();
        // A source below the slab would make the transmittance negative.
        let is_thin = mean_free_path_mm >= thickness_mm;
        let source_depth_mm = if is_thin { 0.5 * thickness_mm } else { mean_free_path_mm };
        let beyond_mm = |boundary: Boundary| -> Result<f64, MediumError> {
            Ok(2.0 * reflection_parameter(&medium, boundary)? * medium.diffusion_coefficient_mm())
        };
        Ok(Self {
            albedo_reduced: medium.albedo_reduced(),
            sigma_tr_per_mm: medium.sigma_tr_per_mm(),
            source_depth_mm,
            too_thin: is_thin.then_some(TooThin { thickness_mm, mean_free_path_mm }),
            thickness_mm,
            beyond_top_mm: beyond_mm(above)?,
            beyond_bottom_mm: beyond_mm(below)?,
        })
    }

    /// Whether, and by how much, the slab is too thin for diffusion.
    pub fn too_thin(&self) -> Option<TooThin> {
        self.too_thin
    }

    /// What the slab does to light of spatial frequency k (radians per mm).
    #[allow(
        clippy::imprecise_flops,
        reason = "hypot would cost as much as all the rest; nothing here nears overflow"
    )]
    pub fn response(&self, k_per_mm: f64) -> Response {
        let q = (k_per_mm * k_per_mm + self.sigma_tr_per_mm * self.sigma_tr_per_mm).sqrt();
        let (l, d) = (self.source_depth_mm, self.thickness_mm);
        let (z0, zd, whole) = (self.beyond_top_mm, self.beyond_bottom_mm, self.whole_mm());
        let [a, b, c, e] = (f64x4::new([l, d - l, 2.0 * z0, 2.0 * zd]) * f64x4::splat(-q)).exp().to_array();
        // 1 - e^(-q length), which cancels for slow waves; only quotients of two are used, so that the slowest of all may
        // be divided by q.
        let rest = |product: f64, length_mm: f64| match q * whole {
            x if x > SLOW => 1.0 - product,
            x if x > STANDING => -(-q * length_mm).exp_m1(),
            _ => length_mm,
        };
        let scale = 0.5 * self.albedo_reduced / rest(a * a * b * b * c * e, 2.0 * whole);
        Response {
            reflectance_down: scale * a * (1.0 + c) * rest(b * b * e, 2.0 * (d - l + zd)),
            transmittance_down: scale * b * (1.0 + e) * rest(a * a * c, 2.0 * (l + z0)),
            reflectance_up: scale * a * (1.0 + e) * rest(b * b * c, 2.0 * (d - l + z0)),
            transmittance_up: scale * b * (1.0 + c) * rest(a * a * e, 2.0 * (l + zd)),
        }
    }

    /// T(r), 1/mm²: transmittance at a distance from the beam's axis, by poles.
    pub fn transmittance_at_mm(&self, r_mm: f64) -> f64 {
        far_first(POLES).flat_map(|i| self.transmittance_poles(i)).map(|pole| pole.at_mm(r_mm)).sum()
    }

    /// l, the depth of the real source, mm.
    pub(crate) fn source_depth_mm(&self) -> f64 {
        self.source_depth_mm
    }

    /// sigma_tr, 1/mm.
    pub(crate) fn sigma_tr_per_mm(&self) -> f64 {
        self.sigma_tr_per_mm
    }

    /// The slab with its faces changed.
    pub(crate) fn upside_down(&self) -> Self {
        Self { beyond_top_mm: self.beyond_bottom_mm, beyond_bottom_mm: self.beyond_top_mm, ..*self }
    }

    /// The i-th pair of poles of the reflectance.
    pub(crate) fn reflectance_poles(&self, i: i32) -> [Pole; 2] {
        let [real, mirrored] = self.sources_mm(i);
        [self.pole(real, 1.0), self.pole(mirrored, -1.0)]
    }

    /// The i-th pair of poles of the transmittance.
    pub(crate) fn transmittance_poles(&self, i: i32) -> [Pole; 2] {
        let [real, mirrored] = self.sources_mm(i);
        [self.pole(self.thickness_mm - real, 1.0), self.pole(self.thickness_mm - mirrored, -1.0)]
    }

    /// Places of the i-th real source and its mirror image, mm under the top.
    fn sources_mm(&self, i: i32) -> [f64; 2] {
        let shift = 2.0 * f64::from(i) * self.whole_mm();
        [shift + self.source_depth_mm, shift - self.source_depth_mm - 2.0 * self.beyond_top_mm]
    }

    /// A source above the face it is seen from counts with the other sign.
    fn pole(&self, z_mm: f64, sign: f64) -> Pole {
        Pole {
            power: self.albedo_reduced * sign * z_mm.signum(),
            depth_mm: z_mm.abs(),
            sigma_tr_per_mm: self.sigma_tr_per_mm,
        }
    }

    /// L, mm.
    pub(crate) fn whole_mm(&self) -> f64 {
        self.thickness_mm + self.beyond_top_mm + self.beyond_bottom_mm
    }
}

/// Numbers of pairs, those of the farthest poles first: small numbers before large ones.
fn far_first(pairs: i32) -> impl Iterator<Item = i32> {
    (1..=pairs).rev().flat_map(|i| [i, -i]).chain([0])
}

/// The reflectance.
impl Profile for Multipole {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.response(k_per_mm).reflectance_down
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        far_first(POLES).flat_map(|i| self.reflectance_poles(i)).map(|pole| pole.at_mm(r_mm)).sum()
    }

    fn poles(&self) -> Option<Vec<Pole>> {
        // With hardly any absorption the pairs left out still hold light: e^(-200 sigma_tr L) of it.
        let converged = 2.0 * f64::from(POLES) * self.sigma_tr_per_mm * self.whole_mm() > CONVERGED_EXPONENT;
        converged.then(|| (-POLES..=POLES).flat_map(|i| self.reflectance_poles(i)).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Dipole;
    use crate::oracle::hankel;

    fn slab(sigma_a: f64, sigma_s_reduced: f64, thickness_mm: f64, top: f64, bottom: f64) -> Multipole {
        let medium = Medium::new(sigma_a, sigma_s_reduced, 1.4).unwrap();
        Multipole::new(&medium, thickness_mm, Boundary::smooth(top), Boundary::smooth(bottom)).unwrap()
    }

    fn some_slabs() -> [Multipole; 5] {
        [
            slab(0.05, 5.0, 1.0, 1.4, 1.4),
            slab(0.0, 2.0, 0.8, 1.4, 1.0),
            slab(1.0, 10.0, 0.25, 1.4, 1.4 / 1.38),
            slab(0.001, 1.0, 20.0, 1.4, 0.8),
            slab(3.0, 1.0, 0.3, 1.5, 1.3),
        ]
    }

    /// The same by 401 poles, each transformed on its own.
    fn by_poles(slab: &Multipole, k: f64) -> [f64; 2] {
        let q = k.hypot(slab.sigma_tr_per_mm);
        let pole = |z: f64| 0.5 * z.signum() * (-z.abs() * q).exp();
        let (l, d, z0, whole) =
            (slab.source_depth_mm, slab.thickness_mm, slab.beyond_top_mm, slab.whole_mm());
        let mut sums = [0.0; 2];
        for i in -200..=200 {
            let shift = 2.0 * f64::from(i) * whole;
            let (real, mirrored) = (shift + l, shift - l - 2.0 * z0);
            sums[0] += pole(real) - pole(mirrored);
            sums[1] += pole(d - real) - pole(d - mirrored);
        }
        sums.map(|s| s * slab.albedo_reduced)
    }

    #[test]
    fn the_closed_form_is_the_sum_of_401_poles() {
        for slab in some_slabs() {
            for x in [0.3, 1.0, 3.0, 10.0] {
                let k = x / slab.thickness_mm;
                let [r, t] = by_poles(&slab, k);
                assert!((slab.response(k).reflectance_down - r).abs() < 1e-9, "{slab:?}, {k}");
                assert!((slab.response(k).transmittance_down - t).abs() < 1e-9, "{slab:?}, {k}");
            }
        }
    }

    #[test]
    fn spectra_are_the_hankel_transforms_of_the_radial_forms() {
        for slab in [some_slabs()[0], some_slabs()[2], some_slabs()[4]] {
            let far = 60.0 / slab.sigma_tr_per_mm;
            let near = 1e-7 * slab.source_depth_mm;
            for x in [0.0, 0.5, 2.0] {
                let k = x / slab.thickness_mm;
                let r = hankel(k, near, far, |r| slab.at_mm(r));
                let t = hankel(k, near, far, |r| slab.transmittance_at_mm(r));
                assert!((slab.response(k).reflectance_down - r).abs() < 1e-6, "R({k}): {r}");
                assert!((slab.response(k).transmittance_down - t).abs() < 1e-6, "T({k}): {t}");
            }
        }
    }

    #[test]
    fn without_absorption_nothing_is_lost() {
        for (top, bottom) in [(1.0, 1.0), (1.4, 1.4), (1.4, 1.0), (0.8, 1.5)] {
            let slab = slab(0.0, 3.0, 1.0, top, bottom);
            let whole = slab.response(0.0);
            for sum in [
                whole.reflectance_down + whole.transmittance_down,
                whole.reflectance_up + whole.transmittance_up,
            ] {
                assert!((sum - 1.0).abs() < 4.0 * f64::EPSILON, "{sum}");
            }
        }
    }

    #[test]
    fn a_thick_slab_is_a_half_space() {
        let medium = Medium::new(0.1, 2.0, 1.4).unwrap();
        let (thick, half_space) = (
            Multipole::new(&medium, 60.0, Boundary::smooth(1.4), Boundary::smooth(1.0)).unwrap(),
            Dipole::new(&medium).unwrap(),
        );
        for k in [0.0, 0.3, 2.0, 30.0] {
            // Distances to the far face round to 1e-14 mm.
            assert!((thick.spectrum(k) - half_space.spectrum(k)).abs() < 1e-13, "{k}");
            assert!(thick.response(k).transmittance_down < 1e-18);
        }
        assert!((thick.at_mm(0.7) / half_space.at_mm(0.7) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn upside_down_it_is_the_slab_with_its_faces_changed() {
        let (there, back) = (slab(0.1, 4.0, 0.9, 1.4, 1.0), slab(0.1, 4.0, 0.9, 1.0, 1.4));
        for k in [0.0, 1.0, 10.0] {
            let (there, back) = (there.response(k), back.response(k));
            assert!((there.reflectance_up - back.reflectance_down).abs() < 1e-15);
            assert!((there.transmittance_up - back.transmittance_down).abs() < 1e-15);
        }
    }

    #[test]
    fn slow_and_fast_waves_pass_over_into_each_other() {
        for slab in some_slabs() {
            for k in [0.0, 1e-200, 1e-9, 1e3, 1e9] {
                let Response { reflectance_down: r, transmittance_down: t, .. } = slab.response(k);
                assert!((0.0..=1.0).contains(&r) && (0.0..=1.0).contains(&t), "{k}: {r} {t}");
            }
        }
        // Without absorption q is k: on both sides of both switches.
        let clear = slab(0.0, 3.0, 1.0, 1.4, 1.2);
        for switch in [SLOW, STANDING] {
            let k = switch / clear.whole_mm();
            let [below, above] = [0.999, 1.001].map(|x| clear.response(k * x));
            assert!((below.reflectance_down - above.reflectance_down).abs() < 1e-8 * switch.sqrt() + 1e-12);
            assert!(
                (below.transmittance_down - above.transmittance_down).abs() < 1e-8 * switch.sqrt() + 1e-12
            );
        }
    }

    #[test]
    fn poles_add_up_to_the_total_or_are_not_given() {
        for sigma_a in [0.0, 1e-6, 1e-4, 1e-2, 1.0] {
            let slab = slab(sigma_a, 5.0, 1.0, 1.4, 1.4);
            let Some(poles) = slab.poles() else {
                assert!(sigma_a < 1e-3, "poles converge at {sigma_a}");
                continue;
            };
            let total: f64 = poles.iter().map(Pole::total).sum();
            assert!((total - slab.total()).abs() < 1e-5, "{sigma_a}: {total} against {}", slab.total());
        }
    }

    #[test]
    fn impossible_slabs_are_refused() {
        let medium = Medium::new(0.1, 2.0, 1.4).unwrap();
        for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Multipole::new(&medium, thickness, Boundary::smooth(1.4), Boundary::smooth(1.4)),
                Err(MultipoleError::Thickness { .. })
            ));
        }
        assert!(matches!(
            Multipole::new(&medium, 1.0, Boundary::smooth(9.0), Boundary::smooth(1.4)),
            Err(MultipoleError::Medium(_))
        ));
    }

    #[test]
    fn slabs_thinner_than_a_mean_free_path_give_a_number_and_say_so() {
        // l = 1/2.1 mm.
        let smooth = Boundary::smooth(1.4);
        let of = |sigma_a, thickness_mm| {
            Multipole::new(&Medium::new(sigma_a, 2.1 - sigma_a, 1.4).unwrap(), thickness_mm, smooth, smooth)
                .unwrap()
        };
        assert_eq!(of(0.1, 0.5).too_thin(), None);
        let told = of(0.1, 0.4).too_thin().unwrap().to_string();
        assert!(told.contains("0.4 mm is thinner than its transport mean free path of 0.4762 mm"), "{told}");
        for thickness_mm in [0.4, 0.04, 1e-6] {
            let whole = of(0.0, thickness_mm).response(0.0);
            assert!((whole.reflectance_down + whole.transmittance_down - 1.0).abs() < 1e-14);
            for k in [0.0, 1.0, 100.0] {
                let r = of(0.1, thickness_mm).response(k);
                assert!(
                    (0.0..=1.0).contains(&r.reflectance_down) && (0.0..=1.0).contains(&r.transmittance_down)
                );
            }
        }
    }
}
