//! A stack of slabs, each a multipole, combined in spatial frequency (Kubelka–Munk for every frequency).
//!
//! Symbols: + for light that comes from above, - for light from below; 1 the upper and 2 the lower part.
//! T12+ = T1+ T2+ / (1 - R2+ R1-), R12+ = R1+ + T1+ R2+ T1- / (1 - R2+ R1-), and - by exchanging roles.
//! Source: Donner & Jensen 2005, doi:10.1145/1073204.1073308 (not opened), as restated by d'Eon, Luebke & Enderton 2007,
//! equation 5. The quotient is the whole series of reflections to and fro.
//! Not modelled: that light has a direction at the interfaces. Two identical slabs are not quite one of twice the
//! thickness, because each part is lit anew by a source one mean free path under its face.

use crate::hankel::inverse_hankel;
use crate::multipole::{MultipoleError, Response, TooThin};
use crate::powers::{Powers, PowersSettings};
use crate::{Boundary, Dipole, Medium, Multipole, Profile};

/// One layer of a stack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TissueLayer {
    /// What it is made of.
    pub medium: Medium,
    /// How thick it is, mm; infinite for the last layer of a half-space.
    pub thickness_mm: f64,
}

impl TissueLayer {
    /// The same layer in which every length, its thickness too, is `factor` times as long.
    pub fn stretched(&self, factor: f64) -> Self {
        Self { medium: self.medium.stretched(factor), thickness_mm: self.thickness_mm * factor }
    }
}

/// Layers under air, from top to bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    slabs: Vec<Multipole>,
    bottom: Option<Dipole>,
}

/// Why a stack is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StackError {
    /// Nothing to see.
    #[error("there must be at least one layer")]
    Empty,
    /// A layer that cannot be.
    #[error("layer {layer}: {reason}")]
    Layer {
        /// Number of the layer, the top one is 1.
        layer: usize,
        /// What is wrong with it. An infinite thickness is allowed in the last layer only.
        reason: MultipoleError,
    },
}

impl Response {
    /// This part on top of another.
    pub fn over(self, lower: Self) -> Self {
        let to_and_fro = 1.0 / (1.0 - lower.reflectance_down * self.reflectance_up);
        Self {
            reflectance_down: self.reflectance_down
                + self.transmittance_down * lower.reflectance_down * self.transmittance_up * to_and_fro,
            transmittance_down: self.transmittance_down * lower.transmittance_down * to_and_fro,
            reflectance_up: lower.reflectance_up
                + lower.transmittance_up * self.reflectance_up * lower.transmittance_down * to_and_fro,
            transmittance_up: lower.transmittance_up * self.transmittance_up * to_and_fro,
        }
    }
}

impl Stack {
    /// A stack in air.
    ///
    /// # Errors
    /// If there is no layer or one of them cannot be.
    pub fn in_air(layers: &[TissueLayer]) -> Result<Self, StackError> {
        Self::with_top(layers, Boundary::smooth)
    }

    /// A stack in air whose top is rough: `rho_dt_mean` is the share of isotropic light that it lets in (see
    /// [`Boundary::Rough`]); between layers all is smooth.
    ///
    /// # Errors
    /// As [`Stack::in_air`], or if the share is not one.
    pub fn under_rough_surface(layers: &[TissueLayer], rho_dt_mean: f64) -> Result<Self, StackError> {
        Self::with_top(layers, |eta_inside_over_outside| Boundary::Rough {
            eta_inside_over_outside,
            rho_dt_mean,
        })
    }

    /// A stack in air; `top` makes the uppermost boundary of the ratio of indices there.
    fn with_top(layers: &[TissueLayer], top: impl Fn(f64) -> Boundary) -> Result<Self, StackError> {
        let last = layers.last().ok_or(StackError::Empty)?;
        let index = |i: usize| layers.get(i).map_or(1.0, |layer| layer.medium.refractive_index);
        let refused = |i: usize| move |reason| StackError::Layer { layer: i + 1, reason };
        let endless = last.thickness_mm == f64::INFINITY;
        let finite = if endless { &layers[..layers.len() - 1] } else { layers };
        // In front of the first and behind the last there is air.
        let above = |i: usize| if i == 0 { top(index(0)) } else { Boundary::smooth(index(i) / index(i - 1)) };
        let slab = |(i, layer): (usize, &TissueLayer)| {
            let below = Boundary::smooth(index(i) / index(i + 1));
            Multipole::new(&layer.medium, layer.thickness_mm, above(i), below).map_err(refused(i))
        };
        let slabs = finite.iter().enumerate().map(slab).collect::<Result<Vec<_>, _>>()?;
        let i = layers.len() - 1;
        let half_space = || {
            let dipole = Dipole::with_boundary(&last.medium, above(i));
            dipole.map_err(MultipoleError::from).map_err(refused(i))
        };
        let bottom = if endless { Some(half_space()?) } else { None };
        Ok(Self { slabs, bottom })
    }

