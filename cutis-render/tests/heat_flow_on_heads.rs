//! Heat flow and the separable blur on real meshes: against the direct convolution over the surface, near seams and everywhere, and
//! what they keep of the energy. `-- --nocapture` prints the table of docs/heat-flow.md.
#![allow(clippy::unwrap_used, reason = "tests")]

use cutis_render::Silent;
use cutis_render::passes::atlas::{Atlas, NO_CHART, charts_that_hold_light};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::charts::Seam;
use cutis_scene::{Object, ReadOptions, read_scene};
use glam::{IVec3, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const VARIANCES_MM2: [f32; 3] = [0.567, 1.99, 7.41];
/// Places of the surface that are compared.
const PLACES: usize = 6000;
/// Points by which the surface is convolved, for every place that is compared and every triangle: (k²) of them.
const SPLITS: usize = 7;
/// Side of the cells in which points are found again, mm.
const CELL_MM: f32 = 3.0;

/// A mesh of the shelf, or none with a line on stderr; with `CUTIS_REQUIRE_ASSETS=1` a missing shelf fails.
fn mesh(name: &str, millimetres_per_unit: Option<f32>) -> Option<Object> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let shelf = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets"));
    if !shelf.is_dir() {
        let why = format!("the assets folder {} does not exist; set CUTIS_ASSETS", shelf.display());
        assert!(std::env::var_os("CUTIS_REQUIRE_ASSETS").is_none_or(|v| v != "1"), "{why}");
        eprintln!("SKIPPED: {why}");
        return None;
    }
    let options = ReadOptions { millimetres_per_unit, ..ReadOptions::default() };
    Some(read_scene(&shelf.join(name), &options).unwrap().objects.swap_remove(0))
}

/// A smooth pattern of 20 mm.
fn pattern(p: Vec3) -> f32 {
    let wave = |x: f32| (std::f32::consts::TAU * x / 20.0).sin();
    1.0 + 0.8 * wave(p.x) * wave(p.y) * wave(p.z + 5.0)
}

/// A place on a triangle.
#[derive(Clone, Copy)]
struct Place {
    triangle: usize,
    b: Vec2,
    position_mm: Vec3,
    area_mm2: f32,
}

