//! What operators are held against: a smooth pattern, convolved with Gaussians over the surface of a mesh directly.

use cutis_render::Silent;
use cutis_render::passes::atlas::{Atlas, NO_CHART, charts_that_hold_light};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::Object;
use glam::{IVec3, Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::sync::Arc;

/// Variances that are compared, mm².
pub const VARIANCES_MM2: [f32; 3] = [0.567, 1.99, 7.41];
/// Places of the surface that are compared.
const PLACES: usize = 6000;
/// Points by which the surface is convolved, for every place that is compared and every triangle: (k²) of them.
const SPLITS: usize = 7;
/// Side of the cells in which points are found again, mm.
const CELL_MM: f32 = 3.0;

/// A smooth pattern of 20 mm.
pub fn pattern(p: Vec3) -> f32 {
    let wave = |x: f32| (std::f32::consts::TAU * x / 20.0).sin();
    1.0 + 0.8 * wave(p.x) * wave(p.y) * wave(p.z + 5.0)
}

/// A place on a triangle.
#[derive(Clone, Copy)]
pub struct Place {
    /// The triangle.
    pub triangle: usize,
    /// Shares of its second and third corner.
    pub b: Vec2,
    /// Where that is, mm.
    pub position_mm: Vec3,
    /// Area that it stands for, mm².
    pub area_mm2: f32,
}

/// Every triangle in small ones, by their middles.
pub fn places(object: &Object, splits: usize) -> Vec<Place> {
    let middles: Vec<Vec2> = (0..splits)
        .flat_map(|i| (0..splits - i).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let at = |o: f32| Vec2::new((i as f32 + o) / splits as f32, (j as f32 + o) / splits as f32);
            let turned = (i + j + 1 < splits).then(|| at(2.0 / 3.0));
            [at(1.0 / 3.0)].into_iter().chain(turned)
        })
        .collect();
    let of = |triangle: usize| {
        let [p, q, r] = object.mesh.corners_mm(triangle);
        let area_mm2 = object.mesh.area_mm2(triangle) / middles.len() as f32;
        middles.iter().map(move |&b| Place {
            triangle,
            b,
            position_mm: p + (q - p) * b.x + (r - p) * b.y,
            area_mm2,
        })
    };
    (0..object.mesh.triangles.len()).flat_map(of).collect()
}

/// The pattern convolved with a Gaussian over the surface, as the crow flies, by its mass.
pub struct Direct {
    all: Vec<Place>,
    cells: HashMap<IVec3, Vec<u32>>,
}

impl Direct {
    /// Over the surface of an object.
    pub fn new(object: &Object) -> Self {
        let all = places(object, SPLITS);
        let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
        for (i, place) in all.iter().enumerate() {
            cells.entry((place.position_mm / CELL_MM).floor().as_ivec3()).or_default().push(i as u32);
        }
        Self { all, cells }
    }

    /// At a point, mm.
    pub fn at(&self, p: Vec3, variance_mm2: f32) -> f32 {
        let reach_mm = 4.0 * variance_mm2.sqrt();
        let [lo, hi] = [p - reach_mm, p + reach_mm].map(|p| (p / CELL_MM).floor().as_ivec3());
        let (mut sum, mut mass) = (0.0f64, 0.0f64);
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    for &i in self.cells.get(&IVec3::new(x, y, z)).into_iter().flatten() {
                        let other = &self.all[i as usize];
                        let d2 = (other.position_mm - p).length_squared();
                        let weight = f64::from(other.area_mm2 * (-d2 / (2.0 * variance_mm2)).exp());
                        sum += weight * f64::from(pattern(other.position_mm));
                        mass += weight;
                    }
                }
            }
        }
        (sum / mass) as f32
    }
}

