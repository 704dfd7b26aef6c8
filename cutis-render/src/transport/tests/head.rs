//! The scanned head in the light of a lamp: what leaves, region by region, from packets of the lamp and from paths of the eye
//! that start at places all over it.
//!
//! With the normals of its triangles both see exactly the same body. Smooth normals throw some light to where the triangle
//! does not let it go; there the flat normal is taken, which light and eye do not do at the same places: over the whole head
//! that comes to less than a percent.

use super::{scanned_head, scene_of};
use crate::transport::estimate::Estimate;
use crate::transport::exitance::{Entrances, of_place};
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_scene::{ColourMap, Light, Material, Mesh, Object, ScalarMap, Scattering, Scene};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Regions along a side of the texture.
const REGIONS: usize = 8;
/// Share of the light that a region must have.
const LIT: f64 = 2e-3;
/// Batches that the noise is told from: to 6 %.
const BATCHES: u64 = 128;

/// Which normals the head has.
#[derive(Clone, Copy, PartialEq)]
enum Normals {
    Flat,
    Smooth,
}

/// The same triangles, each with vertices and a normal of its own.
fn faceted(object: &Object) -> Object {
    let mut mesh = Mesh::default();
    for (t, triangle) in object.mesh.triangles.iter().enumerate() {
        let [a, b, c] = object.mesh.corners_mm(t);
        let base = mesh.positions_mm.len() as u32;
        mesh.positions_mm.extend([a, b, c]);
        mesh.normals.extend([(b - a).cross(c - a).normalize_or(Vec3::Y); 3]);
        mesh.uvs.extend(triangle.map(|v| object.mesh.uvs[v as usize]));
        mesh.triangles.push([base, base + 1, base + 2]);
    }
    Object::new("facets", mesh, object.material.clone())
}

fn head_and_lamp(test: &str, normals: Normals) -> Option<Scene> {
    let material = Material {
        scattering: Scattering::Preset("skin1".to_owned()),
        albedo: ColourMap { factor: Vec3::ONE, texture: None },
        roughness: ScalarMap::constant(0.3),
        ..Material::default()
    };
    // From the front left and above.
    let lamp = Light::Point {
        position_mm: Vec3::new(-420.0, 380.0, 700.0),
        intensity_w_per_sr: Vec3::splat(1.0),
        radius_mm: 150.0,
    };
    let head = scanned_head(test, material)?;
    let head = if normals == Normals::Flat { faceted(&head) } else { head };
    Some(scene_of(vec![head], vec![lamp], None))
}

/// The region at texture coordinates.
fn region_of(uv: Vec2) -> usize {
    let place = |share: f32| ((share.rem_euclid(1.0) * REGIONS as f32) as usize).min(REGIONS - 1);
    place(uv.y) * REGIONS + place(uv.x)
}

/// Flux of every region, W/m² times mm², from batches of equal size.
fn by_batches(batch: impl Fn(u64) -> [DVec3; REGIONS * REGIONS] + Sync + Send) -> Vec<Estimate> {
    let fluxes: Vec<_> = (0..BATCHES).into_par_iter().map(batch).collect();
    let mut regions = vec![Estimate::default(); REGIONS * REGIONS];
    for flux in fluxes {
        regions.iter_mut().zip(flux).for_each(|(region, flux)| region.add(flux));
    }
    regions
}

fn assert_regions_alike(test: &str, normals: Normals, per_batch: u64) {
    let Some(scene) = head_and_lamp(test, normals) else { return };
    let transport = Transport::new(&scene, 1).unwrap();
    let entrances = Entrances::new(&transport);
    let per = per_batch as f64;
    let from_lamp = by_batches(|batch| {
        let mut flux = [DVec3::ZERO; REGIONS * REGIONS];
        entrances
            .walk(7, batch * per_batch, per_batch, |exit| flux[region_of(exit.atlas_uv)] += exit.flux / per);
        flux
    });
    let from_places = by_batches(|batch| {
        let mut flux = [DVec3::ZERO; REGIONS * REGIONS];
        for path in 0..per_batch {
            let mut random = Random::new(8, batch, path);
            let (meeting, place_mm) = entrances.place(&mut random);
            let exitance = of_place(&transport, meeting, place_mm, &mut random);
            flux[region_of(transport.solids.atlas_uv(&meeting))] += exitance * (entrances.area_mm2() / per);
        }
        flux
    });
    let all: DVec3 = from_lamp.iter().map(Estimate::mean).sum();
    let from_everywhere: DVec3 = from_places.iter().map(Estimate::mean).sum();
    let variance = |of: &[Estimate]| of.iter().map(|e| e.standard_error().powf(2.0)).sum::<DVec3>();
    let apart = (all - from_everywhere) / (variance(&from_lamp) + variance(&from_places)).powf(0.5);
    let off = (all / from_everywhere - 1.0) * 100.0;
    eprintln!("the whole head: {off:+.2} %, {apart:+.2} errors");
    if normals == Normals::Flat {
        // Three channels that go together: a false alarm in 10,000 seeds.
        assert!(apart.abs().cmple(DVec3::splat(4.0)).all(), "the whole head: {apart} errors");
    } else {
        assert!(off.abs().cmple(DVec3::splat(1.0)).all(), "the whole head: {off} %");
    }
    let (mut compared, mut chi2) = (0.0, 0.0);
    for (region, (a, b)) in from_lamp.iter().zip(&from_places).enumerate() {
        // In the dark, exits are too few to know how far they may be off.
        if a.mean().x.max(b.mean().x) < LIT * all.x {
            continue;
        }
        let error = (a.standard_error().powf(2.0) + b.standard_error().powf(2.0)).powf(0.5);
        let apart = (a.mean() - b.mean()) / error;
        eprintln!("region {region}: {:.1} and {:.1}, {apart:+.2} errors", a.mean(), b.mean());
        compared += 1.0;
        chi2 += apart.x * apart.x;
        // Some 40 regions of 3 channels, four standard errors: a false alarm in 130 seeds.
        assert!(apart.abs().cmple(DVec3::splat(4.0)).all(), "region {region}: {apart} errors");
    }
    eprintln!("chi² {chi2:.1} of {compared} regions");
    assert!(compared > 12.0, "there are regions: {compared}");
    assert!(chi2 < compared + 3.0 * f64::sqrt(2.0 * compared), "chi² {chi2} of {compared} regions");
}

#[test]
fn the_head_is_lit_alike_from_the_lamp_and_from_the_eye() {
    assert_regions_alike("the_head_is_lit_alike_from_the_lamp_and_from_the_eye", Normals::Flat, 1_000);
}

#[test]
#[ignore = "slow suite: forty times the paths, and smooth normals"]
fn slow_the_head_is_lit_alike_from_the_lamp_and_from_the_eye() {
    let test = "slow_the_head_is_lit_alike_from_the_lamp_and_from_the_eye";
    assert_regions_alike(test, Normals::Flat, 40_000);
    assert_regions_alike(test, Normals::Smooth, 40_000);
}
