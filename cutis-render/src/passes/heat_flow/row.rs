//! The row of polynomials, two of them in one sweep over the maps.

use super::exchange::Exchange;
use super::sweep::{Part, Sweeper};
use glam::Vec4;
use rayon::prelude::*;
use std::ops::{Add, Sub};

/// What flows.
pub trait Light: Copy + Default + Send + Sync + Add<Output = Self> + Sub<Output = Self> {
    /// So many times as much.
    fn times(self, factor: f32) -> Self;
    /// The inverse of [`Self::times`].
    fn over(self, factor: f32) -> Self;
}

impl Light for Vec4 {
    #[inline]
    fn times(self, factor: f32) -> Self {
        self * factor
    }
    #[inline]
    fn over(self, factor: f32) -> Self {
        self / factor
    }
}

impl Light for f64 {
    #[inline]
    fn times(self, factor: f32) -> Self {
        self * Self::from(factor)
    }
    #[inline]
    fn over(self, factor: f32) -> Self {
        self / Self::from(factor)
    }
}

/// Light after every time, by the coefficients of each.
pub fn flown<L: Light>(exchange: &Exchange, times: &[Vec<f32>], light: &[L]) -> Vec<Vec<L>> {
    let mut sums: Vec<Vec<L>> = times.iter().map(|_| copy(light)).collect();
    let most = times.iter().map(Vec::len).max().unwrap_or(0);
    let mut sweeper = Sweeper::new(exchange, copy(light), copy(light));
    for k in (0..most).step_by(2) {
        let of = |time: &Vec<f32>| [k, k + 1].map(|k| time.get(k).copied().unwrap_or(0.0));
        let parts = sums.iter_mut().zip(times).map(|(map, time)| Part { factors: of(time), map });
        // The first begins the sums, all others add to them.
        let parts = parts.filter(|part| k == 0 || part.factors != [0.0; 2]).collect();
        sweeper.sweep(k == 0, most - k, parts);
    }
    sums
}

/// By all threads: one alone spends longer on pages that were never touched than on light.
fn copy<L: Light>(light: &[L]) -> Vec<L> {
    light.par_iter().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::exchange::runs_of;
    use super::super::rows::Rows;
    use super::*;

    /// Of several bands, the last of which has a single row.
    const SIZE: usize = 129;
    /// A power of two, so that no factor is rounded; and no wave is faster.
    const FASTEST_RATE_PER_MM2: f32 = 64.0;

    /// The same numbers at every run, from 0 to 1.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 1u32;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        }
    }

    /// Links of any strength, with holes in the charts, texels along all edges of the map, and far links between some of them.
    fn random_exchange(number: &mut impl FnMut() -> f32) -> Exchange {
        let count = SIZE * SIZE;
        let areas_mm2: Vec<f32> =
            (0..count).map(|_| if number() < 0.1 { 0.0 } else { 0.5 + number() }).collect();
        let links = (0..count).map(|_| [(); 4].map(|()| number())).collect();
        let mut texel = || (number() * count as f32) as u32;
        let ends: Vec<[u32; 2]> = (0..3000).map(|_| [texel(), texel()]).collect();
        let rows = Rows::new(ends.into_iter().map(|[one, other]| (one, other, number())).collect());
        Exchange {
            size: SIZE,
            links,
            rows,
            inverse_areas_per_mm2: areas_mm2.iter().map(|&a| if a > 0.0 { a.recip() } else { 0.0 }).collect(),
            runs: areas_mm2.chunks(SIZE).map(runs_of).collect(),
            areas_mm2,
            fastest_rate_per_mm2: FASTEST_RATE_PER_MM2,
            limit_per_mm2: FASTEST_RATE_PER_MM2,
        }
    }

    /// Every link on its own: to a texel that has an area, from another, and its strength.
    fn all_links(exchange: &Exchange) -> Vec<(usize, usize, f64)> {
        let mut all = Vec::new();
        let is_inner = |i: usize| (1..SIZE - 1).contains(&(i % SIZE)) && (1..SIZE - 1).contains(&(i / SIZE));
        for (i, links) in exchange.links.iter().enumerate() {
            for (link, step) in links.iter().zip([1, SIZE, SIZE + 1, SIZE - 1]) {
                let pairs = [(i, i + step), (i + step, i)];
                let pairs = pairs.into_iter().filter(|&(to, _)| to < SIZE * SIZE && is_inner(to));
                all.extend(pairs.map(|(to, from)| (to, from, f64::from(*link))));
            }
        }
        for (to, links) in exchange.rows.iter() {
            all.extend(links.iter().map(|&(from, link)| (to, from as usize, f64::from(link))));
        }
        all.retain(|&(to, ..)| exchange.areas_mm2[to] > 0.0);
        all
    }

    /// Polynomial by polynomial; what has no area keeps its light.
    fn flown_slowly(exchange: &Exchange, times: &[Vec<f32>], light: &[f64]) -> Vec<Vec<f64>> {
        let links = all_links(exchange);
        let covered: Vec<usize> = (0..light.len()).filter(|&i| exchange.areas_mm2[i] > 0.0).collect();
        let x = |light: &[f64]| {
            let mut moved = light.to_vec();
            for &(to, from, link) in &links {
                let per_area = f64::from(exchange.inverse_areas_per_mm2[to]);
                moved[to] +=
                    (light[from] - light[to]) * link * per_area * 2.0 / f64::from(FASTEST_RATE_PER_MM2);
            }
            moved
        };
        let mut all = vec![light.to_vec(), x(light)];
        for k in 1..times.iter().map(Vec::len).max().unwrap_or(0) {
            let mut next = x(&all[k]);
            covered.iter().for_each(|&i| next[i] = 2.0 * next[i] - all[k - 1][i]);
            all.push(next);
        }
        let sum_of = |time: &Vec<f32>| {
            let mut sum = light.to_vec();
            let at = |i: usize| time.iter().zip(&all).map(|(&c, map)| f64::from(c) * map[i]).sum();
            covered
                .iter()
                .for_each(|&i| sum[i] = if times.iter().any(|t| !t.is_empty()) { at(i) } else { light[i] });
            sum
        };
        times.iter().map(sum_of).collect()
    }

    /// Two polynomials in one sweep are what every one alone is, for any number of them and of times.
    #[test]
    fn sweeps_agree_with_one_polynomial_after_the_other() {
        let mut number = numbers();
        let exchange = random_exchange(&mut number);
        let light: Vec<f64> = (0..SIZE * SIZE).map(|_| f64::from(number())).collect();
        for counts in [vec![], vec![0], vec![1], vec![2], vec![3], vec![4], vec![1, 2, 2, 5], vec![0, 8, 3]] {
            let times: Vec<Vec<f32>> =
                counts.iter().map(|&count| (0..count).map(|_| number() - 0.3).collect()).collect();
            let found = flown(&exchange, &times, &light);
            let expected = flown_slowly(&exchange, &times, &light);
            assert_eq!(found.len(), expected.len());
            let most = expected.iter().flatten().fold(1.0, |most: f64, light| most.max(light.abs()));
            // Some hundred roundings for each polynomial, of which there are eight at most.
            let tolerance = 1e3 * f64::EPSILON * most;
            for (i, (found, expected)) in found.iter().flatten().zip(expected.iter().flatten()).enumerate() {
                assert!((found - expected).abs() < tolerance, "{counts:?}, {i}: {found} {expected}");
            }
        }
    }
}
