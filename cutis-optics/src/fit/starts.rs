//! Where to start: a deterministic search for the global minimum.
//!
//! The best variances of these profiles lie nearly on a geometric sequence. All sequences of a coarse grid of first and last
//! variances are judged by their error with best weights (cheap), and the best few are run downhill.

use super::levenberg_marquardt::{GAIN_LAST, descend};
use super::problem::{Problem, Solution};
use super::{FitError, FitMethod};
use core::cmp::Ordering;

/// Sequences run to the end. Over the measured profiles with 4, 6 and 8 terms the first one leads to the global minimum; …
const RUNS: usize = 1;
/// … but past this many terms poor minima are near, …
const EASY: usize = 6;
/// … and a few more runs are tried.
const RUNS_PAST_EASY: usize = 3;
/// How far the first variance of a sequence may lie above the least ln v worth trying, …
const LN_FIRST: [f64; 2] = [0.6, 4.2];
/// … and the last one below the largest.
const LN_LAST: [f64; 2] = [1.0, 5.8];
/// First and last variances tried, …
const PLACES: usize = 3;
/// … and where none of these has a solution, which has been seen where scales differ by seventeen decades.
const MANY_PLACES: usize = 8;

/// Starts are judged on every fourth node, …
const ROUGH: usize = 4;
/// … run downhill on every second while that is easy, and to the end on all.
const COARSE: usize = 2;
/// Part of the cost that a step on the coarse nodes promises when it is the last: the minimum lies elsewhere there.
const GAIN_COARSE: f64 = 1e-2;

/// The best of several runs.
pub(super) fn best_solution(problem: &Problem, gaussians: usize) -> Result<Solution, FitError> {
    let (runs, nodes) = if gaussians > EASY { (RUNS_PAST_EASY, 1) } else { (RUNS, COARSE) };
    let (rough, coarse) = (problem.every(ROUGH, FitMethod::Optimal), problem.every(nodes, problem.method()));
    let judged = |places| {
        let sequences = sequences(problem, gaussians, places);
        let mut starts: Vec<Solution> =
            sequences.iter().filter_map(|s| rough.solve(&problem.allowed(s))).collect();
        starts.sort_by(by_cost);
        starts
    };
    for places in [PLACES, MANY_PLACES] {
        let starts = judged(places);
        let starts = starts.iter().filter_map(|start| coarse.solve(&start.ln_variances)).take(runs);
        let near = starts.map(|start| descend(&coarse, start, GAIN_COARSE));
        let near = near.filter_map(|near| problem.solve(&near.ln_variances));
        if let Some(best) = near.map(|near| descend(problem, near, GAIN_LAST)).min_by(by_cost) {
            return Ok(best);
        }
    }
    Err(FitError::NoSolution { count: gaussians })
}

fn by_cost(a: &Solution, b: &Solution) -> Ordering {
    a.cost.total_cmp(&b.cost)
}

fn sequences(problem: &Problem, gaussians: usize, places: usize) -> Vec<Vec<f64>> {
    let (low, high) = problem.start_range_ln_mm2();
    let share = |i: usize, count: usize| if count == 1 { 0.5 } else { i as f64 / (count - 1) as f64 };
    let between = |[from, to]: [f64; 2], part: f64| from + (to - from) * part;
    let sequence = |i: usize, j: usize| {
        let first = low + between(LN_FIRST, share(i, places));
        let last = high - between(LN_LAST, share(j, places));
        (0..gaussians).map(|n| between([first, last], share(n, gaussians))).collect::<Vec<_>>()
    };
    (0..places).flat_map(|i| (0..places).map(move |j| (i, j))).map(|(i, j)| sequence(i, j)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Dipole;
    use crate::presets::measured_media::MEASURED_MEDIA;

    /// The obvious global search: many runs from scattered starts, without the screening.
    fn best_of_scattered_starts(problem: &Problem, gaussians: usize, runs: u64) -> f64 {
        let (low, high) = problem.start_range_ln_mm2();
        // Multiplicative congruence of Knuth (MMIX): only the scatter matters.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut best = f64::INFINITY;
        for _ in 0..runs {
            let ln_variances: Vec<f64> = (0..gaussians).map(|_| low + (high - low) * uniform()).collect();
            if let Some(start) = problem.solve(&ln_variances) {
                best = best.min(descend(problem, start, GAIN_LAST).cost);
            }
        }
        best
    }

    #[test]
    fn scattered_starts_find_nothing_better() {
        for (name, media) in MEASURED_MEDIA {
            let d = media.map(|m| Dipole::new(&m).unwrap());
            let alone = Problem::new(&[&d[1]], FitMethod::Optimal).unwrap();
            let joint = Problem::new(&[&d[0], &d[1], &d[2]], FitMethod::Energy).unwrap();
            for (problem, gaussians) in [(alone, 4), (joint, 6)] {
                let ours = best_solution(&problem, gaussians).unwrap().cost;
                let theirs = best_of_scattered_starts(&problem, gaussians, 20);
                // Runs that end in one minimum stop within 1e-9 of it; 1e-6 leaves room for slow ones.
                assert!(ours < theirs * (1.0 + 1e-6), "{name} {gaussians}: {ours:e} {theirs:e}");
            }
        }
    }
}
