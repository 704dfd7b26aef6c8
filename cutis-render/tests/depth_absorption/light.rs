//! What comes through, in pictures.

use crate::scenes::{draw, exitance, plain, plate, scene, settings, sun, white};
use cutis_render::prepare::ColourRamp;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint, FallOff};
use cutis_render::{CpuRenderer, Renderer, Settings, Silent};
use cutis_scene::validation::shapes::cuboid;
use cutis_scene::{ColourMap, Object, Texels, Texture};
use glam::Vec3;
use std::f32::consts::TAU;
use std::sync::Arc;

const SIGMA_T: Vec3 = Vec3::new(0.05, 0.2, 1.0);
/// What a way of 30 mm, each of whose numbers has a rounding or two, makes of the exponential; and of table and film.
const ROUNDING: f32 = 2e-5;

#[test]
fn a_plate_absorbs_by_its_thickness() {
    for thickness_mm in [0.3f32, 2.0, 8.0] {
        for entry in EntryPoint::ALL {
            let settings = DepthAbsorptionSettings { entry, ..plain() };
            let lit = scene(vec![plate(thickness_mm)], vec![sun(Vec3::new(0.6, 0.0, -0.8))]);
            let frame = draw(&lit, settings);
            let s_mm = thickness_mm / 0.8;
            let expected = (-SIGMA_T * s_mm).exp() * 0.8;
            let got = frame.layers[0].pixels[5].truncate();
            assert!((got - expected).abs().max_element() < ROUNDING, "{entry}, {thickness_mm} mm: {got}");
            assert!((frame.layers[1].pixels[5].x - s_mm).abs() < 3e-5, "the layer tells the distance");
        }
    }
}

#[test]
fn where_it_entered_counts_only_where_it_is_known() {
    // In by a side face, 12.5 mm before the front one.
    let cube = Object::new("cube", cuboid(Vec3::new(-10.0, 0.0, -20.0), Vec3::splat(20.0)), white());
    let mut lit = scene(vec![cube], vec![sun(Vec3::new(0.8, 0.0, -0.6))]);
    lit.camera.vertical_fov_rad = 1e-5;
    let left = (-SIGMA_T * 12.5).exp();
    for (entry, cos) in [(EntryPoint::Distance, 0.6), (EntryPoint::Surface, 0.8)] {
        let got = exitance(&lit, DepthAbsorptionSettings { entry, ..plain() });
        // The picture is 5 µm wide.
        assert!((got - left * cos).abs().max_element() < ROUNDING + 0.01 * 0.01, "{entry}: {got}");
    }
}

#[test]
fn light_takes_the_colour_of_where_it_entered() {
    let mut red = plate(2.0);
    red.material.albedo.factor = Vec3::new(1.0, 0.25, 0.0);
    red.mesh.positions_mm.iter_mut().for_each(|p| p.z -= 10.0);
    let lit = scene(vec![plate(4.0), red], vec![sun(-Vec3::Z)]);
    for (layers, s_mm) in [(1, 13.0), (4, 6.0)] {
        let left = (-SIGMA_T * s_mm).exp();
        // The film of a square root on the way in.
        for (entry, film) in
            [(EntryPoint::Surface, Vec3::new(1.0, 0.5, 0.0)), (EntryPoint::Distance, Vec3::ONE)]
        {
            let got = exitance(&lit, DepthAbsorptionSettings { entry, layers, ..plain() });
            assert!((got - left * film).abs().max_element() < ROUNDING, "{entry}, {layers}: {got}");
        }
    }
}

#[test]
fn a_ramp_gives_its_colour_at_the_distance() {
    let stops = vec![(0.0, Vec3::ONE), (2.0, Vec3::new(0.9, 0.4, 0.2)), (6.0, Vec3::new(0.1, 0.0, 0.0))];
    let fall_off = FallOff::Ramp(Arc::new(ColourRamp::new(stops).expect("is sound")));
    for (thickness_mm, expected) in
        [(1.0, Vec3::new(0.95, 0.7, 0.6)), (4.0, Vec3::new(0.5, 0.2, 0.1)), (9.0, Vec3::new(0.1, 0.0, 0.0))]
    {
        let lit = scene(vec![plate(thickness_mm)], vec![sun(-Vec3::Z)]);
        let got = exitance(&lit, DepthAbsorptionSettings { fall_off: fall_off.clone(), ..plain() });
        assert!((got - expected).abs().max_element() < ROUNDING, "{thickness_mm} mm: {got}");
    }
}

