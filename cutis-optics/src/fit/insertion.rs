//! Growing a joint fit term by term.
//!
//! Where several channels share variances and no weight may be negative, terms die: their weight is zero in every channel, so
//! no derivative calls them back, and geometric starts end in poor minima. Here each term is put where it lowers the cost
//! most, everything is run downhill, and at the end the least useful term is taken out and put in again elsewhere while that
//! helps.

use super::levenberg_marquardt::descend;
use super::problem::{Problem, Solution};
use super::starts::by_cost;

/// Places tried for a new term, in ln v.
const PLACES: usize = 40;
/// Exchanges at most; each one must pay.
const EXCHANGES_MAX: usize = 12;
/// Terms tried for each exchange, the least useful first.
const EXCHANGE_TRIES: usize = 3;
/// An exchange pays if the cost falls to this part.
const EXCHANGE_GAIN: f64 = 0.999;

/// The best sum of `gaussians` terms found by insertion, under the sign rule of the problem; `None` if nothing is finite.
pub(super) fn grow(problem: &Problem, gaussians: usize) -> Option<Solution> {
    let mut here = inserted(problem, &[])?;
    for _ in 1..gaussians {
        here = inserted(problem, &here.ln_variances)?;
    }
    for _ in 0..EXCHANGES_MAX {
        match exchanged(problem, &here) {
            Some(there) => here = there,
            None => break,
        }
    }
    Some(here)
}

/// One term more, where it helps most, and downhill from there.
fn inserted(problem: &Problem, ln_variances: &[f64]) -> Option<Solution> {
    let (low, high) = problem.start_range_ln_mm2();
    let place = |i: usize| low + (high - low) * i as f64 / (PLACES - 1) as f64;
    let with = |i: usize| {
        let mut all = ln_variances.to_vec();
        all.push(place(i));
        problem.solve(&all, problem.sign_rule())
    };
    (0..PLACES).filter_map(with).min_by(by_cost).map(|start| descend(problem, start))
}

/// The least useful terms, one at a time, moved to a better place; `None` if none of them pays.
fn exchanged(problem: &Problem, here: &Solution) -> Option<Solution> {
    let mut without: Vec<Solution> = (0..here.ln_variances.len())
        .filter_map(|i| {
            let mut rest = here.ln_variances.clone();
            rest.remove(i);
            if rest.is_empty() { None } else { problem.solve(&rest, problem.sign_rule()) }
        })
        .collect();
    without.sort_by(by_cost);
    let moved = without.iter().take(EXCHANGE_TRIES).filter_map(|rest| inserted(problem, &rest.ln_variances));
    moved.into_iter().find(|there| there.cost < EXCHANGE_GAIN * here.cost)
}
