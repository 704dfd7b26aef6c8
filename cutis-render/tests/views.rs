//! Layers that show how a picture was made: seams, samples, places of lights that were tried.

use cutis_render::{Aov, AovSpace, CpuRenderer, Frame, Renderer, Settings, Silent};
use cutis_scene::head::HeadDetail;
use cutis_scene::{Scene, studio};

fn head_in_the_studio() -> Scene {
    studio::head_in_the_studio(HeadDetail { triangles: 4000, map_size: 0 })
}

fn drawn(scene: &Scene, aov: Aov, aov_space: AovSpace) -> Frame {
    let (width, height, irradiance_size) = (96, 80, 256);
    let settings =
        Settings { width, height, irradiance_size, aovs: vec![aov], aov_space, ..Settings::default() };
    CpuRenderer.render(scene, &settings, &Silent).expect("draws")
}

#[test]
fn seams_lie_where_charts_meet_and_tell_their_mismatch() {
    let scene = head_in_the_studio();
    let texture = &drawn(&scene, Aov::Seams, AovSpace::Texture).layers[0];
    let charts = &drawn(&scene, Aov::Charts, AovSpace::Texture).layers[0];
    let lines = texture.pixels.iter().filter(|p| p.y == 1.0).count();
    let inside = charts.pixels.iter().filter(|p| p.x >= 0.0).count();
    assert!(lines > 200 && lines < inside / 4, "{lines} of {inside} texels");
    let off_lines = |i: usize| texture.pixels[i].y != 1.0 || charts.pixels[i].x < 0.0;
    assert!((0..charts.pixels.len()).filter(|&i| off_lines(i)).all(|i| texture.pixels[i].x == 0.0));
    assert!(texture.pixels.iter().any(|p| p.x > 0.01), "the light of this head is known to differ");
    let picture = &drawn(&scene, Aov::Seams, AovSpace::Picture).layers[0];
    assert!(picture.pixels.iter().any(|p| p.y > 0.0), "some seam is seen");
    assert!(picture.pixels.iter().all(|p| (0.0..=1.0).contains(&p.y) && p.x.is_finite()));
}

#[test]
fn samples_are_counted_pixel_by_pixel() {
    let layer = &drawn(&head_in_the_studio(), Aov::Samples, AovSpace::Picture).layers[0];
    assert!(layer.pixels.iter().all(|p| p.y == 4.0 && p.x <= p.y), "four are taken everywhere");
    let shaded = |count: f32| layer.pixels.iter().filter(|p| p.x == count).count();
    assert!(shaded(0.0) > 100, "beside the head nothing is shaded");
    assert!(shaded(1.0) > 100, "close together, one stands for all");
    assert!((2..=4).any(|n| shaded(n as f32) > 0), "at the silhouette every sample counts");
    assert!(drawn(&head_in_the_studio(), Aov::Samples, AovSpace::Texture).layers.is_empty());
}

#[test]
fn rays_are_spent_at_the_edges_of_shadows() {
    let scene = head_in_the_studio();
    let layer = &drawn(&scene, Aov::ShadowSamples, AovSpace::Texture).layers[0];
    let most = (scene.lights.len() as u32 * Settings::default().shadow_samples) as f32;
    assert!(layer.pixels.iter().all(|p| p.x <= most && p.x % 4.0 == 0.0), "four rays for each light");
    let (asked, none): (Vec<f32>, Vec<f32>) = layer.pixels.iter().map(|p| p.x).partition(|&x| x > 0.0);
    assert!(asked.len() > 100 && none.len() > 2 * asked.len(), "{} against {}", asked.len(), none.len());
    let picture = &drawn(&scene, Aov::ShadowSamples, AovSpace::Picture).layers[0];
    assert!(picture.pixels.iter().any(|p| p.x > 0.0));
    let mut dark = scene.clone();
    dark.lights.clear();
    let layer = &drawn(&dark, Aov::ShadowSamples, AovSpace::Texture).layers[0];
    assert!(layer.pixels.iter().all(|p| p.x == 0.0), "without lights nothing is tried");
}
