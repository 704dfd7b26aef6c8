//! The fit as a nonlinear least-squares problem in ln v alone: residuals, and their exact derivatives.
//!
//! Rows are the nodes of the frequency grid; each channel is divided by its own norm, so that the sum of squares is the sum
//! of squared relative power errors. Under [`FitMethod::Energy`] one row more, weighed heavily, asks Σ w = R_d.

use super::FitError;
use super::FitMethod;
use super::frequency_grid::FrequencyGrid;
use super::seven_tap::SevenTap;
use super::weights::{LeastSquares, SignRule, dot, solve};
use crate::{GaussianSum, Profile};
use nalgebra::{DMatrix, DVector};

/// Weight of the energy row against a profile of norm 1. The row is missed by 1/ENERGY² = 1e-6 of what the free fit would
/// lose, rescaled away at the end. Not more: its square times rounding (1e-10) is the noise in which the sign rule sees
/// which weights want to grow. Being the *first* row it costs the Householder QR no accuracy (row-wise stability).
const ENERGY: f64 = 1e3;

/// One or more profiles to be fitted over common variances.
pub(super) struct Problem {
    grid: FrequencyGrid,
    method: FitMethod,
    targets: Vec<Target>,
    limits: Option<SevenTap>,
}

struct Target {
    /// The profile at the nodes over its norm, below the energy row.
    b: DVector<f64>,
    /// Entry of every column in the energy row; the channels differ, as their norms do.
    energy_row: f64,
    norm: f64,
    total: f64,
}

/// Variances with their best weights.
pub(super) struct Solution {
    /// Logarithms of the variances in mm².
    pub(super) ln_variances: Vec<f64>,
    /// Sum of squared relative errors over the channels.
    pub(super) cost: f64,
    design: DMatrix<f64>,
    channels: Vec<Channel>,
}

/// Half the gradient and half the second derivatives of the cost by ln v.
pub(super) struct Derivatives {
    pub(super) gradient: DVector<f64>,
    pub(super) curvature: DMatrix<f64>,
    /// JᵀJ with J the derivatives of the residuals: never negative, and so good for a first step.
    pub(super) gauss_newton: DMatrix<f64>,
}

struct Channel {
    squares: LeastSquares,
    residual: Vec<f64>,
}

impl Solution {
    /// Variances in mm², in the order of the weights.
    pub(super) fn variances_mm2(&self) -> Vec<f64> {
        self.ln_variances.iter().map(|v| v.exp()).collect()
    }
}

impl Problem {
    pub(super) fn new(profiles: &[&dyn Profile], method: FitMethod) -> Result<Self, FitError> {
        let grid = FrequencyGrid::covering(profiles)?;
        let targets = profiles.iter().map(|p| Target::new(*p, &grid, method)).collect();
        Ok(Self { grid, method, targets, limits: None })
    }

    /// The same on every n-th node, by another method perhaps.
    pub(super) fn every(&self, n: usize, method: FitMethod) -> Self {
        let targets = self.targets.iter().map(|target| target.every(n, method)).collect();
        Self { grid: self.grid.every(n), method, targets, limits: self.limits }
    }

    /// Smallest and largest ln v (mm²) worth starting from: 0.0025 to 1100 times 1/k_half² where all channels are alike,
    /// wider by what their scales differ.
    pub(super) fn start_range_ln_mm2(&self) -> (f64, f64) {
        let unit = |k: f64| -2.0 * k.ln();
        let (low, high) = self.grid.k_half_range_per_mm();
        (unit(high) - 6.0, unit(low) + 7.0)
    }

    /// Bounds the variances to what seven taps can do, for a shortest mean free path (mm).
    pub(super) fn limit(&mut self, mean_free_path_mm: Option<f64>) {
        self.limits = mean_free_path_mm.map(|l| SevenTap { ln_first_mm2: 2.0 * l.ln() });
    }

    pub(super) fn limits(&self) -> Option<SevenTap> {
        self.limits
    }

    pub(super) fn method(&self) -> FitMethod {
        self.method
    }

