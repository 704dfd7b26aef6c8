//! Lamps: asked for, met by chance, or followed from where they shine, they light a body alike.

use super::{assert_alike, ball, material, scene_of};
use crate::transport::estimate::Estimate;
use crate::transport::exitance::{Entrances, of_place};
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_optics::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_scene::{Light, Projector, Scene, Texels, Texture};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Place of the lamp, mm; the ball is in the middle.
const TO_LAMP_MM: Vec3 = Vec3::new(40.0, 60.0, 70.0);

/// A ball in the light of a lamp as large as it, from aside.
fn lamp_and_ball(rings: u32, roughness: f32) -> Scene {
    let lamp = Light::Point {
        position_mm: TO_LAMP_MM,
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        radius_mm: 8.0,
    };
    scene_of(vec![ball(10.0, rings, material(0.05, 1.5, 1.4, roughness))], vec![lamp], None)
}

/// Mean radiance of light from inside over rays from the camera that meet the ball.
fn seen_by_camera(transport: &Transport, paths: u64) -> Estimate {
    let mut estimate = Estimate::default();
    for i in 0..paths {
        let mut random = Random::new(5, i, 1);
        let aim = random.direction() * 7.0;
        let from = DVec3::new(0.0, 0.0, 100.0);
        let sample = transport.radiance(from, (aim - from).normalize(), &mut random);
        if sample.covered {
            estimate.add(sample.diffuse);
        }
    }
    estimate
}

#[test]
fn lamps_asked_through_the_surface_shine_as_lamps_met_by_chance() {
    let scene = lamp_and_ball(24, 0.5);
    let asked = Transport::new(&scene, 1).unwrap();
    let mut met = Transport::new(&scene, 1).unwrap();
    met.bodies[0].connection_mm = 0.0;
    let (asked, met) = (seen_by_camera(&asked, 20_000), seen_by_camera(&met, 60_000));
    assert_alike("asked and met", &asked, &met);
    // What it is for: from a third of the paths less noise.
    assert!(asked.standard_error().x < met.standard_error().x, "{asked:?} {met:?}");
}

/// What packets of the lamps and paths of the eye find in both halves of the ball, towards the lamp and away from it.
fn assert_lamp_as_eye(what: &str, scene: &Scene, packets: u64, paths: u64) {
    let transport = Transport::new(scene, 1).unwrap();
    let entrances = Entrances::new(&transport);
    let half = |place: DVec3| usize::from(place.dot(TO_LAMP_MM.as_dvec3()) < 0.0);
    let mut from_lamp = [Estimate::default(); 2];
    let area_mm2 = entrances.area_mm2() / 2.0;
    for number in 0..packets {
        let mut flux = [DVec3::ZERO; 2];
        entrances.walk(3, number, 1, |exit| {
            let (theta, phi) = (exit.atlas_uv.y * PI, exit.atlas_uv.x * TAU);
            let dir = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            flux[half(dir.as_dvec3())] += exit.flux / area_mm2;
        });
        (0..2).for_each(|h| from_lamp[h].add(flux[h]));
    }
    let mut from_places = [Estimate::default(); 2];
    let mut random = Random::new(8, 0, 0);
    for number in 0..paths {
        let (meeting, place) = entrances.place(&mut random);
        let came = of_place(&transport, meeting, place, &mut Random::new(9, number, 0));
        let h = half(place);
        from_places[h].add(came);
    }
    for h in 0..2 {
        assert_alike(&format!("{what}, half {h}"), &from_lamp[h], &from_places[h]);
    }
}

#[test]
fn light_from_lamps_leaves_as_the_eye_sees_it() {
    assert_lamp_as_eye("rough", &lamp_and_ball(16, 0.3), 60_000, 30_000);
    assert_lamp_as_eye("smooth", &lamp_and_ball(16, 0.0), 60_000, 400_000);
}

