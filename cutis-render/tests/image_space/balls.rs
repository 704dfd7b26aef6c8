//! Balls: what only the right areas give, and what must not show.

use crate::scenes::{ball_under_the_sky, draw, exitances, medium, settings};
use cutis_optics::sample::{DipoleSampler, RadialSampler};
use cutis_optics::{Dipole, Profile};
use cutis_render::technique::image_space::{ImageSpaceSettings, SampleCount};
use cutis_render::{Frame, Settings};
use glam::Vec3;
use std::f32::consts::PI;

/// On a ball the area within a chord r is pi r², as on the plane: under even light the middle of its face sends back what the
/// profile holds within the chord to its outline. Only with the right Jacobian does that come out.
#[test]
fn a_ball_under_even_light_sends_back_what_its_face_holds() {
    const RADIUS_MM: f32 = 4.0;
    let scene = ball_under_the_sky(RADIUS_MM, 256);
    let dipole = Dipole::new(&medium()).expect("is physical");
    let within = DipoleSampler::new(&dipole).cdf(RADIUS_MM * std::f32::consts::SQRT_2);
    let expected = std::f32::consts::PI * dipole.total() as f32 * within;
    let middle = |jacobian| {
        let own = ImageSpaceSettings {
            samples: 1024,
            uniform_samples: 512,
            jacobian,
            count: SampleCount::All,
            ..Default::default()
        };
        let frame = draw(&scene, &Settings { width: 64, height: 64, ..settings(own) });
        let pixels = [31 * 64 + 31, 31 * 64 + 32, 32 * 64 + 31, 32 * 64 + 32];
        pixels.map(|i| frame.layers[0].pixels[i].x).iter().sum::<f32>() / 4.0
    };
    let (with, without) = (middle(true), middle(false));
    eprintln!("ball: {with}, without Jacobian {without}, expected {expected}");
    // Six thousand places for the mean: 1 % of noise; facets of 1.4 degrees and the outline, whose area is cut at eight times.
    assert!((with / expected - 1.0).abs() < 0.02, "{with} against {expected}");
    assert!(without / expected < 0.93, "{without} against {expected}");
}

/// Pixels where nothing but the ball is seen.
fn covered(frame: &Frame) -> Vec<Vec3> {
    let is_covered = |i: &usize| frame.pixels[*i].w > 0.999;
    let all = exitances(frame);
    (0..all.len()).filter(is_covered).map(|i| all[i]).collect()
}

/// Even at its contour, where samples are seen much nearer than they were drawn, a ball sends back no more than twice what a
/// plane would, and no more than a plane without the Jacobian: no specks.
#[test]
fn no_speck_is_brighter_than_what_was_drawn() {
    let even = PI * Dipole::new(&medium()).expect("is physical").total() as f32;
    for (jacobian, most) in [(true, 2.0), (false, 1.0)] {
        for count in SampleCount::ALL {
            let own =
                ImageSpaceSettings { samples: 4, uniform_samples: 0, jacobian, count, ..Default::default() };
            let frame =
                draw(&ball_under_the_sky(4.0, 64), &Settings { width: 64, height: 64, ..settings(own) });
            let brightest = covered(&frame).iter().fold(0.0f32, |most, e| most.max(e.x));
            assert!(brightest < 1.001 * most * even, "{jacobian} {count}: {brightest} of {even}");
        }
    }
}

/// Without the Jacobian triangles that are smaller than light spreads do not show: planes follow the smooth surface. Compared along a ring
/// of the face, where a round ball is the same all around.
#[test]
fn triangles_do_not_show_without_the_jacobian() {
    const SIZE: usize = 96;
    let own = ImageSpaceSettings {
        samples: 1024,
        uniform_samples: 0,
        jacobian: false,
        count: SampleCount::All,
        ..Default::default()
    };
    let picture = Settings { width: SIZE as u32, height: SIZE as u32, ..settings(own) };
    let pixels = exitances(&draw(&ball_under_the_sky(10.0, 48), &picture));
    let from_middle = |i: usize| ((i % SIZE) as f32 - 47.5).hypot((i / SIZE) as f32 - 47.5);
    let on_ring = |i: &usize| (from_middle(*i) - 24.0).abs() < 1.0;
    let ring: Vec<f32> = (0..pixels.len()).filter(on_ring).map(|i| pixels[i].x).collect();
    let mean = ring.iter().sum::<f32>() / ring.len() as f32;
    let variance = ring.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / ring.len() as f32;
    let unevenness = variance.sqrt() / mean;
    eprintln!("unevenness along a ring: {unevenness}");
    // With planes of triangles it is 0.0105; 0.0031 as it is, of which noise of the samples is most.
    assert!(unevenness < 0.006, "{unevenness}");
}
