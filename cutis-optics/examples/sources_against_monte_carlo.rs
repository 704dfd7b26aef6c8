//! How far each source is off, against a simulation of the same half-space: `cargo run --release -p cutis-optics --example
//! sources_against_monte_carlo [packets]`.
//!
//! Isotropic scattering, normal beam, sigma_t' = 1/mm, so that a mean free path is a millimetre. Shape: relative RMS power
//! error of the means over rings of 0.05 mean free paths out to 20, what chance adds to it taken off. Under `fitted` stands a
//! sum of twelve Gaussians (method energy) fitted to another run of the simulation.

#[path = "../tests/common/half_space.rs"]
mod half_space;

use cutis_optics::{
    Dipole, FitMethod, Medium, Profile, ProfileSource, RingProfile, SingleScattering, TissueLayer, WideBeam,
    fit,
};
use half_space::{RING_MM, Truth, simulate};
use std::error::Error;
use std::io::{Write, stdout};

const ALBEDOS: [f64; 7] = [0.2, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999];
const INDICES: [f64; 2] = [1.0, 1.4];
/// Deviation of the beam that the fitted profile is seen under, taken off its Gaussians again.
const BEAM_MM: f64 = 0.1 * RING_MM;
/// Its rings are so many times as fine.
const FINER: usize = 5;
const GAUSSIANS: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let packets = std::env::args().nth(1).map_or(Ok(400_000), |words| words.parse())?;
    let mut out = stdout().lock();
    writeln!(out, "| n | alpha' | R_d simulated | dipole | + single | better | beam | fitted | noise |")?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|")?;
    for index in INDICES {
        for albedo in ALBEDOS {
            writeln!(out, "{}", row(index, albedo, packets)?)?;
            out.flush()?;
        }
    }
    Ok(())
}

fn row(index: f64, albedo: f64, packets: u64) -> Result<String, Box<dyn Error>> {
    let medium = Medium::new(1.0 - albedo, albedo, index)?;
    let layers = [TissueLayer { medium, thickness_mm: f64::INFINITY }];
    let truth = Truth::new(&simulate(&medium, packets, 1, 1)?);
    let (dipole, single) = (Dipole::new(&medium)?, SingleScattering::new(&medium)?);
    let sum = |r: f64| dipole.at_mm(r) + single.at_mm(r);
    let cell = |total: f64, at_mm: &dyn Fn(f64) -> f64| {
        let off = truth.error_of(total, at_mm);
        format!(" {:+.1} [{:.1}] |", 100.0 * off.total, 100.0 * off.shape)
    };
    let mut row = format!("| {index} | {albedo} | {:.5} ± {:.5} |", truth.total, truth.standard_error);
    row += &cell(dipole.total(), &|r| dipole.at_mm(r));
    row += &cell(dipole.total() + single.total(), &sum);
    for source in [ProfileSource::BetterDipole, ProfileSource::Beam] {
        let profile = source.profile(&layers)?;
        row += &cell(profile.total(), &|r| profile.at_mm(r));
    }
    let other = RingProfile::from_estimates(&simulate(&medium, packets, 2, FINER)?);
    let total = other.total() + other.beyond().value;
    let mut fitted = fit(&WideBeam::new(other, BEAM_MM), GAUSSIANS, FitMethod::Energy)?.sum;
    fitted.terms.iter_mut().for_each(|g| g.variance_mm2 = (g.variance_mm2 - BEAM_MM * BEAM_MM).max(1e-6));
    row += &cell(total, &|r| fitted.at_mm(r));
    Ok(row + &format!(" {:.2} % |", 100.0 * truth.noise()))
}
