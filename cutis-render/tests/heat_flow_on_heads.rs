//! Heat flow and the separable blur on real meshes: against the direct convolution over the surface, near seams and everywhere, and
//! what they keep of the energy. `-- --nocapture` prints the table of docs/heat-flow.md.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "common/convolution.rs"]
mod convolution;

use convolution::{
    Direct, Place, Spread, VARIANCES_MM2, compared, errors, is_near, pattern, places, seams_mm,
};
use cutis_render::passes::atlas::charts_that_hold_light;
use cutis_scene::charts::Seam;
use cutis_scene::unwrap::unwrap;
use cutis_scene::{Material, Object, ReadOptions, read_scene};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

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

/// Everywhere heat flow is as good as the separable blur or better, and near seams the better the wider the Gaussian.
#[test]
fn heat_flow_is_near_the_direct_convolution() {
    let Some(object) = mesh("lee_perry_smith/LeePerrySmith.obj", Some(950.0)) else { return };
    let [everywhere, near] = compared(&object);
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

/// At the same places, on maps of the same size, by an atlas that is made for the head.
#[test]
fn a_new_atlas_serves_light_better() {
    let Some(own) = mesh("lee_perry_smith/LeePerrySmith.obj", Some(950.0)) else { return };
    let mut mesh = own.mesh.clone();
    unwrap(&mesh, None, None).unwrap().lay(&mut mesh);
    let new = Object::new("new atlas", mesh, Material::default());
    let [everywhere, near] = compared(&own);
    let new_seams_mm = seams_mm(&new);
    let near_new: Vec<Place> =
        everywhere.iter().filter(|p| is_near(&new_seams_mm, p.position_mm)).copied().collect();
    let direct = Direct::new(&own);
    let spreads = [(&own, 1024), (&new, 1024), (&own, 512), (&new, 512)]
        .map(|(object, size)| (object, Spread::new(object, size, true, pattern)));
    eprintln!("{} charts", new.charts.count);
    eprintln!("| variance, mm² | where | own, 1024² | new, 1024² | own, 512² | new, 512² |");
    for (n, variance_mm2) in VARIANCES_MM2.into_iter().enumerate() {
        let sets =
            [("everywhere", &everywhere), ("< 3 mm from an old seam", &near), ("from a new one", &near_new)];
        for (name, places) in sets {
            let exact: Vec<f32> = places.par_iter().map(|p| direct.at(p.position_mm, variance_mm2)).collect();
            let rows = spreads.each_ref().map(|(object, spread)| {
                let read = |p: &Place| spread.at(object, n + 1, p);
                errors(&places.iter().map(read).zip(exact.iter().copied()).collect::<Vec<_>>())
            });
            let cells: Vec<String> =
                rows.iter().map(|[rms, p99]| format!("{rms:.1} % / {p99:.1} %")).collect();
            eprintln!("| {variance_mm2} | {name} | {} |", cells.join(" | "));
            let [own_fine, new_fine, own_coarse, new_coarse] = rows.map(|[rms, _]| rms);
            let allowed = if name == "everywhere" { 0.9 } else { 0.6 };
            assert!(new_fine < allowed * own_fine && new_coarse < allowed * own_coarse, "{name}: {rows:?}");
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
