//! Better dipole and beam, as the sources give them, against a simulation of the same half-space.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "common/half_space.rs"]
mod half_space;

use cutis_optics::{Medium, Profile, ProfileSource, TissueLayer};
use half_space::{Off, Truth, simulate};

const PACKETS: u64 = 409_600;

#[test]
fn better_dipole_and_beam_are_off_by_what_is_known() {
    // Three million packets say so, in percent: albedo, then total and shape of the better dipole and of the beam.
    for (albedo, better, beam) in [(0.5, (5.3, 6.4), (10.1, 2.3)), (0.95, (6.2, 12.3), (3.5, 2.0))] {
        let medium = Medium::new(1.0 - albedo, albedo, 1.4).unwrap();
        let layers = [TissueLayer { medium, thickness_mm: f64::INFINITY }];
        let truth = Truth::new(&simulate(&medium, PACKETS, 5, 1).unwrap());
        // Four standard errors of ours, and half a unit of the last digit known.
        let total_percent = 4.0 * 100.0 * truth.standard_error / truth.total + 0.05;
        // Along the formula's miss chance has a part of its own, which spreads over the rings of the peak, some ten.
        let shape_percent = 100.0 * truth.noise() / 10_f64.sqrt() * 2.0 + 0.05;
        for (source, (total, shape)) in [(ProfileSource::BetterDipole, better), (ProfileSource::Beam, beam)] {
            let profile = source.profile(&layers).unwrap();
            let off: Off = truth.error_of(profile.total(), &|r| profile.at_mm(r));
            eprintln!("{source} {albedo}: {off:?}, tolerances {total_percent} {shape_percent}");
            assert!((100.0 * off.total - total).abs() < total_percent, "{source} {albedo}: {off:?}");
            assert!((100.0 * off.shape - shape).abs() < shape_percent, "{source} {albedo}: {off:?}");
        }
    }
}
