//! Diffusion as heat flow on the atlas: texels exchange light with their eight neighbours by the metric of the surface, across
//! seams as within charts. A Gaussian of variance v is heat after the time v/2.
//!
//! ```text
//! du/dt = 1/sqrt(det g) d_i (sqrt(det g) g^ij d_j u)
//! ```
//!
//! Finite volumes on texels: what flows through a face counts for both sides alike, so that energy stays. East of a texel
//! a11 (u_E - u_C) + a12 (u_NE + u_N - u_SE - u_S)/4 flows, with a of both sides averaged. All times come from one row of
//! exchanges: [`chebyshev`].
//! Not modelled: light that goes straight through the flesh from one fold of the surface to the next.

mod chebyshev;
mod halo;
mod metric;
mod walk;

use crate::passes::atlas::{Atlas, ChartMap};
use crate::passes::blur::Fields;
use crate::passes::diffusion::{Diffused, DiffusionOperator, Level, median_texel_mm};
use crate::progress::Progress;
use chebyshev::coefficients;
use cutis_scene::Object;
use glam::Vec4;
use halo::{Halo, NEIGHBOURS};
use metric::{Metric, metrics};
use rayon::prelude::*;
use std::sync::Arc;

/// Heat flow on the atlas of one object.
#[derive(Debug, Clone)]
pub struct HeatFlow {
    size: usize,
    halo: Halo,
    /// Rates, 1/mm², at which each texel takes from its eight neighbours; nothing where there is no surface.
    rates: Vec<[f32; 8]>,
    fastest_rate: f32,
}

impl HeatFlow {
    /// Of an object in its pose.
    pub fn new(object: &Object, atlas: &Atlas, stretch_mm: &[glam::Vec2]) -> Self {
        let halo = Halo::new(object, atlas);
        let metrics = metrics(object, atlas, median_texel_mm(&atlas.charts, stretch_mm));
        let rates = rates(atlas.size, &halo, &metrics);
        let bound =
            |rates: &[f32; 8]| rates.iter().sum::<f32>() + rates.iter().map(|rate| rate.abs()).sum::<f32>();
        let fastest_rate = rates.par_iter().map(bound).reduce(|| 0.0, f32::max);
        Self { size: atlas.size, halo, rates, fastest_rate }
    }

    /// How fast every texel changes, 1/mm² of its light, by the light around it; texels near edges are asked one by one.
    fn change(&self, light: &[Vec4], change: &mut [Vec4]) {
        let size = self.size;
        let offsets = NEIGHBOURS.map(|to| to.x as isize + to.y as isize * size as isize);
        change.par_chunks_mut(size).enumerate().for_each(|(y, row)| {
            if y == 0 || y + 1 == size {
                return;
            }
            for (x, changed) in row.iter_mut().enumerate().take(size - 1).skip(1) {
                let i = y * size + x;
                let rates = &self.rates[i];
                let mut sum = Vec4::ZERO;
                for k in 0..8 {
                    sum += (light[(i as isize + offsets[k]) as usize] - light[i]) * rates[k];
                }
                *changed = sum;
            }
        });
        let shores: Vec<(u32, Vec4)> = self
            .halo
            .shores
            .par_iter()
            .map(|shore| {
                let own = light[shore.texel as usize];
                let rates = &self.rates[shore.texel as usize];
                let flows = shore.neighbours.iter().zip(rates).map(|(read, &rate)| {
                    read.iter().map(|&(t, w)| (light[t as usize] - own) * w).sum::<Vec4>() * rate
                });
                (shore.texel, flows.sum())
            })
            .collect();
        shores.into_iter().for_each(|(texel, flow)| change[texel as usize] = flow);
    }