    /// The nearest variances (ln) that the grid can tell apart and the limits allow.
    pub(super) fn allowed(&self, ln_variances: &[f64]) -> Vec<f64> {
        let (low, high) = self.grid.variance_range_mm2();
        let seen: Vec<f64> = ln_variances.iter().map(|v| v.clamp(low.ln(), high.ln())).collect();
        match self.limits {
            Some(limits) => limits.allowed(&seen),
            None => seen,
        }
    }

    fn sign_rule(&self) -> SignRule {
        if self.method == FitMethod::Energy { SignRule::NotNegative } else { SignRule::Free }
    }

    /// The best weights for these variances, and what error they leave.
    pub(super) fn solve(&self, ln_variances: &[f64]) -> Option<Solution> {
        let mut design = self.design(ln_variances);
        let mut channels = Vec::with_capacity(self.targets.len());
        for target in &self.targets {
            design.row_mut(0).fill(target.energy_row);
            let squares = solve(&design, &target.b, self.sign_rule())?;
            let residual = residual(&target.b, &design, &squares.weights);
            channels.push(Channel { squares, residual });
        }
        let cost: f64 = channels.iter().map(|c| dot(&c.residual, &c.residual)).sum();
        cost.is_finite().then(|| Solution { ln_variances: ln_variances.to_vec(), cost, design, channels })
    }

    /// Half the gradient and half the second derivatives of the cost by ln v, weights following along.
    ///
    /// The weights are optimal, so their own change counts for nothing in the gradient (envelope theorem): -a'·r w.
    /// The second derivatives are those of the cost in variances and weights together, the weights eliminated. With u = a' w,
    /// u⊥ its part outside the columns in use (A = Q R), d = a'·r and z_i = R⁻ᵀ e_i d_i they come to
    /// u⊥_i·u⊥_j + (Qᵀu_i)·z_j + z_i·(Qᵀu_j) - z_i·z_j, and on the diagonal -w a''·r more. Gauss and Newton's
    /// matrix is u⊥_i·u⊥_j + z_i·z_j; with it alone steps halve the distance at best, with all of it they square it.
    pub(super) fn derivatives(&self, solution: &Solution) -> Derivatives {
        let n = solution.ln_variances.len();
        let none = DMatrix::zeros(n, n);
        let mut sum =
            Derivatives { gradient: DVector::zeros(n), curvature: none.clone(), gauss_newton: none };
        for channel in &solution.channels {
            let changes = self.changes(solution, channel);
            channel.add_derivatives(changes, &mut sum);
        }
        sum
    }

    /// What the columns in use do as their variances change: a' = -v k²/2 a, a'' = (1 - v k²/2) a'.
    fn changes(&self, solution: &Solution, channel: &Channel) -> Changes {
        let active = &channel.squares.active;
        let (rows, exponents) = (self.rows(), self.grid.exponents_per_mm2());
        let mut bent = vec![0.0; rows];
        let nodes = bent[1..].iter_mut().zip(&channel.residual[1..]).zip(exponents);
        nodes.for_each(|((bent, r), exponent)| *bent = r * exponent);
        let mut changes =
            Changes { slopes: DMatrix::zeros(rows, active.len()), pulls: Vec::new(), bends: Vec::new() };
        for (slope, &i) in changes.slopes.as_mut_slice().chunks_exact_mut(rows).zip(active) {
            let v = solution.ln_variances[i].exp();
            // The energy row does not change.
            let nodes = slope[1..].iter_mut().zip(&column(&solution.design, i)[1..]).zip(exponents);
            nodes.for_each(|((slope, entry), exponent)| *slope = v * exponent * entry);
            let pull = dot(slope, &channel.residual);
            changes.pulls.push(pull);
            changes.bends.push(pull + v * dot(slope, &bent));
        }
        changes
    }

    /// Relative RMS power error (eq. 10) of a sum against one channel's profile.
    pub(super) fn relative_error(&self, channel: usize, sum: &GaussianSum) -> f64 {
        let target = &self.targets[channel];
        let mut left = target.b.as_slice()[1..].to_vec();
        let mut gaussian = vec![0.0; self.grid.len()];
        for term in &sum.terms {
            self.grid.fill_gaussian(term.variance_mm2, &mut gaussian);
            subtract(&mut left, &gaussian, term.weight / target.norm);
        }
        dot(&left, &left).sqrt()
    }

