//! Layers that show how a picture was made, on both backends.

mod common;

use common::{head_in_the_studio, renderer, tolerances};
use cutis_gpu::GpuRenderer;
use cutis_render::{Aov, AovSpace, CpuRenderer, Diffusion, Layer, Renderer, Settings, Silent};
use cutis_scene::{Light, Scene};

fn settings(aov: Aov, aov_space: AovSpace) -> Settings {
    let aovs = vec![aov];
    Settings {
        width: 96,
        height: 80,
        irradiance_size: 256,
        shadow_samples: 8,
        // By heat flow seams hardly show, and what 16 bits leave of them is rounding.
        diffusion: Diffusion::Separable,
        aovs,
        aov_space,
        ..Settings::default()
    }
}

fn on_gpu(renderer: &GpuRenderer, scene: &Scene, aov: Aov, space: AovSpace) -> Layer {
    renderer.render(scene, &settings(aov, space), &Silent).expect("draws").layers.remove(0)
}

fn on_cpu(scene: &Scene, aov: Aov, space: AovSpace) -> Layer {
    CpuRenderer.render(scene, &settings(aov, space), &Silent).expect("draws").layers.remove(0)
}

#[test]
fn the_charts_of_a_texture_are_those_of_the_processor() {
    let Some(renderer) = renderer("the_charts_of_a_texture_are_those_of_the_processor") else { return };
    let scene = head_in_the_studio();
    let [gpu, cpu] = [
        on_gpu(renderer, &scene, Aov::Charts, AovSpace::Texture),
        on_cpu(&scene, Aov::Charts, AovSpace::Texture),
    ];
    assert!(cpu.pixels.iter().any(|p| p.x > 0.0), "there are several");
    assert!(gpu.pixels == cpu.pixels, "some texel lies in another chart");
}

#[test]
fn seams_are_those_of_the_processor() {
    let Some(renderer) = renderer("seams_are_those_of_the_processor") else { return };
    let scene = head_in_the_studio();
    let [gpu, cpu] = [
        on_gpu(renderer, &scene, Aov::Seams, AovSpace::Texture),
        on_cpu(&scene, Aov::Seams, AovSpace::Texture),
    ];
    let same_lines = gpu.pixels.iter().zip(&cpu.pixels).all(|(g, c)| g.y == c.y);
    assert!(same_lines, "charts meet at the same places");
    let total = |layer: &Layer| layer.pixels.iter().map(|p| p.x).sum::<f32>();
    let apart: f32 = gpu.pixels.iter().zip(&cpu.pixels).map(|(g, c)| (g.x - c.x).abs()).sum();
    let apart = apart / total(&cpu);
    eprintln!("mismatch: {} against {}, {apart} apart", total(&gpu), total(&cpu));
    assert!(apart < tolerances::SEAMS, "{apart}");
    let picture = on_gpu(renderer, &scene, Aov::Seams, AovSpace::Picture);
    assert!(picture.pixels.iter().any(|p| p.y > 0.5 && p.x > 0.0), "some seam is seen");
}

#[test]
fn all_samples_that_meet_the_surface_are_shaded() {
    let Some(renderer) = renderer("all_samples_that_meet_the_surface_are_shaded") else { return };
    let layer = on_gpu(renderer, &head_in_the_studio(), Aov::Samples, AovSpace::Picture);
    assert!(layer.pixels.iter().all(|p| p.y == 4.0 && p.x.fract() == 0.0 && p.x <= p.y));
    for shaded in [0.0, 4.0] {
        assert!(layer.pixels.iter().filter(|p| p.x == shaded).count() > 100, "{shaded}");
    }
}

#[test]
fn places_of_a_light_are_tried_where_something_may_hide_it() {
    let Some(renderer) = renderer("places_of_a_light_are_tried_where_something_may_hide_it") else { return };
    let mut scene = head_in_the_studio();
    let tried = |scene: &Scene| on_gpu(renderer, scene, Aov::ShadowSamples, AovSpace::Texture).pixels;
    // Twelve in search of what may hide each light, and sixteen of its disc if something may: eight would be too few here.
    let counts: Vec<_> = tried(&scene).iter().map(|p| p.x).collect();
    let possible = [0.0, 12.0, 24.0, 28.0, 40.0, 56.0];
    let strange: Vec<_> = counts.iter().filter(|count| !possible.contains(count)).collect();
    assert!(strange.is_empty(), "{} texels: {:?}", strange.len(), strange.first());
    assert!(possible.iter().all(|wanted| counts.iter().filter(|count| *count == wanted).count() > 50));
    for light in &mut scene.lights {
        match light {
            Light::Point { radius_mm, .. } | Light::Spot { radius_mm, .. } => *radius_mm = 0.0,
            Light::Projector(projector) => projector.radius_mm = 0.0,
            Light::Directional { angular_radius_rad, .. } => *angular_radius_rad = 0.0,
        }
    }
    assert!(tried(&scene).iter().all(|p| p.x <= 2.0), "a light without extent is one place");
    let dark = Scene { lights: Vec::new(), ..scene.clone() };
    assert!(tried(&dark).iter().all(|p| p.x == 0.0), "without a light no place is tried");
    // Five lights are two groups.
    let light = scene.lights[0].clone();
    scene.lights.extend([light.clone(), light.clone(), light]);
    let counts = tried(&scene);
    assert!(counts.iter().any(|p| p.x >= 4.0) && counts.iter().all(|p| p.x <= 5.0));
    let picture = on_gpu(renderer, &scene, Aov::ShadowSamples, AovSpace::Picture);
    assert!(picture.pixels.iter().any(|p| p.x >= 4.0));
}