    /// One layer after heat has flowed for each time, mm².
    fn flown(&self, layer: &[Vec4], times_mm2: &[f32]) -> Vec<Vec<Vec4>> {
        let rate = self.fastest_rate.max(f32::MIN_POSITIVE);
        let all: Vec<Vec<f32>> =
            times_mm2.iter().map(|&time| coefficients(f64::from(time), f64::from(rate))).collect();
        let scaled = |factor: f32| layer.par_iter().map(|&light| light * factor).collect();
        let mut sums: Vec<Vec<Vec4>> = all.iter().map(|c| scaled(c[0])).collect();
        let mut change = bytemuck::zeroed_vec::<Vec4>(layer.len());
        // T_0 and T_1 of x = 1 - 2 L/λ.
        let mut before = layer.to_vec();
        self.change(&before, &mut change);
        let mut last: Vec<Vec4> =
            before.par_iter().zip(&change).map(|(&light, &change)| light + change * (2.0 / rate)).collect();
        let most = all.iter().map(Vec::len).max().unwrap_or(0);
        for k in 1..most {
            for (sum, c) in sums.iter_mut().zip(&all).filter(|(_, c)| k < c.len()) {
                let c = c[k];
                sum.par_iter_mut().zip(&last).for_each(|(sum, &light)| *sum += light * c);
            }
            if k + 1 < most {
                self.change(&last, &mut change);
                before.par_iter_mut().enumerate().for_each(|(i, before)| {
                    *before = (last[i] + change[i] * (2.0 / rate)) * 2.0 - *before;
                });
                std::mem::swap(&mut before, &mut last);
            }
        }
        sums
    }

    /// What is beyond the edges of charts is what is across the seam, for those who read there.
    fn fill_padding(&self, layer: &mut [Vec4]) {
        let read = |(texel, read): &(u32, halo::Read)| {
            (*texel, read.iter().map(|&(t, w)| layer[t as usize] * w).sum::<Vec4>())
        };
        let filled: Vec<_> = self.halo.padding.par_iter().map(read).collect();
        filled.into_iter().for_each(|(texel, light)| layer[texel as usize] = light);
    }
}

impl DiffusionOperator for HeatFlow {
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused {
        progress.begin("heat flow", variances_mm2.len() as u64);
        let times_mm2: Vec<f32> = variances_mm2.iter().map(|v| 0.5 * v).collect();
        let flown: Vec<Vec<Vec<Vec4>>> =
            fields.layers.iter().map(|layer| self.flown(layer, &times_mm2)).collect();
        let level = |layers| Level { charts: Arc::clone(&charts), layers };
        let mut levels = vec![level(Arc::clone(&fields.layers))];
        // By layer, then by time; levels are the other way round.
        let mut by_layer: Vec<_> = flown.into_iter().map(Vec::into_iter).collect();
        for _ in variances_mm2 {
            let mut layers: Vec<Vec<Vec4>> = by_layer.iter_mut().filter_map(Iterator::next).collect();
            layers.iter_mut().for_each(|layer| self.fill_padding(layer));
            levels.push(level(Arc::new(layers)));
            progress.advance(1);
        }
        Diffused { levels }
    }
}

/// Rates of every own texel.
fn rates(size: usize, halo: &Halo, metrics: &[Metric]) -> Vec<[f32; 8]> {
    let of = |i: usize| {
        if !halo.own[i] {
            return [0.0; 8];
        }
        let last = size as i32 - 1;
        let own = metrics[i];
        // Where a neighbour has no surface under it, the metric of this texel goes on. Along an edge faces are as wide as the
        // cells on both sides, across it as usual: the middle one of both areas and 1.
        let face = |to: usize| {
            let (x, y) = ((i % size) as i32 + NEIGHBOURS[to].x, (i / size) as i32 + NEIGHBOURS[to].y);
            let there = x.clamp(0, last) as usize + y.clamp(0, last) as usize * size;
            let other = metrics[there];
            let a = if other.area_mm2 > 0.0 { 0.5 * (own.a + other.a) } else { own.a };
            let (c, d) = (halo.cover[i], if halo.own[there] { halo.cover[there] } else { 1.0 });
            a * c.min(d).max(c.max(d).min(1.0))
        };
        let [east, north, west, south] = [0, 2, 4, 6].map(face);
        let q = 0.25;
        let flows = [
            east.x + q * (north.y - south.y),
            q * (east.y + north.y),
            north.z + q * (east.y - west.y),
            -q * (north.y + west.y),
            west.x + q * (south.y - north.y),
            q * (west.y + south.y),
            south.z + q * (west.y - east.y),
            -q * (south.y + east.y),
        ];
        flows.map(|flow| flow / (own.area_mm2 * halo.cover[i]))
    };
    (0..size * size).into_par_iter().map(of).collect()
}