/// Ends of every edge at which charts meet, mm.
pub fn seams_mm(object: &Object) -> Vec<[Vec3; 2]> {
    let end = |triangle: u32, uv: Vec2| {
        let corners = object.mesh.corner_atlas_uvs(triangle as usize);
        let k = (0..3).min_by(|&i, &j| (corners[i] - uv).length().total_cmp(&(corners[j] - uv).length()));
        object.mesh.corners_mm(triangle as usize)[k.expect("a triangle has three corners")]
    };
    object.charts.seams.iter().map(|seam| seam.uvs[0].map(|uv| end(seam.triangles[0], uv))).collect()
}

/// Whether a place is less than three millimetres from a seam.
pub fn is_near(seams_mm: &[[Vec3; 2]], p: Vec3) -> bool {
    seams_mm.iter().any(|[a, b]| {
        let along = *b - *a;
        let part = ((p - *a).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
        (*a + along * part - p).length() < 3.0
    })
}

/// RMS and 99th percentile, percent of the mean.
pub fn errors(pairs: &[(f32, f32)]) -> [f32; 2] {
    let mean = pairs.iter().map(|p| p.1).sum::<f32>() / pairs.len() as f32;
    let mut off: Vec<f32> = pairs.iter().map(|(a, b)| 100.0 * (a - b).abs() / mean).collect();
    off.sort_by(f32::total_cmp);
    [(off.iter().map(|o| o * o).sum::<f32>() / off.len() as f32).sqrt(), off[off.len() * 99 / 100]]
}

/// Places under texels of a map of 1024², in no order, so that what counts is what a map can show: everywhere, and near seams.
pub fn compared(object: &Object) -> [Vec<Place>; 2] {
    let holds_light = charts_that_hold_light(object, 512);
    let atlas = Atlas::new(object, 1024);
    let stride = 7919;
    let under = |i: usize| {
        let at = atlas.surface[i];
        let [p, q, r] = object.mesh.corners_mm(at.triangle as usize);
        let position_mm = p + (q - p) * at.b1 + (r - p) * at.b2;
        Place { triangle: at.triangle as usize, b: Vec2::new(at.b1, at.b2), position_mm, area_mm2: 0.0 }
    };
    let all: Vec<Place> = (0..1024 * 1024)
        .map(|i| (i * stride) % (1024 * 1024))
        .filter(|&i| atlas.surface[i].triangle != NO_CHART && holds_light[atlas.charts.chart[i] as usize])
        .map(under)
        .collect();
    let seams = seams_mm(object);
    let near = all.iter().filter(|p| is_near(&seams, p.position_mm)).take(PLACES).copied().collect();
    [all.into_iter().take(PLACES).collect(), near]
}

/// Light on an atlas after an operator.
pub struct Spread {
    /// The light of every level.
    pub diffused: Diffused,
}

impl Spread {
    /// By heat flow, or by the separable blur.
    pub fn new(object: &Object, size: usize, flows: bool, light: impl Fn(Vec3) -> f32) -> Self {
        let atlas = Atlas::new(object, size);
        let stretch_mm = stretch_mm_per_texel(object, &atlas);
        let lit = |i: usize| {
            let point = atlas.surface_point(object, i);
            point.map_or(Vec4::ZERO, |p| Vec4::splat(light(p.position_mm)))
        };
        let fields = Fields::new(vec![(0..size * size).map(lit).collect()], stretch_mm.clone());
        let flow = flows.then(|| HeatFlow::new(object, &atlas, &stretch_mm, &VARIANCES_MM2));
        let operator: &dyn DiffusionOperator = flow.as_ref().map_or(&Separable, |flow| flow);
        let diffused = operator.diffuse(Arc::clone(&atlas.charts), fields, &VARIANCES_MM2, &Silent);
        Self { diffused }
    }

    /// At a place, after a Gaussian.
    pub fn at(&self, object: &Object, level: usize, place: &Place) -> f32 {
        let [a, b, c] = object.mesh.corner_atlas_uvs(place.triangle);
        let uv = a + (b - a) * place.b.x + (c - a) * place.b.y;
        self.diffused.sample(level, 0, uv, object.charts.of_triangle[place.triangle]).x
    }
}
