//! Distances through bodies of known thickness.

use crate::scenes::{ball, hollow_ball, plain, plate, scene, sun, white};
use cutis_render::technique::depth_absorption::DepthAbsorptionSettings;
use cutis_render::technique::depth_absorption::way::Ways;
use cutis_scene::validation::shapes::capsule;
use cutis_scene::{Bvh, Light, Object, Scene};
use glam::Vec3;

/// Distance through bodies from the first light to a place, mm.
fn inside_mm(scene: &Scene, settings: &DepthAbsorptionSettings, place_mm: Vec3) -> Option<f32> {
    let bvh = Bvh::build(&scene.objects);
    Ways::new(scene, &bvh, settings).to(&scene.lights[0], place_mm).map(|way| way.inside_mm)
}

/// The places of a circle of radius 10 mm that face away from a light at -z, by their distance from its axis.
fn behind(radius_mm: f32) -> impl Iterator<Item = (f32, Vec3)> {
    // Not at a corner or an edge of the mesh, nor quite at the terminator.
    (0..40).map(move |i| {
        let angle = 1.47 * (i as f32 + 0.37) / 40.0;
        let (turn_sin, turn_cos) = (0.61 + 0.13 * i as f32).sin_cos();
        let aside_mm = radius_mm * angle.sin();
        (aside_mm, Vec3::new(aside_mm * turn_cos, aside_mm * turn_sin, radius_mm * angle.cos()))
    })
}

/// How far a flat facet of the ball lies below it, mm: sides of 1/128 of a turn, along both axes.
fn sagitta_mm(radius_mm: f32) -> f32 {
    2.0 * radius_mm * (1.0 - (std::f32::consts::PI / 128.0).cos())
}

#[test]
fn a_plate_is_as_thick_as_it_is_along_the_light() {
    for thickness_mm in [0.01f32, 0.5, 3.0, 30.0] {
        let exit_mm = Vec3::new(3.1, -2.3, 0.5 * thickness_mm);
        for dir in [Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.48, 0.36, -0.8)] {
            let scene = scene(vec![plate(thickness_mm)], vec![sun(dir)]);
            let s_mm = inside_mm(&scene, &plain(), exit_mm).expect("light comes through");
            // Coordinates of 40 mm have steps of 4e-6 mm; a few are added.
            assert!((s_mm - thickness_mm / -dir.z).abs() < 3e-5, "{thickness_mm} mm along {dir}: {s_mm}");
        }
        let lamp = Vec3::new(20.0, 10.0, -300.0);
        let light = Light::Point { position_mm: lamp, intensity_w_per_sr: Vec3::ONE, radius_mm: 0.0 };
        let scene = scene(vec![plate(thickness_mm)], vec![light]);
        let s_mm = inside_mm(&scene, &plain(), exit_mm).expect("light comes through");
        let expected_mm = thickness_mm * exit_mm.distance(lamp) / (exit_mm.z - lamp.z);
        assert!((s_mm - expected_mm).abs() < 3e-5, "{thickness_mm} mm before a lamp: {s_mm}");
    }
}

#[test]
fn a_ball_is_as_thick_as_its_chord() {
    let scene = scene(vec![ball(10.0)], vec![sun(-Vec3::Z)]);
    for (aside_mm, exit_mm) in behind(10.0) {
        let s_mm = inside_mm(&scene, &plain(), exit_mm).expect("light comes through");
        let half_mm = (100.0 - aside_mm * aside_mm).sqrt();
        // The facet lies below the ball by its sagitta along the normal, which is farther along the light.
        let slack_mm = sagitta_mm(10.0) * 10.0 / half_mm;
        assert!((s_mm - 2.0 * half_mm).abs() < slack_mm, "{aside_mm}: {s_mm} for {}", 2.0 * half_mm);
    }
}