    /// Weights of one channel for the profile itself, in the order of the variances; under [`FitMethod::Energy`] their sum
    /// is R_d to rounding.
    pub(super) fn weights(&self, solution: &Solution, channel: usize) -> Vec<f64> {
        let target = &self.targets[channel];
        let weights = solution.channels[channel].squares.weights.iter().map(|w| w * target.norm);
        let sum: f64 = weights.clone().sum();
        let exact = if self.method == FitMethod::Energy { target.total / sum } else { 1.0 };
        weights.map(|w| w * exact).collect()
    }

    fn rows(&self) -> usize {
        self.grid.len() + 1
    }

    /// One column per variance; the energy row, still empty, on top.
    fn design(&self, ln_variances: &[f64]) -> DMatrix<f64> {
        let mut design = DMatrix::zeros(self.rows(), ln_variances.len());
        for (column, ln_v) in design.as_mut_slice().chunks_exact_mut(self.rows()).zip(ln_variances) {
            self.grid.fill_gaussian(ln_v.exp(), &mut column[1..]);
        }
        design
    }
}

impl Target {
    fn new(profile: &dyn Profile, grid: &FrequencyGrid, method: FitMethod) -> Self {
        let nodes = grid.k_per_mm().iter().zip(grid.root_weights());
        let weighed = nodes.map(|(&k, weight)| weight * profile.spectrum(k));
        let mut b = DVector::from_iterator(grid.len() + 1, core::iter::once(0.0).chain(weighed));
        let (norm, total) = (b.norm(), profile.total());
        let energy_row = if method == FitMethod::Energy { ENERGY * norm / total } else { 0.0 };
        b /= norm;
        b[0] = energy_row * total / norm;
        Self { b, energy_row, norm, total }
    }
}

impl Target {
    /// On every n-th node, weighed as they are there.
    fn every(&self, n: usize, method: FitMethod) -> Self {
        let share = if method == FitMethod::Energy { 1.0 } else { 0.0 };
        let nodes = self.b.iter().skip(1).step_by(n).map(|b| b * (n as f64).sqrt());
        let rows: Vec<f64> = core::iter::once(share * self.b[0]).chain(nodes).collect();
        Self { b: DVector::from_vec(rows), energy_row: share * self.energy_row, ..*self }
    }
}

/// What a channel's columns in use do as their variances change, in the order of those columns.
struct Changes {
    /// a' (rows × active).
    slopes: DMatrix<f64>,
    /// a'·r.
    pulls: Vec<f64>,
    /// a''·r.
    bends: Vec<f64>,
}

impl Channel {
    /// Adds this channel's part to the derivatives; columns without weight have none.
    fn add_derivatives(&self, changes: Changes, sum: &mut Derivatives) {
        let LeastSquares { weights, active, r, .. } = &self.squares;
        let Changes { slopes: mut turned, pulls, bends } = changes;
        let n = active.len();
        let mut back = DMatrix::zeros(n, n);
        for (place, &i) in active.iter().enumerate() {
            sum.gradient[i] -= weights[i] * pulls[place];
            sum.curvature[(i, i)] -= weights[i] * bends[place];
            back[(place, place)] = pulls[place];
            turned.column_mut(place).scale_mut(weights[i]);
        }
        // The triangle was inverted once already to get the weights, so it is regular.
        r.tr_solve_upper_triangular_mut(&mut back);
        turned.as_mut_slice().chunks_exact_mut(self.residual.len()).for_each(|u| self.squares.turn(u));
        for (place, &i) in active.iter().enumerate() {
            for (other, &j) in active.iter().enumerate() {
                let (inside_i, outside_i) = column(&turned, place).split_at(n);
                let (inside_j, outside_j) = column(&turned, other).split_at(n);
                let (back_i, back_j) = (column(&back, place), column(&back, other));
                let (outside, back) = (dot(outside_i, outside_j), dot(back_i, back_j));
                sum.gauss_newton[(i, j)] += outside + back;
                sum.curvature[(i, j)] += outside - back + dot(inside_i, back_j) + dot(back_i, inside_j);
            }
        }
    }
}

