//! Flat patches with a known mapping, and what diffusion must make of one lit texel of them.

#![allow(dead_code, reason = "every test binary uses its own part")]

use cutis_render::Silent;
use cutis_render::passes::atlas::{Atlas, NO_CHART};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::validation::shapes;
use cutis_scene::{Material, Mesh, Object};
use glam::Vec4;
use std::sync::Arc;

/// How the two axes of the texture lie on the plane: texel coordinate to millimetres, growing.
pub type AxisMap = fn(f64) -> f64;

/// A flat patch of `cells`² quads over the whole texture but for a margin of 4 texels.
pub fn patch(size: usize, cells: u32, along_u: AxisMap, along_v: AxisMap) -> Object {
    let texels = size as f64;
    let mesh = shapes::patch(cells, 4.0 / texels, |u| along_u(u * texels), |v| along_v(v * texels));
    Object::new("patch", mesh, Material::default())
}

/// The patch's atlas and what the operator makes of a map on it.
pub fn diffuse(
    object: &Object,
    size: usize,
    variances_mm2: &[f32],
    map: impl Fn(usize) -> Vec4,
) -> (Atlas, Diffused) {
    let atlas = Atlas::new(object, size);
    let stretch_mm = stretch_mm_per_texel(object, &atlas);
    let lit = |i: usize| if atlas.charts.chart[i] == NO_CHART { Vec4::ZERO } else { map(i) };
    let fields = Fields::new(vec![(0..size * size).map(lit).collect()], stretch_mm);
    let diffused = Separable.diffuse(Arc::clone(&atlas.charts), fields, variances_mm2, &Silent);
    (atlas, diffused)
}

/// Share of a Gaussian around `x_mm` that falls between two places.
pub fn between(x_mm: f64, from_mm: f64, to_mm: f64, variance_mm2: f64) -> f64 {
    let below = |edge: f64| 0.5 * libm::erfc((x_mm - edge) / (2.0 * variance_mm2).sqrt());
    below(to_mm) - below(from_mm)
}

/// What one lit texel becomes: the kernel's sum of Gaussians over the texel's footprint, at the centre of every texel.
/// The footprint is exact, whatever the mapping.
pub fn expected(size: usize, lit: [usize; 2], maps: [AxisMap; 2], terms: &[(f64, f64)]) -> Vec<f64> {
    let axis = |a: usize, variance: f64| -> Vec<f64> {
        let map = maps[a];
        let (from, to) = (map(lit[a] as f64), map(lit[a] as f64 + 1.0));
        (0..size).map(|i| between(map(i as f64 + 0.5), from, to, variance)).collect()
    };
    let mut sum = vec![0.0; size * size];
    for &(weight, variance) in terms {
        let (u, v) = (axis(0, variance), axis(1, variance));
        for (i, value) in sum.iter_mut().enumerate() {
            *value += weight * u[i % size] * v[i / size];
        }
    }
    sum
}

/// sqrt(Σ area (a - b)²) / sqrt(Σ area b²): the relative RMS power error of d'Eon et al. 2007, equation 10, on the plane.
pub fn relative_rms_power_error(got: &[f64], expected: &[f64], area: impl Fn(usize) -> f64) -> f64 {
    let sum = |f: &dyn Fn(usize) -> f64| (0..got.len()).map(|i| area(i) * f(i)).sum::<f64>();
    (sum(&|i| (got[i] - expected[i]).powi(2)) / sum(&|i| expected[i].powi(2))).sqrt()
}

/// Every triangle cut into four, without moving anything.
pub fn split(mesh: &Mesh) -> Mesh {
    let mut finer = Mesh::default();
    for corners in &mesh.triangles {
        let base = finer.positions_mm.len() as u32;
        let [a, b, c] = corners.map(|v| v as usize);
        for (i, j) in [(a, a), (b, b), (c, c), (a, b), (b, c), (c, a)] {
            finer.positions_mm.push(0.5 * (mesh.positions_mm[i] + mesh.positions_mm[j]));
            // Not made unit vectors: interpolation then gives what it gave.
            finer.normals.push(0.5 * (mesh.normals[i] + mesh.normals[j]));
            finer.uvs.push(0.5 * (mesh.uvs[i] + mesh.uvs[j]));
        }
        finer.triangles.extend([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]].map(|t| t.map(|v| base + v)));
    }
    finer
}