#[test]
fn a_scaled_plate_absorbs_by_its_scale() {
    for scale in [0.0, 0.5, 2.0] {
        let mut body = plate(3.0);
        body.material.thickness_scale = scale;
        let got = exitance(&scene(vec![body], vec![sun(-Vec3::Z)]), plain());
        // A scale of 0 leaves a micrometre.
        let expected = (-SIGMA_T * (3.0 * scale).max(1e-3)).exp();
        assert!((got - expected).abs().max_element() < ROUNDING, "{scale}: {got}");
    }
}

#[test]
fn lights_add_up() {
    let lights =
        [sun(Vec3::new(0.6, 0.0, -0.8)), sun(Vec3::new(0.0, -0.6, -0.8)), sun(Vec3::new(0.0, 0.6, 0.8))];
    let of = |lights: &[_]| exitance(&scene(vec![plate(2.0)], lights.to_vec()), plain());
    let apart: Vec3 = lights.iter().map(|light| of(std::slice::from_ref(light))).sum();
    let together = of(&lights);
    assert!((together - apart).abs().max_element() < ROUNDING, "{together} for {apart}");
    assert!(together.min_element() > 0.8, "the third is in front");
}

/// Length of the swing of a picture's rows at a wavelength, 1 for a cosine of 1.
fn swing(pixels: &[glam::Vec4], width: usize, per_row: f32) -> f32 {
    let wave = |x: usize| glam::Vec2::from_angle(TAU * per_row * (x as f32 + 0.5) / width as f32);
    let sum: glam::Vec2 = pixels.iter().enumerate().map(|(i, p)| wave(i % width) * p.x).sum();
    2.0 * sum.length() / pixels.len() as f32
}

#[test]
fn stripes_of_the_back_show_through_by_the_discs_own_factor() {
    // Eight stripes over the face towards the light, which has 0.2933 of the texture along u.
    let stripes = |x: usize| 0.5 + 0.5 * (TAU * 8.0 * (x as f32 + 0.5) / (0.293_333 * 1024.0)).cos();
    let texels = (0..1024).map(|x| [stripes(x), stripes(x), stripes(x), 1.0]).collect();
    let mut body = Object::new("plate", cuboid(Vec3::ZERO, Vec3::new(40.0, 40.0, 5.0)), white());
    body.material.albedo = ColourMap {
        factor: Vec3::ONE,
        texture: Some(Arc::new(Texture::new(1024, 1, Texels::LinearF32(texels)))),
    };
    // All of the colour on the way in.
    body.material.albedo_mix = 1.0;
    let mut lit = scene(vec![body], vec![sun(-Vec3::Z)]);
    lit.camera.position_mm.z = 5e4;
    // Four stripes of 10 mm to a row.
    lit.camera.vertical_fov_rad = 2.0 * (20.0f32 / 64.0 * 8.0 / (5e4 - 5.0)).atan();
    let seen = |samples, filter_radius_mm| {
        let fall_off = FallOff::Exponential(Vec3::ZERO);
        let depth = DepthAbsorptionSettings { samples, filter_radius_mm, fall_off, ..plain() };
        let settings = Settings { width: 64, height: 8, ..settings(depth) };
        let frame = CpuRenderer.render(&lit, &settings, &Silent).expect("draws");
        swing(&frame.layers[0].pixels, 64, 4.0)
    };
    let plain = seen(1, 0.0);
    assert!((plain - 0.5).abs() < 0.01, "without a filter the stripes are all there: {plain}");
    // The mean of a cosine over a disc is 2 J1(k r) / (k r), k = 2 pi / 10 mm.
    for (radius_mm, factor) in [(2.0, 0.814_2), (4.0, 0.390_0), (6.098_4, 0.0)] {
        let filtered = seen(64, radius_mm) / plain;
        // 512 pixels of 64 places each: R2 leaves an error of a few in 64, of either sign, 1/sqrt(512) of it on the mean; and
        // 0.5 % for the atlas of the texture.
        assert!((filtered - factor).abs() < 0.01, "{radius_mm} mm: {filtered} for {factor}");
    }
}
