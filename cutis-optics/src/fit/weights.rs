//! Linear least squares for the weights of given variances, free or not negative.

use nalgebra::{DMatrix, DVector};

/// Sign rule for the weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SignRule {
    /// Any sign.
    Free,
    /// Zero or more (Lawson & Hanson 1974, chapter 23, algorithm NNLS).
    NotNegative,
}

/// Weights that minimise |b - A w|, and the reflections that turn the columns in use into a triangle.
pub(super) struct LeastSquares {
    /// One weight per column; 0 for columns not in use.
    pub(super) weights: Vec<f64>,
    /// Indices of the columns in use.
    pub(super) active: Vec<usize>,
    /// Householder's reflectors of those columns (rows × active).
    reflectors: DMatrix<f64>,
    /// Triangle with A_active = Q R.
    pub(super) r: DMatrix<f64>,
    /// b, turned: Qᵀb first, then what no column reaches.
    turned: DVector<f64>,
}

/// Solves for the weights; `None` when a number is not finite or, with free signs, when columns coincide to rounding.
pub(super) fn solve(a: &DMatrix<f64>, b: &DVector<f64>, rule: SignRule) -> Option<LeastSquares> {
    let all: Vec<usize> = (0..a.ncols()).collect();
    let free = solve_on(a, b, &all);
    if rule == SignRule::Free || free.as_ref().is_some_and(|free| free.weights.iter().all(|&w| w >= 0.0)) {
        return free;
    }
    // All the algorithm asks of A and b is in the small triangle; where columns coincide there is none, and A itself serves.
    let mut active = match free {
        Some(free) => not_negative_set(&free.r, &free.turned.rows(0, free.r.nrows()).into_owned())?,
        None => not_negative_set(a, b)?,
    };
    loop {
        let solved = solve_on(a, b, &active)?;
        // Rounding can leave a weight of -1e-16 where the small triangle had +1e-16.
        active.retain(|&i| solved.weights[i] > 0.0);
        if active.len() == solved.active.len() {
            return Some(solved);
        }
    }
}

fn solve_on(a: &DMatrix<f64>, b: &DVector<f64>, active: &[usize]) -> Option<LeastSquares> {
    let (reflectors, r) = triangle(a, active);
    let mut turned = b.clone();
    turn(&reflectors, turned.as_mut_slice());
    let w = r.solve_upper_triangular(&turned.rows(0, r.nrows()))?;
    let mut weights = vec![0.0; a.ncols()];
    for (&column, &weight) in active.iter().zip(w.iter()) {
        weights[column] = weight;
    }
    let finite = weights.iter().all(|w| w.is_finite());
    finite.then_some(LeastSquares { weights, active: active.to_vec(), reflectors, r, turned })
}

impl LeastSquares {
    /// Turns a column as those in use were turned: its part along each of them comes first (Qᵀx), then what lies outside.
    pub(super) fn turn(&self, x: &mut [f64]) {
        turn(&self.reflectors, x);
    }
}

fn turn(reflectors: &DMatrix<f64>, x: &mut [f64]) {
    for (j, v) in reflectors.as_slice().chunks_exact(x.len()).enumerate() {
        reflect(&v[j..], &mut x[j..]);
    }
}

/// Householder's reflectors (each of length sqrt 2, so that they need no factor) of some columns, and their triangle. The
/// first row may be heavier than all others: it comes first, so it costs no accuracy. As nalgebra's, but on whole columns at
/// a time, which suits matrices as narrow as these.
fn triangle(a: &DMatrix<f64>, active: &[usize]) -> (DMatrix<f64>, DMatrix<f64>) {
    let (rows, n) = (a.nrows(), active.len().min(a.nrows()));
    let mut reflectors = a.select_columns(&active[..n]);
    let mut r = DMatrix::zeros(n, n);
    for j in 0..n {
        let (done, rest) = reflectors.as_mut_slice().split_at_mut((j + 1) * rows);
        let v = &mut done[j * rows + j..];
        let diagonal = -dot(v, v).sqrt().copysign(v[0]);
        r[(j, j)] = diagonal;
        v[0] -= diagonal;
        let length2 = dot(v, v);
        // A column of zeros needs no reflection.
        let scale = if length2 > 0.0 { (2.0 / length2).sqrt() } else { 0.0 };
        v.iter_mut().for_each(|x| *x *= scale);
        for (i, column) in rest.chunks_exact_mut(rows).enumerate() {
            reflect(v, &mut column[j..]);
            r[(j, j + 1 + i)] = column[j];
        }
    }
    (reflectors, r)
}