/// Every triangle in small ones, by their middles.
fn places(object: &Object, splits: usize) -> Vec<Place> {
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
struct Direct {
    all: Vec<Place>,
    cells: HashMap<IVec3, Vec<u32>>,
}

impl Direct {
    fn new(object: &Object) -> Self {
        let all = places(object, SPLITS);
        let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
        for (i, place) in all.iter().enumerate() {
            cells.entry((place.position_mm / CELL_MM).floor().as_ivec3()).or_default().push(i as u32);
        }
        Self { all, cells }
    }

    fn at(&self, p: Vec3, variance_mm2: f32) -> f32 {
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

/// Light on an atlas after an operator.
struct Spread {
    diffused: Diffused,
}

impl Spread {
    fn new(object: &Object, size: usize, flows: bool, light: impl Fn(Vec3) -> f32) -> Self {
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

    fn at(&self, object: &Object, level: usize, place: &Place) -> f32 {
        let [a, b, c] = object.mesh.corner_uvs(place.triangle);
        let uv = a + (b - a) * place.b.x + (c - a) * place.b.y;
        self.diffused.sample(level, 0, uv, object.charts.of_triangle[place.triangle]).x
    }
}

/// Ends of every edge at which charts meet, mm.
fn seams_mm(object: &Object) -> Vec<[Vec3; 2]> {
    let end = |triangle: u32, uv: Vec2| {
        let corners = object.mesh.corner_uvs(triangle as usize);
        let k = (0..3).min_by(|&i, &j| (corners[i] - uv).length().total_cmp(&(corners[j] - uv).length()));
        object.mesh.corners_mm(triangle as usize)[k.unwrap()]
    };
    object.charts.seams.iter().map(|seam| seam.uvs[0].map(|uv| end(seam.triangles[0], uv))).collect()
}

fn is_near(seams_mm: &[[Vec3; 2]], p: Vec3) -> bool {
    seams_mm.iter().any(|[a, b]| {
        let along = *b - *a;
        let part = ((p - *a).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
        (*a + along * part - p).length() < 3.0
    })
}

/// RMS and 99th percentile, percent of the mean.
fn errors(pairs: &[(f32, f32)]) -> [f32; 2] {
    let mean = pairs.iter().map(|p| p.1).sum::<f32>() / pairs.len() as f32;
    let mut off: Vec<f32> = pairs.iter().map(|(a, b)| 100.0 * (a - b).abs() / mean).collect();
    off.sort_by(f32::total_cmp);
    [(off.iter().map(|o| o * o).sum::<f32>() / off.len() as f32).sqrt(), off[off.len() * 99 / 100]]
}

/// Everywhere heat flow is as good as the separable blur or better, and near seams the better the wider the Gaussian.
#[test]
fn heat_flow_is_near_the_direct_convolution() {
    let Some(object) = mesh("lee_perry_smith/LeePerrySmith.obj", Some(950.0)) else { return };
    // Places under texels, in no order, so that what counts is what a map can show.
    let holds_light = charts_that_hold_light(&object, 512);
    let atlas = Atlas::new(&object, 1024);
    let stride = 7919;
    let all: Vec<Place> = (0..1024 * 1024)
        .map(|i| (i * stride) % (1024 * 1024))
        .filter(|&i| atlas.surface[i].triangle != NO_CHART && holds_light[atlas.charts.chart[i] as usize])
        .map(|i| {
            let at = atlas.surface[i];
            let [p, q, r] = object.mesh.corners_mm(at.triangle as usize);
            let position_mm = p + (q - p) * at.b1 + (r - p) * at.b2;
            Place { triangle: at.triangle as usize, b: Vec2::new(at.b1, at.b2), position_mm, area_mm2: 0.0 }
        })
        .collect();
    let seams = seams_mm(&object);
    let everywhere: Vec<Place> = all.iter().take(PLACES).copied().collect();
    let near: Vec<Place> =
        all.iter().filter(|p| is_near(&seams, p.position_mm)).take(PLACES).copied().collect();
    let direct = Direct::new(&object);
    let spreads = [(1024, false), (1024, true), (512, false), (512, true)]
        .map(|(n, f)| Spread::new(&object, n, f, pattern));
    eprintln!(
        "| variance, mm² | where | separable 1024² | heat flow 1024² | separable 512² | heat flow 512² |"
    );
    for (n, variance_mm2) in VARIANCES_MM2.into_iter().enumerate() {
        for (name, places) in [("everywhere", &everywhere), ("< 3 mm from a seam", &near)] {
            let exact: Vec<f32> = places.par_iter().map(|p| direct.at(p.position_mm, variance_mm2)).collect();
            let rows = spreads.each_ref().map(|spread| {
                let read = |p: &Place| spread.at(&object, n + 1, p);
                errors(&places.iter().map(read).zip(exact.iter().copied()).collect::<Vec<_>>())
            });
            let cells: Vec<String> =
                rows.iter().map(|[rms, p99]| format!("{rms:.1} % / {p99:.1} %")).collect();
            eprintln!("| {variance_mm2} | {name} | {} |", cells.join(" | "));
            let [fine, fine_flow, coarse, coarse_flow] = rows.map(|[rms, _]| rms);
            // Of the separable blur's error. Near seams narrow Gaussians show what the coarser side cannot tell.
            let allowed = if name == "everywhere" { 1.15 } else { [1.5, 1.2, 0.75][n] };
            assert!(
                fine_flow < allowed * fine && coarse_flow < allowed * coarse,
                "{variance_mm2} {name}: {rows:?}"
            );
        }
    }
}

/// The pattern after each Gaussian: on both sides of seams it is at most a fifth as far apart as by the separable
/// blur.
#[test]
fn both_sides_of_seams_show_the_same_light() {
    let Some(object) = mesh("lee_perry_smith/LeePerrySmith.obj", Some(950.0)) else { return };
    let holds_light = charts_that_hold_light(&object, 1024);
    let compared =
        |s: &&Seam| s.triangles.iter().all(|&t| holds_light[object.charts.of_triangle[t as usize] as usize]);
    let seams: Vec<&Seam> = object.charts.seams.iter().filter(compared).collect();
    let apart = [false, true].map(|flows| {
        let spread = Spread::new(&object, 1024, flows, pattern);
        [1, 2, 3].map(|level| {
            let at = |seam: &Seam, side: usize, f: f32| {
                let [from, to] = seam.uvs[side];
                let chart = object.charts.of_triangle[seam.triangles[side] as usize];
                spread.diffused.sample(level, 0, from.lerp(to, f), chart).x
            };
            let places = [0.125, 0.375, 0.625, 0.875];
            let off = seams.iter().flat_map(|s| places.map(|f| (at(s, 0, f) - at(s, 1, f)).abs()));
            off.sum::<f32>() / (4 * seams.len()) as f32
        })
    });
    eprintln!("separable {:?}, heat flow {:?}", apart[0], apart[1]);
    for (separable, flow) in apart[0].iter().zip(&apart[1]) {
        assert!(5.0 * flow < *separable, "{apart:?}");
    }
}

/// Area times light, read all over the surface, is what it was before.
#[test]
fn every_mesh_of_the_shelf_keeps_its_energy() {
    let meshes = [
        ("lee_perry_smith/LeePerrySmith.obj", Some(950.0)),
        ("lee_perry_smith/LeePerrySmith.glb", Some(50.4)),
        ("lee_perry_smith/away3d_2k/head.obj", None),
        ("gltf_samples/Suzanne/Suzanne.gltf", None),
        ("webxr_hand/left.glb", None),
        ("webxr_hand/right.glb", None),
    ];
    for (name, millimetres_per_unit) in meshes {
        let Some(object) = mesh(name, millimetres_per_unit) else { return };
        let holds_light = charts_that_hold_light(&object, 512);
        let all: Vec<Place> = places(&object, 6)
            .into_iter()
            .filter(|p| holds_light[object.charts.of_triangle[p.triangle] as usize])
            .collect();
        let spread = Spread::new(&object, 512, true, pattern);
        let energy = |level: usize| -> f64 {
            all.iter().map(|p| f64::from(p.area_mm2) * f64::from(spread.at(&object, level, p))).sum()
        };
        let change = (1..=3).map(|level| energy(level) / energy(0) - 1.0);
        let change: Vec<f64> = change.collect();
        eprintln!("{name}, closed {}: {change:.6?}", object.closed);
        assert!(change.iter().all(|c| c.abs() < 1e-3), "{name}: {change:?}");
    }
}