    /// Layers too thin for diffusion, by their number; the top one is 1.
    pub fn too_thin(&self) -> Vec<(usize, TooThin)> {
        let thin = |(i, slab): (usize, &Multipole)| slab.too_thin().map(|thin| (i + 1, thin));
        self.slabs.iter().enumerate().filter_map(thin).collect()
    }

    /// The slabs of finite thickness, from top to bottom.
    pub(crate) fn slabs(&self) -> &[Multipole] {
        &self.slabs
    }

    /// The half-space under them.
    pub(crate) fn bottom(&self) -> Option<&Dipole> {
        self.bottom.as_ref()
    }

    /// Depth of the shallowest source under its layer's top, mm: the shortest transport mean free path, but of slabs thinner
    /// than theirs.
    pub fn shortest_mean_free_path_mm(&self) -> f64 {
        let slabs = self.slabs.iter().map(Multipole::source_depth_mm);
        slabs.chain(self.bottom.map(|dipole| dipole.depth_real_mm())).fold(f64::INFINITY, f64::min)
    }

    /// Smallest sigma_tr of all layers, 1/mm: with it the profile falls far from the beam, or faster.
    pub(crate) fn slowest_decay_per_mm(&self) -> f64 {
        let slabs = self.slabs.iter().map(Multipole::sigma_tr_per_mm);
        slabs.chain(self.bottom.map(|dipole| dipole.sigma_tr_per_mm())).fold(f64::INFINITY, f64::min)
    }

    /// What the whole stack does to light of spatial frequency k (radians per mm).
    pub fn response(&self, k_per_mm: f64) -> Response {
        let bottom = self.bottom.map(|dipole| Response {
            reflectance_down: dipole.spectrum(k_per_mm),
            transmittance_down: 0.0,
            reflectance_up: 0.0,
            transmittance_up: 0.0,
        });
        let slabs = self.slabs.iter().rev().map(|slab| slab.response(k_per_mm));
        let parts = bottom.into_iter().chain(slabs);
        parts.reduce(|lower, upper| upper.over(lower)).expect("a stack has at least one layer")
    }

    /// Transmittance at spatial frequency k; 0 for a half-space.
    pub fn transmittance_spectrum(&self, k_per_mm: f64) -> f64 {
        self.response(k_per_mm).transmittance_down
    }

    /// Transmittance at a distance from the beam's axis, 1/mm².
    pub fn transmittance_at_mm(&self, r_mm: f64) -> f64 {
        inverse_hankel(r_mm, |k| self.transmittance_spectrum(k))
    }
}

/// What comes out below a stack, as a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct StackTransmittance(Stack);

impl Stack {
    /// The transmittance as a profile; none where the last layer is endless.
    pub fn into_transmittance(self) -> Option<StackTransmittance> {
        self.bottom.is_none().then_some(StackTransmittance(self))
    }
}

impl Profile for StackTransmittance {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.0.transmittance_spectrum(k_per_mm)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        self.0.transmittance_at_mm(r_mm)
    }
}