/// x - v (v·x).
fn reflect(v: &[f64], x: &mut [f64]) {
    let along = dot(v, x);
    x.iter_mut().zip(v).for_each(|(x, v)| *x -= along * v);
}

/// Eight sums at a time: additions of one sum would wait for each other.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SUMS: usize = 8;
    let (many_a, many_b) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let rest: f64 = many_a.remainder().iter().zip(many_b.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; SUMS];
    for (x, y) in many_a.zip(many_b) {
        for lane in 0..SUMS {
            sums[lane] += x[lane] * y[lane];
        }
    }
    rest + sums.iter().sum::<f64>()
}

/// The columns with positive weight at the constrained optimum.
fn not_negative_set(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<Vec<usize>> {
    let n = a.ncols();
    // Columns of length 1: else one of 1e10 would call the rounding of its own gradient larger than that of all others.
    let a = &unit_columns(a);
    let (mut active, mut w): (Vec<usize>, _) = (Vec::new(), DVector::zeros(n));
    // Columns that coincide with one in use.
    let mut barred = vec![false; n];
    // Lawson & Hanson's own limit is 3n; some random matrices need more.
    for _ in 0..10 * n {
        let gradient = a.tr_mul(&(b - a * &w));
        let waiting = (0..n).filter(|i| !active.contains(i) && !barred[*i]);
        let next = waiting.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        // Rounding of n products of size |a||b|: below it a gradient is not a direction.
        let noise = n as f64 * f64::EPSILON * a.norm() * b.norm();
        let Some(next) = next.filter(|&i| gradient[i] > noise) else { break };
        let before = (active.clone(), w.clone());
        active.push(next);
        if retreat_until_not_negative(a, b, &mut active, &mut w).is_none() {
            (active, w) = before;
            barred[next] = true;
        } else {
            // Among other columns one that was barred may help.
            barred.fill(false);
        }
    }
    active.sort_unstable();
    (!active.is_empty()).then_some(active)
}

/// The same columns at length 1; those of zeros stay.
fn unit_columns(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut scaled = a.clone();
    for mut column in scaled.column_iter_mut() {
        let length = column.norm();
        if length > 0.0 {
            column /= length;
        }
    }
    scaled
}

/// The inner loop of NNLS: walk towards the free optimum of the active columns, dropping each one that hits zero.
fn retreat_until_not_negative(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    active: &mut Vec<usize>,
    w: &mut DVector<f64>,
) -> Option<()> {
    let entered = active.last().copied();
    while !active.is_empty() {
        let goal = solve_on(a, b, active)?.weights;
        // 0/0: a column that entered at 0 and wants to leave at once.
        let step_to_zero = |i: usize| if w[i] > 0.0 { w[i] / (w[i] - goal[i]) } else { 0.0 };
        let falling = active.iter().copied().filter(|&i| goal[i] <= 0.0);
        let first = falling.map(|i| (i, step_to_zero(i))).min_by(|a, b| a.1.total_cmp(&b.1));
        let step = first.map_or(1.0, |(_, step)| step);
        for &i in active.iter() {
            w[i] += step * (goal[i] - w[i]);
        }
        let Some((first, _)) = first else { return Some(()) };
        if Some(first) == entered && step == 0.0 {
            return None;
        }
        // The first to fall is at zero, whatever rounding has left of it; others may be there, too.
        let leaves = |i: usize| i == first || goal[i] <= 0.0 && w[i] <= f64::EPSILON * goal[i].abs();
        for i in active.iter().copied().filter(|&i| leaves(i)).collect::<Vec<_>>() {
            w[i] = 0.0;
        }
        active.retain(|&i| w[i] > 0.0 || goal[i] > 0.0);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use proptest::prelude::*;

    fn cost(a: &DMatrix<f64>, b: &DVector<f64>, w: &[f64]) -> f64 {
        (b - a * DVector::from_column_slice(w)).norm()
    }

    /// The obvious way: try every subset of columns.
    fn best_subset(a: &DMatrix<f64>, b: &DVector<f64>) -> f64 {
        let subsets = (1_usize..1 << a.ncols())
            .map(|bits| (0..a.ncols()).filter(|i| bits >> i & 1 == 1).collect::<Vec<_>>());
        let solved = subsets.filter_map(|s| solve_on(a, b, &s));
        solved
            .filter(|s| s.weights.iter().all(|&w| w >= 0.0))
            .map(|s| cost(a, b, &s.weights))
            .fold(b.norm(), f64::min)
    }

    #[test]
    fn a_column_given_twice_is_used_once() {
        let a = DMatrix::from_column_slice(3, 3, &[1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let b = DVector::from_column_slice(&[2.0, 4.0, 1.0]);
        let s = solve(&a, &b, SignRule::NotNegative).unwrap();
        // A few roundings of numbers of order 2.
        assert!((s.weights.iter().sum::<f64>() - 2.0).abs() < 1e-14, "{:?}", s.weights);
        assert_eq!(s.active.len(), 1);
        assert!(solve(&a, &b, SignRule::Free).is_none());
    }

    proptest! {
        // Many: a column that rounding kept from leaving made rare fits too poor.
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn not_negative_meets_the_best_subset(numbers in prop::collection::vec(-1.0..1.0_f64, 48)) {
            let a = DMatrix::from_column_slice(8, 5, &numbers[..40]);
            let b = DVector::from_column_slice(&numbers[40..]);
            // No column helps at all: the set is empty and there is no fit.
            if let Some(s) = solve(&a, &b, SignRule::NotNegative) {
                prop_assert!(s.weights.iter().all(|&w| w >= 0.0));
                // Random 8 × 5 matrices: condition numbers to 1e4, so 1e-12 relative; the cost errs by its square.
                prop_assert!(cost(&a, &b, &s.weights) <= best_subset(&a, &b) * (1.0 + 1e-9));
            } else {
                prop_assert!(best_subset(&a, &b) >= b.norm() * (1.0 - 1e-9));
            }
        }

        /// Weights that are truly zero come out as plus or minus rounding; a minus must not get through.
        #[test]
        fn weights_of_zero_never_come_out_negative(numbers in prop::collection::vec(-1.0..1.0_f64, 40)) {
            let a = DMatrix::from_column_slice(8, 5, &numbers);
            let b = &a * DVector::from_column_slice(&[1.0, 0.0, 2.0, 0.0, 3.0]);
            let s = solve(&a, &b, SignRule::NotNegative).unwrap();
            prop_assert!(s.weights.iter().all(|&w| w >= 0.0), "{:?}", s.weights);
        }

        #[test]
        fn free_residual_is_orthogonal_to_the_columns(numbers in prop::collection::vec(-1.0..1.0_f64, 48)) {
            let a = DMatrix::from_column_slice(8, 5, &numbers[..40]);
            let b = DVector::from_column_slice(&numbers[40..]);
            let s = solve(&a, &b, SignRule::Free).unwrap();
            let left = a.tr_mul(&(&b - &a * DVector::from_vec(s.weights.clone())));
            // Backward stable: 40 roundings of numbers of size |a| (|b| + |a||w|).
            let w = DVector::from_vec(s.weights).norm();
            prop_assert!(left.norm() < 40.0 * f64::EPSILON * a.norm() * (b.norm() + a.norm() * w));
        }
    }
}
