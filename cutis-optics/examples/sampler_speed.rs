//! How many radii one core draws in a second from the dipole of marble, eight at a time: by Newton's steps, from its
//! Gaussians, from a table.
#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use cutis_optics::sample::{DipoleSampler, GaussianSampler, RadialSampler, TabulatedSampler};
use cutis_optics::{Dipole, FitMethod, fit, presets};
use std::hint::black_box;
use std::time::Instant;

/// Radii of one round: numbers and radii stay in the cache.
const RADII: usize = 4096;
/// Rounds that are timed as one; the quickest of [`TRIES`] counts.
const ROUNDS: usize = 500;
const TRIES: usize = 20;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let preset = presets::find("marble")?;
    let media = preset.media().ok_or("marble is a measured medium")?;
    let dipole = Dipole::new(&media[0])?;
    let gaussians = GaussianSampler::new(&fit(&dipole, 6, FitMethod::Energy)?.sum)?;
    let begin = Instant::now();
    let table = TabulatedSampler::new(&dipole, dipole.depth_real_mm())?;
    println!("a table of {} pieces: {:.2} ms", table.pieces(), 1e3 * begin.elapsed().as_secs_f64());
    let newton = DipoleSampler::new(&dipole);
    let samplers: [(&str, &dyn RadialSampler); 3] =
        [("Newton", &newton), ("six Gaussians", &gaussians), ("table", &table)];
    for (name, sampler) in samplers {
        println!("{name}: {:.0} million samples/s", 1e-6 * samples_per_s(sampler));
    }
    Ok(())
}

fn samples_per_s(sampler: &dyn RadialSampler) -> f64 {
    // A multiple of the golden ratio: even, and no neighbour in the same piece of the table.
    let xi: Vec<f32> = (0..RADII).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() as f32).collect();
    let mut radii_mm = vec![0.0; RADII];
    let mut quickest_s = f64::INFINITY;
    for _ in 0..TRIES {
        let begin = Instant::now();
        (0..ROUNDS).for_each(|_| sampler.radii_mm(black_box(&xi), black_box(&mut radii_mm)));
        quickest_s = quickest_s.min(begin.elapsed().as_secs_f64());
    }
    (RADII * ROUNDS) as f64 / quickest_s
}
