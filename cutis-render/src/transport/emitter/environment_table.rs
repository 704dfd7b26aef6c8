//! Directions drawn as bright as the environment is there.

use super::{Draw, Seen};
use crate::transport::random::Random;
use cutis_scene::Environment;
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::{PI, TAU};

/// Largest number of columns of the table that environments are drawn from.
const COLUMNS_MAX: usize = 512;
/// Share of the environment that is drawn evenly, so that nothing bright between two entries is found rarely.
const EVEN_SHARE: f64 = 0.05;

/// A table to draw directions from as bright as the environment is there.
pub(super) struct EnvironmentTable<'a> {
    environment: &'a Environment,
    columns: usize,
    rows: usize,
    /// Sums over the cells before each one, of brightness times solid angle; one more than there are cells.
    sums: Vec<f64>,
    /// Mean over channels of a quarter of what all directions together shine, as a surface on a ball gets it, W/m².
    pub(super) irradiance_w_per_m2: f64,
}

impl<'a> EnvironmentTable<'a> {
    /// Measures the environment.
    pub(super) fn new(environment: &'a Environment) -> Self {
        let (width, height) = (environment.map.width() as usize, environment.map.height() as usize);
        let columns = width.min(COLUMNS_MAX);
        let rows = (height * columns / width).max(1);
        let cell = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            let mut sum = 0.0f64;
            // At corners, sides and middle: what lies between is interpolated from texels at least so close.
            let steps = (width / columns).max(1) + 1;
            for (a, b) in (0..=steps).flat_map(|a| (0..=steps).map(move |b| (a, b))) {
                let place = |at: usize, step: usize, count: usize| {
                    (at as f32 + step as f32 / steps as f32) / count as f32
                };
                let uv = Vec2::new(place(x, a, columns), place(y, b, rows));
                let radiance = environment.radiance(environment.dir(uv));
                sum += f64::from(radiance.element_sum()) / 3.0;
            }
            sum / ((steps + 1) * (steps + 1)) as f64
        };
        let mut weights: Vec<f64> = (0..columns * rows).map(cell).collect();
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = weight.max(0.0) * cell_sr(i / columns, rows, columns);
        }
        let whole: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        for (i, weight) in weights.iter().enumerate() {
            // A black one is drawn evenly.
            let even = cell_sr(i / columns, rows, columns) / (4.0 * PI) * whole.max(1e-30);
            sum += (1.0 - EVEN_SHARE) * weight + EVEN_SHARE * even;
            sums.push(sum);
        }
        Self { environment, columns, rows, sums, irradiance_w_per_m2: whole / 4.0 }
    }

    /// A direction, as likely as it is bright.
    pub(super) fn draw(&self, random: &mut Random) -> Draw {
        let wanted = random.unit() * self.sums[self.columns * self.rows];
        let i = self.sums.partition_point(|&sum| sum <= wanted).clamp(1, self.columns * self.rows) - 1;
        let column = (i % self.columns) as f64 + random.unit();
        let [top, bottom] = cosines(i / self.columns, self.rows);
        let y = top + (bottom - top) * random.unit();
        let v = y.acos() / PI;
        let uv = DVec2::new(column / self.columns as f64, v).as_vec2();
        let dir = self.environment.dir(uv).as_dvec3().normalize();
        let seen = self.see(dir);
        Draw {
            dir,
            distance_mm: f64::INFINITY,
            light: seen.radiance / seen.density_per_sr,
            density_per_sr: Some(seen.density_per_sr),
        }
    }

    /// What lies in a direction.
    pub(super) fn see(&self, dir: DVec3) -> Seen {
        let uv = self.environment.uv(dir.as_vec3());
        let place = |share: f32, count: usize| ((share * count as f32) as usize).min(count - 1);
        let row = place(uv.y, self.rows);
        let i = row * self.columns + place(uv.x, self.columns);
        let probability = (self.sums[i + 1] - self.sums[i]) / self.sums[self.columns * self.rows];
        Seen {
            radiance: self.environment.radiance(dir.as_vec3()).as_dvec3(),
            distance_mm: f64::INFINITY,
            density_per_sr: probability / cell_sr(row, self.rows, self.columns),
        }
    }
}

/// Cosines of the polar angles between which a row lies.
fn cosines(row: usize, rows: usize) -> [f64; 2] {
    [row, row + 1].map(|r| (PI * r as f64 / rows as f64).cos())
}

/// Solid angle of a cell of the table, sr.
fn cell_sr(row: usize, rows: usize, columns: usize) -> f64 {
    let [top, bottom] = cosines(row, rows);
    TAU * (top - bottom) / columns as f64
}
