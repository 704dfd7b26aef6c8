//! The profile of some layers by the source that is asked for.

use super::job::Job;
use crate::progress::Bar;
use crate::simulate::{ends, in_parallel};
use cutis_optics::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_optics::{BoxedProfile, Medium, ProfileSource, RingProfile, Stack, TissueLayer, WideBeam};
use cutis_render::prepare::RhoDt;
use miette::{Result, miette};

/// Standard deviation of the beam that profiles with a peak are seen under, in transport mean free paths, unless told
/// otherwise.
const BEAM_MEAN_FREE_PATHS: f64 = 0.05;
/// Narrowest beam, in transport mean free paths: what is narrower is a point.
const BEAM_LEAST: f64 = 1e-4;
/// Width of the innermost rings of the simulation, in standard deviations of the usual beam: fine enough that it does not
/// matter that each is taken as even.
const RING_DEVIATIONS: f64 = 0.2;
/// These are so many; beyond, each edge is so much farther than the one before, …
const EVEN_RINGS: usize = 40;
const GROWTH: f64 = 1.025;
/// … out to where e^-12 of the slowest decay is left, or, where hardly anything is absorbed, to so many mean free paths.
const REACH_EXPONENT: f64 = 12.0;
const REACH_MEAN_FREE_PATHS: f64 = 1e5;

/// A profile, and how it is seen.
pub struct Sourced {
    pub profile: BoxedProfile,
    /// What comes out below, where the layers end.
    pub transmitted: Option<BoxedProfile>,
    /// Standard deviation of the beam, mm; none for a point.
    pub beam_standard_deviation_mm: Option<f64>,
    /// What chance may have done to the total, where it was simulated.
    pub total_standard_error: Option<f64>,
    /// Light that left beyond the rings of a simulation, of what entered.
    pub light_beyond_rings: f64,
}

/// The profile of `layers` as the job asks for it.
pub fn of_layers(job: &Job, source: ProfileSource, layers: &[TissueLayer]) -> Result<Sourced> {
    let Point { reflected, transmitted, total_standard_error, light_beyond_rings } = match source {
        ProfileSource::MonteCarlo => simulated(job, layers)?,
        _ => computed(job, source, layers)?,
    };
    let usual_mm = || {
        let l_mm = layers[0].medium.transport_mean_free_path_mm();
        source.has_peak().then_some(BEAM_MEAN_FREE_PATHS * l_mm)
    };
    let beam_standard_deviation_mm = job.beam_mm.or_else(usual_mm);
    let l_mm = layers[0].medium.transport_mean_free_path_mm();
    if let Some(mm) = beam_standard_deviation_mm.filter(|mm| *mm < BEAM_LEAST * l_mm) {
        return Err(miette!(
            "--beam must be at least {BEAM_LEAST:e} mean free paths, here {} mm, got {mm} mm",
            BEAM_LEAST * l_mm
        ));
    }
    let lit = |point: BoxedProfile| -> BoxedProfile {
        match beam_standard_deviation_mm {
            Some(deviation_mm) => Box::new(WideBeam::new(point, deviation_mm)),
            None => point,
        }
    };
    Ok(Sourced {
        profile: lit(reflected),
        transmitted: transmitted.map(lit),
        beam_standard_deviation_mm,
        total_standard_error,
        light_beyond_rings,
    })
}

/// What leaves under a point that is lit.
struct Point {
    reflected: BoxedProfile,
    transmitted: Option<BoxedProfile>,
    total_standard_error: Option<f64>,
    light_beyond_rings: f64,
}

fn ends_below(layers: &[TissueLayer]) -> bool {
    layers.last().is_some_and(|layer| layer.thickness_mm.is_finite())
}

fn computed(job: &Job, source: ProfileSource, layers: &[TissueLayer]) -> Result<Point> {
    let share = job.roughness.map(|roughness| lets_in(&layers[0].medium, roughness));
    let reflected = match share {
        Some(share) => source.profile_under_rough_surface(layers, share),
        None => source.profile(layers),
    };
    let reflected = reflected.map_err(|error| miette!("{error}"))?;
    // Of the formulas only the multipole knows layers that end, and it is a stack.
    let stack = || match share {
        Some(share) => Stack::under_rough_surface(layers, share),
        None => Stack::in_air(layers),
    };
    let stack = ends_below(layers).then(stack).transpose().map_err(|error| miette!("{error}"))?;
    let transmitted = stack.and_then(Stack::into_transmittance).map(|t| Box::new(t) as BoxedProfile);
    Ok(Point { reflected, transmitted, total_standard_error: None, light_beyond_rings: 0.0 })
}

/// Share of isotropic light that a rough surface lets in.
fn lets_in(medium: &Medium, roughness: f32) -> f64 {
    let n = medium.refractive_index;
    let f0 = ((n - 1.0) / (n + 1.0)).powi(2);
    f64::from(RhoDt::new(f0 as f32).mean(roughness, 1.0))
}

fn simulated(job: &Job, layers: &[TissueLayer]) -> Result<Point> {
    if job.roughness.is_some() {
        return Err(miette!("the source monte-carlo knows smooth surfaces only: leave --roughness out"));
    }
    let slab = LayeredSlab::in_air(layers.iter().map(isotropic).collect()).map_err(|e| miette!("{e}"))?;
    ends(&slab)?;
    let entered = 1.0 - slab.specular_reflectance();
    let simulation = Simulation { slab, grid: grid(job, layers)?, seed: job.seed };
    let bar = Bar::new(job.verbose);
    let estimates = in_parallel(&simulation, job.photons, &bar);
    bar.finish();
    let error = estimates.diffuse_reflectance().standard_error / entered;
    let below = || Box::new(RingProfile::transmittance_from_estimates(&estimates)) as BoxedProfile;
    let rings = RingProfile::from_estimates(&estimates);
    let light_beyond_rings = rings.beyond().value;
    Ok(Point {
        reflected: Box::new(rings),
        transmitted: ends_below(layers).then(below),
        total_standard_error: Some(error),
        light_beyond_rings,
    })
}

/// Reduced scattering has no phase function: isotropic, as all other sources take it.
fn isotropic(layer: &TissueLayer) -> Layer {
    Layer {
        sigma_a_per_mm: layer.medium.sigma_a_per_mm,
        sigma_s_per_mm: layer.medium.sigma_s_reduced_per_mm,
        g: 0.0,
        refractive_index: layer.medium.refractive_index,
        thickness_mm: layer.thickness_mm,
    }
}

fn grid(job: &Job, layers: &[TissueLayer]) -> Result<Grid> {
    let usual_mm = BEAM_MEAN_FREE_PATHS * layers[0].medium.transport_mean_free_path_mm();
    let width_mm = RING_DEVIATIONS * job.beam_mm.unwrap_or(usual_mm).min(usual_mm);
    let longest = |length: fn(&Medium) -> f64| layers.iter().map(|l| length(&l.medium)).fold(0.0, f64::max);
    let reach_mm = (REACH_EXPONENT * longest(Medium::diffuse_mean_free_path_mm))
        .min(REACH_MEAN_FREE_PATHS * longest(Medium::transport_mean_free_path_mm));
    let rings =
        Rings::new(width_mm, EVEN_RINGS, GROWTH, reach_mm).map_err(|error| miette!("rings: {error}"))?;
    Ok(Grid { rings, depth_step_mm: reach_mm, depth_bins: 1, cosine_bins: 0 })
}