/// The reflectance.
impl Profile for Stack {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.response(k_per_mm).reflectance_down
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        inverse_hankel(r_mm, |k| self.spectrum(k))
    }

    fn powers(&self) -> Option<Powers> {
        let fit = self.as_powers(&PowersSettings::for_stack(self));
        Some(fit.expect("the usual settings are possible").reflectance)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::simpson;
    use crate::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};

    fn layer(sigma_a: f64, sigma_s_reduced: f64, index: f64, thickness_mm: f64) -> TissueLayer {
        TissueLayer { medium: Medium::new(sigma_a, sigma_s_reduced, index).unwrap(), thickness_mm }
    }

    fn three() -> [TissueLayer; 3] {
        [layer(0.3, 6.0, 1.4, 0.4), layer(0.1, 3.0, 1.38, 1.5), layer(0.02, 4.0, 1.44, 1.0)]
    }

    /// Light sent down the stack, followed from interface to interface until 1e-15 of it is left.
    fn by_bouncing(parts: &[Response]) -> [f64; 2] {
        // What travels down into, and up into, each part.
        let n = parts.len();
        let (mut down, mut up) = (vec![0.0; n + 1], vec![0.0; n + 1]);
        down[0] = 1.0;
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        while down.iter().chain(&up).sum::<f64>() > 1e-15 {
            let (mut next_down, mut next_up) = (vec![0.0; n + 1], vec![0.0; n + 1]);
            for (i, part) in parts.iter().enumerate() {
                // Above part i is interface i, below it interface i + 1.
                next_up[i] += down[i] * part.reflectance_down + up[i + 1] * part.transmittance_up;
                next_down[i + 1] += down[i] * part.transmittance_down + up[i + 1] * part.reflectance_up;
            }
            reflected += next_up[0];
            transmitted += next_down[n];
            (next_up[0], next_down[n]) = (0.0, 0.0);
            (down, up) = (next_down, next_up);
        }
        [reflected, transmitted]
    }

    #[test]
    fn three_layers_are_the_series_of_all_reflections() {
        let layers = three();
        let stack = Stack::in_air(&layers).unwrap();
        let index = |i: usize| layers[i].medium.refractive_index;
        for k in [0.0, 0.5, 2.0, 8.0] {
            let parts: Vec<Response> = (0..3)
                .map(|i| {
                    let (above, below) =
                        (if i > 0 { index(i - 1) } else { 1.0 }, if i < 2 { index(i + 1) } else { 1.0 });
                    let slab = Multipole::new(
                        &layers[i].medium,
                        layers[i].thickness_mm,
                        Boundary::smooth(index(i) / above),
                        Boundary::smooth(index(i) / below),
                    )
                    .unwrap();
                    slab.response(k)
                })
                .collect();
            let [r, t] = by_bouncing(&parts);
            assert!((stack.spectrum(k) - r).abs() < 1e-13, "R({k}): {r}");
            assert!((stack.transmittance_spectrum(k) - t).abs() < 1e-13, "T({k}): {t}");
        }
    }

    #[test]
    fn without_absorption_nothing_is_lost() {
        let clear = three().map(|l| TissueLayer { medium: Medium { sigma_a_per_mm: 0.0, ..l.medium }, ..l });
        let whole = Stack::in_air(&clear).unwrap().response(0.0);
        assert!((whole.reflectance_down + whole.transmittance_down - 1.0).abs() < 1e-14);
        assert!((whole.reflectance_up + whole.transmittance_up - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_rough_top_holds_less_light_back() {
        let layers = three();
        let smooth = Stack::in_air(&layers).unwrap();
        // A rough surface that lets in as much as a smooth one of index 1.4 (1 - Fdr) eta² is that surface.
        let lets_in = (1.0 - Boundary::smooth(1.4).diffuse_reflectance()) * 1.4 * 1.4;
        let same = Stack::under_rough_surface(&layers, lets_in).unwrap();
        assert!((same.total() - smooth.total()).abs() < 1e-14);
        // One that lets more in also lets more out: more light comes back, and it spreads less.
        let open = Stack::under_rough_surface(&layers, 1.0).unwrap();
        assert!(open.total() > smooth.total());
        assert!(Stack::under_rough_surface(&layers, 1.5).is_err());
    }

    #[test]
    fn one_layer_is_the_slab_and_the_radius_is_met() {
        let one = layer(0.2, 5.0, 1.4, 1.0);
        let stack = Stack::in_air(&[one]).unwrap();
        let slab = Multipole::new(&one.medium, 1.0, Boundary::smooth(1.4), Boundary::smooth(1.4)).unwrap();
        let unit = slab.spectrum(0.0) / one.medium.transport_mean_free_path_mm().powi(2);
        for r in [0.0, 0.05, 0.3, 1.0, 3.0] {
            assert!((stack.at_mm(r) - slab.at_mm(r)).abs() < 1e-9 * unit, "R({r})");
            assert!(
                (stack.transmittance_at_mm(r) - slab.transmittance_at_mm(r)).abs() < 1e-9 * unit,
                "T({r})"
            );
        }
    }

    #[test]
    fn layers_of_very_different_size_are_met_in_the_radius() {
        // By the simpler rule, even in k, with as many steps as it takes.
        let even = |r: f64, far: f64, f: &dyn Fn(f64) -> f64| {
            simpson(0.0, far, 400_000, |k| f(k) * k * libm::j0(k * r)) / core::f64::consts::TAU
        };
        let cases = [
            ([layer(0.1, 2.0, 1.4, 0.04), layer(0.1, 2.0, 1.4, f64::INFINITY)], 2000.0),
            ([layer(0.1, 5.0, 1.4, 0.06), layer(0.1, 2.0, 1.38, f64::INFINITY)], 2000.0),
            ([layer(0.1, 2.0, 1.4, 0.5), layer(0.1, 100.0, 1.4, f64::INFINITY)], 4000.0),
            ([layer(0.1, 1000.0, 1.4, 0.5), layer(0.1, 1.0, 1.4, f64::INFINITY)], 40_000.0),
        ];
        for (layers, far) in cases {
            let stack = Stack::in_air(&layers).unwrap();
            for r in [0.1, 1.0] {
                let slow = even(r, far, &|k| stack.spectrum(k));
                let ours = stack.at_mm(r);
                // Far from a dense top both sums are rounding of a peak 1e12 times as high.
                let rounding = 1e-11 * stack.at_mm(0.0);
                assert!(
                    (ours - slow).abs() < 1e-5 * slow.abs() + rounding,
                    "{layers:?} at {r}: {ours} against {slow}"
                );
            }
        }
        // A slab hardly thicker than its mean free path lets waves of all sizes through.
        let slab = Stack::in_air(&[layer(0.1, 2.0, 1.4, 0.5)]).unwrap();
        let poles =
            Multipole::new(&slab_medium(), 0.5, Boundary::smooth(1.4), Boundary::smooth(1.4)).unwrap();
        for r in [0.1, 1.0] {
            let off = slab.transmittance_at_mm(r) / poles.transmittance_at_mm(r) - 1.0;
            assert!(off.abs() < 1e-5, "T({r}): off by {off}");
        }
    }

    fn slab_medium() -> Medium {
        Medium::new(0.1, 2.0, 1.4).unwrap()
    }

    #[test]
    fn a_half_space_under_a_half_space_s_skin_differs_as_much_as_is_known() {
        // The same medium cut in two. Each part is lit by a source of its own, so a cut costs light: a few percent.
        let medium = layer(0.05, 5.0, 1.4, f64::INFINITY);
        let whole = Stack::in_air(&[medium]).unwrap().total();
        let cut = Stack::in_air(&[TissueLayer { thickness_mm: 2.0, ..medium }, medium]).unwrap().total();
        eprintln!("cut in two: {:+.3} % of the total", 100.0 * (cut / whole - 1.0));
        assert!((cut / whole - 1.0).abs() < 0.02, "{cut} against {whole}");
    }

    #[test]
    fn two_slabs_glued_are_nearly_one_of_twice_the_thickness() {
        // Kubelka and Munk's sum would be exact for light that is diffuse at the cut. Here what crosses it lights the lower
        // slab anew from one mean free path (0.2 mm) under its face: 4.7 to 4.9 % too much light comes through, whatever the
        // thickness, and the reflectance feels it the less, the deeper the cut (0.34, 0.039, 0.001 %).
        for (thickness_mm, percent) in [(1.0, 0.4), (2.0, 0.05), (4.0, 0.002)] {
            let half = layer(0.05, 5.0, 1.4, thickness_mm);
            let glued = Stack::in_air(&[half, half]).unwrap().response(0.0);
            let whole = Stack::in_air(&[TissueLayer { thickness_mm: 2.0 * thickness_mm, ..half }]).unwrap();
            let whole = whole.response(0.0);
            let reflectance = 100.0 * (glued.reflectance_down / whole.reflectance_down - 1.0);
            let transmittance = 100.0 * (glued.transmittance_down / whole.transmittance_down - 1.0);
            eprintln!("two of {thickness_mm} mm: R {reflectance:+.3} %, T {transmittance:+.3} %");
            assert!(reflectance.abs() < percent, "R {reflectance}");
            assert!((4.5..5.0).contains(&transmittance), "T {transmittance}");
        }
    }

    #[test]
    fn two_layers_meet_the_monte_carlo() {
        // Scattering dominates, so that diffusion theory holds: totals within 4 % of transport theory.
        let layers = [layer(0.01, 5.0, 1.4, 1.5), layer(0.1, 4.0, 1.4, f64::INFINITY)];
        let stack = Stack::in_air(&layers).unwrap();
        let simulated = layers.map(|l| Layer {
            sigma_a_per_mm: l.medium.sigma_a_per_mm,
            sigma_s_per_mm: l.medium.sigma_s_reduced_per_mm,
            g: 0.0,
            refractive_index: l.medium.refractive_index,
            thickness_mm: l.thickness_mm,
        });
        let slab = LayeredSlab::in_air(simulated.to_vec()).unwrap();
        let grid =
            Grid { rings: Rings::even(1.0, 1).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
        let specular = slab.specular_reflectance();
        let estimates = Simulation { slab, grid, seed: 1 }.run(40_960);
        let truth = estimates.diffuse_reflectance();
        let entered = truth.value / (1.0 - specular);
        assert!(truth.standard_error < 0.003);
        assert!((stack.total() / entered - 1.0).abs() < 0.04, "{} against {entered}", stack.total());
    }

    #[test]
    fn impossible_stacks_are_refused_by_the_layer_at_fault() {
        assert_eq!(Stack::in_air(&[]), Err(StackError::Empty));
        let endless = layer(0.1, 1.0, 1.4, f64::INFINITY);
        let error = Stack::in_air(&[endless, endless]).unwrap_err().to_string();
        assert!(error.starts_with("layer 1: thickness must be finite"), "{error}");
        let error = Stack::in_air(&[layer(0.1, 1.0, 1.4, 1.0), layer(0.1, 1.0, 1.4, -1.0)]).unwrap_err();
        assert!(error.to_string().starts_with("layer 2"), "{error}");
    }
}