#[test]
fn light_from_a_projector_leaves_as_the_eye_sees_it() {
    let mut scene = lamp_and_ball(16, 0.3);
    // Half white, half red, and narrower than the ball.
    let image = Texture::new(2, 1, Texels::LinearF32(vec![[1.0; 4], [1.0, 0.2, 0.0, 1.0]]));
    scene.lights = vec![Light::Projector(Projector {
        position_mm: TO_LAMP_MM,
        axes: Projector::axes(-TO_LAMP_MM.normalize(), Vec3::Y),
        tan_half_height: 0.04,
        image: Arc::new(image),
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        radius_mm: 8.0,
        shift: Vec2::new(0.2, 0.0),
        drift_per_s: Vec2::ZERO,
    })];
    assert_lamp_as_eye("projector", &scene, 60_000, 30_000);
}

/// Light that is scattered in the dark is asked for lamps, too, where none of several shines on that place: their light may come
/// in beside it.
#[test]
fn narrow_lamps_shine_as_the_eye_sees_them() {
    let mut scene = lamp_and_ball(16, 0.3);
    let spot = |aim_mm: Vec3| Light::Spot {
        position_mm: TO_LAMP_MM,
        dir_travel: (aim_mm - TO_LAMP_MM).normalize(),
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        inner_cone_rad: 0.03,
        outer_cone_rad: 0.031,
        radius_mm: 3.0,
    };
    scene.lights = vec![spot(Vec3::new(4.0, 0.0, 0.0)), spot(Vec3::new(-2.0, 3.0, 0.0))];
    assert_lamp_as_eye("spots", &scene, 600_000, 600_000);
}

/// The flux of packets is corrected where the normal is not that of the triangle: here all normals lean towards the lamp.
#[test]
fn light_leaves_a_relief_as_the_eye_sees_it() {
    let mut scene = lamp_and_ball(16, 0.5);
    for normal in &mut scene.objects[0].mesh.normals {
        *normal = (*normal + 0.4 * TO_LAMP_MM.normalize()).normalize();
    }
    assert_lamp_as_eye("relief", &scene, 60_000, 60_000);
}

/// A film on the surface is passed once in and once out, however often light is thrown back within: with `albedo_mix` 0.5 the
/// bare ball's light times the albedo, over the colour that the bare tissue has on its own; seen by the eye, and leaving.
#[test]
fn a_film_colours_light_once_in_and_once_out() {
    let bare = lamp_and_ball(16, 0.4);
    let mut filmed = bare.clone();
    let albedo = Vec3::new(0.8, 0.5, 0.2);
    filmed.objects[0].material.albedo.factor = albedo;
    let [bare, filmed] = [&bare, &filmed].map(|scene| Transport::new(scene, 1).unwrap());
    // What the tissue reflects on its own: sigma_s 1.5, sigma_a 0.05, index 1.4, by the other simulation.
    let layer = Layer {
        sigma_a_per_mm: 0.05,
        sigma_s_per_mm: 1.5,
        g: 0.0,
        refractive_index: 1.4,
        thickness_mm: f64::INFINITY,
    };
    let grid =
        Grid { rings: Rings::even(1.0, 1).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
    let slab = LayeredSlab::in_air(vec![layer]).unwrap();
    let own = Simulation { slab, grid, seed: 77 }.run(200_000).diffuse_reflectance();
    let expected = albedo.as_dvec3() / own.value;
    // The same random numbers walk the same ways: the ratio is that of the films, but for roulette; and the body's own
    // simulation of its colour has 1/2 % of noise.
    let assert_ratio = |what: &str, plain: DVec3, coloured: DVec3| {
        let ratio = coloured / plain / expected;
        eprintln!("{what}: {ratio}");
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{what}: {ratio}");
    };
    let seen = |transport| seen_by_camera(transport, 20_000).mean();
    assert_ratio("seen", seen(&bare), seen(&filmed));
    let leaving = |transport| {
        let mut flux = DVec3::ZERO;
        Entrances::new(transport).walk(3, 0, 100_000, |exit| flux += exit.flux);
        flux
    };
    assert_ratio("leaving", leaving(&bare), leaving(&filmed));
}