#[test]
fn growth_takes_distances_from_where_the_body_really_is() {
    let scene = scene(vec![ball(10.0)], vec![sun(-Vec3::Z)]);
    for growth_mm in [0.3f32, 1.0, 4.0] {
        let settings = DepthAbsorptionSettings { growth_mm, ..plain() };
        for (aside_mm, exit_mm) in behind(10.0) {
            let s_mm = inside_mm(&scene, &settings, exit_mm).expect("light comes through");
            // The ray meets the ball of 10 + g at an angle whose sine is b / (10 + g); at that angle the ball itself is there.
            let entry_mm = 10.0 * (1.0 - (aside_mm / (10.0 + growth_mm)).powi(2)).sqrt();
            let expected_mm = (100.0 - aside_mm * aside_mm).sqrt() + entry_mm;
            let slack_mm = 2.0 * sagitta_mm(10.0 + growth_mm) * 10.0 / entry_mm;
            assert!((s_mm - expected_mm).abs() < slack_mm, "{growth_mm}, {aside_mm}: {s_mm}, {expected_mm}");
        }
    }
}

#[test]
fn a_grown_box_has_no_gap_at_its_edges() {
    let settings = DepthAbsorptionSettings { growth_mm: 2.0, ..plain() };
    let cube =
        Object::new("cube", cutis_scene::validation::shapes::cuboid(Vec3::ZERO, Vec3::splat(20.0)), white());
    let scene = scene(vec![cube], vec![sun(Vec3::new(-1.0, 0.013, -1.0))]);
    for i in 0..400 {
        // Past the edge that is nearest to the light, and to both sides of it.
        let aside_mm = 0.01 * (i as f32 - 200.0) + 1e-3;
        let exit_mm = Vec3::new(20.0 + aside_mm.min(0.0), 1.0, 20.0 - aside_mm.max(0.0));
        let s_mm = inside_mm(&scene, &settings, exit_mm).expect("light comes through");
        // The diagonal is 56.6 mm long.
        assert!((s_mm - 56.6).abs() < 5.0, "{aside_mm} mm: {s_mm}");
    }
}

#[test]
fn holes_do_not_count_where_surfaces_are_told_apart() {
    let scene = scene(vec![hollow_ball()], vec![sun(-Vec3::Z)]);
    for (aside_mm, exit_mm) in behind(10.0) {
        let half_mm = (100.0 - aside_mm * aside_mm).sqrt();
        let hole_mm = 2.0 * (49.0 - aside_mm * aside_mm).max(0.0).sqrt();
        for (layers, expected_mm) in [
            (1, 2.0 * half_mm),
            // The second way in is not known: all behind the first way out is flesh.
            (2, 2.0 * half_mm),
            (3, 2.0 * half_mm - hole_mm),
            (16, 2.0 * half_mm - hole_mm),
        ] {
            let settings = DepthAbsorptionSettings { layers, ..plain() };
            let s_mm = inside_mm(&scene, &settings, exit_mm).expect("light comes through");
            // Both balls, each as in the test of one; near its rim the hole's facets miss the ray.
            let rim_mm = if hole_mm > 0.0 { sagitta_mm(7.0) * 14.0 / hole_mm.max(0.1) } else { 0.0 };
            // Told apart, the facet before the exit ends the flesh.
            let slack_mm = 2.0 * sagitta_mm(10.0) * 10.0 / half_mm + rim_mm.min(2.0);
            assert!((s_mm - expected_mm).abs() < slack_mm, "{layers}, {aside_mm}: {s_mm} for {expected_mm}");
        }
    }
}

#[test]
fn light_that_has_crossed_a_gap_goes_on() {
    // Two fingers of 16 mm, 1 mm apart, in light along them both.
    let finger = |x| Object::new("finger", capsule(Vec3::new(x, 0.0, 0.0), 8.0, 14.0, 128), white());
    let scene = scene(vec![finger(-8.5), finger(8.5)], vec![sun(-Vec3::X)]);
    for i in 0..30 {
        let angle = 0.043 * (i as f32 + 0.31);
        let exit_mm = Vec3::new(8.5 + 8.0 * angle.cos(), 2.7, 8.0 * angle.sin());
        // As thick as a finger, twice; between them is what the circles leave of 17 mm.
        let chord_mm = 16.0 * angle.cos();
        for (layers, expected_mm) in [(1, 17.0 + chord_mm), (4, 2.0 * chord_mm)] {
            let settings = DepthAbsorptionSettings { layers, ..plain() };
            let s_mm = inside_mm(&scene, &settings, exit_mm).expect("light comes through");
            let slack_mm = 4.0 * sagitta_mm(8.0) / angle.cos();
            assert!((s_mm - expected_mm).abs() < slack_mm, "{layers}, {i}: {s_mm} for {expected_mm}");
        }
    }
}
