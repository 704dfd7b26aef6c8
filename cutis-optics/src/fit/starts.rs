//! Where to start: a deterministic search for the global minimum.
//!
//! The best variances of these profiles lie nearly on a geometric sequence. All sequences of a coarse grid of first and last
//! variances are judged by their error with best weights (cheap), and the best few are run downhill.

use super::FitError;
use super::levenberg_marquardt::descend;
use super::problem::{Problem, Solution};
use super::weights::SignRule;
use core::cmp::Ordering;

/// Sequences run to the end. Over the 36 measured profiles the first one leads to the global minimum already; the others
/// are there for profiles not foreseen.
const RUNS: usize = 3;
/// First variances tried, in units of 1/k_half², as ln: 0.0025 to 0.6.
const LN_FIRST: [f64; 6] = [-6.0, -4.9, -3.8, -2.7, -1.6, -0.5];
/// Last variances tried, likewise: 0.8 to 1100.
const LN_LAST: [f64; 6] = [-0.2, 1.2, 2.6, 4.0, 5.4, 7.0];

/// The best of several runs.
pub(super) fn best_solution(problem: &Problem, gaussians: usize) -> Result<Solution, FitError> {
    let free = runs(problem, gaussians, SignRule::Free);
    let mut ends: Vec<Solution> = free.into_iter().filter_map(|end| lawful(problem, end)).collect();
    let all_free = ends.iter().all(|end| end.rule == SignRule::Free);
    if !all_free {
        ends.extend(runs(problem, gaussians, problem.sign_rule()));
    }
    ends.into_iter().min_by(by_cost).ok_or(FitError::NoSolution { count: gaussians })
}

/// The best few starts under `rule`, run downhill.
fn runs(problem: &Problem, gaussians: usize, rule: SignRule) -> Vec<Solution> {
    let mut starts: Vec<Solution> =
        sequences(problem, gaussians).iter().filter_map(|s| problem.solve(s, rule)).collect();
    starts.sort_by(by_cost);
    starts.into_iter().take(RUNS).map(|start| descend(problem, start)).collect()
}

/// A minimum found without regard to signs, brought under the rule of the problem. Mostly it keeps it already.
fn lawful(problem: &Problem, end: Solution) -> Option<Solution> {
    if problem.sign_rule() == SignRule::Free || end.is_not_negative() {
        return Some(end);
    }
    let start = problem.solve(&end.ln_variances, problem.sign_rule())?;
    Some(descend(problem, start))
}

fn by_cost(a: &Solution, b: &Solution) -> Ordering {
    a.cost.total_cmp(&b.cost)
}

fn sequences(problem: &Problem, gaussians: usize) -> Vec<Vec<f64>> {
    let unit = -2.0 * problem.grid().k_half_per_mm().ln();
    let place = |i: usize| if gaussians == 1 { 0.5 } else { i as f64 / (gaussians - 1) as f64 };
    let sequence = |first: f64, last: f64| {
        (0..gaussians).map(|i| unit + first + (last - first) * place(i)).collect::<Vec<_>>()
    };
    LN_FIRST.iter().flat_map(|&first| LN_LAST.iter().map(move |&last| sequence(first, last))).collect()
}