fn column(matrix: &DMatrix<f64>, i: usize) -> &[f64] {
    &matrix.as_slice()[i * matrix.nrows()..(i + 1) * matrix.nrows()]
}

/// b - A w.
fn residual(b: &DVector<f64>, a: &DMatrix<f64>, weights: &[f64]) -> Vec<f64> {
    let mut left = b.as_slice().to_vec();
    weights.iter().enumerate().for_each(|(i, weight)| subtract(&mut left, column(a, i), *weight));
    left
}

fn subtract(left: &mut [f64], column: &[f64], weight: f64) {
    left.iter_mut().zip(column).for_each(|(left, entry)| *left -= weight * entry);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{Dipole, Medium};

    #[test]
    fn derivatives_meet_central_differences_with_the_right_slope() {
        let dipole = |a, s| Dipole::new(&Medium::new(a, s, 1.3).unwrap()).unwrap();
        let (red, blue) = (dipole(0.032, 0.74), dipole(0.48, 1.01));
        for method in [FitMethod::Optimal, FitMethod::Energy] {
            let problem = Problem::new(&[&red, &blue], method).unwrap();
            let at = [-2.5, -0.9, 0.4, 2.0];
            let solved = |i: usize, by: f64| {
                let mut x = at;
                x[i] += by;
                problem.solve(&x).unwrap()
            };
            let exact = problem.derivatives(&problem.solve(&at).unwrap());
            let errors = |step: f64| {
                let difference = |i| 0.5 * (solved(i, step).cost - solved(i, -step).cost) / (2.0 * step);
                let gradient = DVector::from_iterator(4, (0..4).map(difference));
                let column = |i| {
                    let gradient = |by| problem.derivatives(&solved(i, by)).gradient;
                    (gradient(step) - gradient(-step)) / (2.0 * step)
                };
                let curvature = DMatrix::from_columns(&(0..4).map(column).collect::<Vec<_>>());
                [
                    (gradient - &exact.gradient).norm() / exact.gradient.norm(),
                    (curvature - &exact.curvature).norm() / exact.curvature.norm(),
                ]
            };
            let (coarse, fine) = (errors(1e-2), errors(1e-3));
            for (coarse, fine) in coarse.into_iter().zip(fine) {
                // Central differences err by step²: 100 to 1.
                assert!(coarse < 2e-3, "{method:?} {coarse}");
                assert!((coarse / fine - 100.0).abs() < 5.0, "{method:?} {coarse} {fine}");
            }
        }
    }

    #[test]
    fn energy_row_leaves_next_to_nothing_for_the_final_scaling() {
        let dipole = Dipole::new(&Medium::new(0.0041, 2.62, 1.5).unwrap()).unwrap();
        let problem = Problem::new(&[&dipole], FitMethod::Energy).unwrap();
        let solution = problem.solve(&[-3.3, -1.9, -0.1, 1.9]).unwrap();
        let raw: f64 = solution.channels[0].squares.weights.iter().sum::<f64>() * problem.targets[0].norm;
        // Free weights lose 5 %; of that 1/ENERGY² is left, and the columns are of norm 1 to 10.
        assert!((raw / dipole.total() - 1.0).abs() < 1e-6, "{raw} against {}", dipole.total());
    }

    #[test]
    fn energy_row_is_kept_and_free_weights_lose_energy() {
        let dipole = Dipole::new(&Medium::new(0.0041, 2.62, 1.5).unwrap()).unwrap();
        let sum = |method| {
            let problem = Problem::new(&[&dipole], method).unwrap();
            let solution = problem.solve(&[-3.3, -1.9, -0.1, 1.9]).unwrap();
            problem.weights(&solution, 0).iter().sum::<f64>()
        };
        assert!((sum(FitMethod::Energy) / dipole.total() - 1.0).abs() < 8.0 * f64::EPSILON);
        assert!(sum(FitMethod::Optimal) < 0.97 * dipole.total());
    }
}
