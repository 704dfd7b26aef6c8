//! Radiant exitance of the scanned head in the medium skin1, lit from the front: how long until a texel of 512 x 512 is known to
//! 2 %, from the lamp and from the texels, and what a second thread brings, beside what it brings to sums that share nothing.
//! Runs of minutes, each taken once: no criterion.

#![allow(clippy::print_stdout, reason = "what it measures is its result")]

use cutis_render::technique::truth::{ExitanceMap, Start};
use cutis_render::transport::path::Transport;
use cutis_render::transport::random::Random;
use cutis_render::{Settings, Silent};
use cutis_scene::validation::SCENES;
use std::time::Instant;

/// Side of the map, texels, and samples of each.
const SIZE: u32 = 512;
const SAMPLES: u32 = 16;
/// Noise that is wanted.
const WANTED: f64 = 0.02;
/// The smaller run by which threads are compared.
const SMALL_SIZE: u32 = 256;

/// A map, and the seconds it took on so many threads.
fn timed(transport: &Transport, start: Start, size: u32, threads: usize) -> (ExitanceMap, f64) {
    let settings = Settings { irradiance_size: size, samples_per_pixel: SAMPLES, ..Settings::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are at hand");
    let begin = Instant::now();
    let map = pool.install(|| ExitanceMap::starting(start, transport, &settings, &Silent));
    let map = map.expect("no state is kept");
    (map, begin.elapsed().as_secs_f64())
}

/// Seconds that two sums of random numbers take on so many threads: all that a second thread can bring on this machine.
fn sums(threads: usize) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are at hand");
    let sum = |stream: u64| {
        let mut random = Random::new(1, stream, 0);
        (0..400_000_000).map(|_| random.unit()).sum::<f64>()
    };
    let begin = Instant::now();
    let (a, b) = pool.install(|| rayon::join(|| sum(1), || sum(2)));
    assert!((a / b - 1.0).abs() < 0.01, "they are random: {a} and {b}");
    begin.elapsed().as_secs_f64()
}

fn main() {
    let head = SCENES.iter().find(|scene| scene.name == "head-front").expect("it is one of them");
    if let Some(missing) = head.missing() {
        println!("skipped: {missing}");
        return;
    }
    let scene = head.make().expect("the head can be read");
    let transport = Transport::new(&scene, 1).expect("the head can be simulated");
    let threads = rayon::current_num_threads();
    let [one, two] = [1, 2].map(sums);
    println!("sums: {one:.2} s on 1 thread, {two:.2} s on 2: ratio {:.2}", one / two);
    for start in [Start::Light, Start::Texel] {
        let (map, seconds) = timed(&transport, start, SIZE, threads);
        let noise = map.noise();
        // Noise falls as the root of the time.
        let hours = seconds * (noise / WANTED).powi(2) / 3600.0;
        println!(
            "from each {start:?}: {SIZE} x {SIZE}, {SAMPLES} samples, {threads} threads: {seconds:.1} s, median noise {:.1} %; \
             by the square of the noise, {:.0} % after {hours:.1} h",
            100.0 * noise,
            100.0 * WANTED
        );
        let [one, two] = [1, 2].map(|threads| timed(&transport, start, SMALL_SIZE, threads).1);
        println!("from each {start:?}: {one:.2} s on 1 thread, {two:.2} s on 2: ratio {:.2}", one / two);
    }
}
