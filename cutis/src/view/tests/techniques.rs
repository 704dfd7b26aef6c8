//! Techniques in the window: their keys, their panels, what is remembered of them, and pictures that get better.

use super::drive::{Window, backends, key_of, press, settle, window};
use crate::backend::Backend;
use crate::scene_source::SceneSource;
use crate::techniques::paper::Paper;
use crate::view::app::Viewer;
use crate::view::painter::Painted;
use cutis_render::{CpuRenderer, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::Scene;
use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use glam::Vec4;

/// Small enough for pictures that are drawn many times.
const TINY: [f32; 2] = [60.0, 40.0];
/// Titles of the panels.
const TITLES: [(TechniqueName, &str); 4] = [
    (TechniqueName::Wrap, "Wrap (Green 2004)"),
    (TechniqueName::DepthAbsorption, "Depth absorption (Green 2004)"),
    (TechniqueName::TextureBlur, "Texture blur (Green 2004)"),
    (TechniqueName::ImageSpace, "Image space (Mertens et al. 2003)"),
];

fn painted(window: &Window) -> &Painted {
    window.state().sides[0].painted.as_ref().expect("something is drawn")
}

/// Waits for something that the painter brings.
fn wait(window: &mut Window, what: &str, is_there: impl Fn(&Viewer) -> bool) {
    let start = std::time::Instant::now();
    while !is_there(window.state()) {
        assert!(start.elapsed().as_secs() < 120, "{what}");
        std::thread::sleep(std::time::Duration::from_millis(2));
        window.step();
    }
}

#[test]
fn every_technique_has_a_key_a_picture_and_a_panel() {
    for backend in backends("every_technique_has_a_key_a_picture_and_a_panel") {
        let mut window = window([420.0, 900.0], backend);
        window.state_mut().size = Some([48, 40]);
        let mut pictures: Vec<(TechniqueName, Vec<u8>)> = Vec::new();
        for &technique in TechniqueName::ALL.iter().filter(|one| **one != TechniqueName::Truth) {
            press(&mut window, key_of(technique));
            let words = format!("no picture of {technique}");
            wait(&mut window, &words, |viewer| {
                let painted = viewer.sides[0].painted.as_ref();
                painted.is_some_and(|p| p.technique == technique && p.quality.starts_with("fine"))
            });
            assert!(window.state().failure(0).is_none(), "{backend}, {technique}");
            let image = &painted(&window).image;
            assert_eq!(image.size, [48, 40], "the size that was chosen");
            let bytes: Vec<u8> = image.pixels.iter().flat_map(|p| p.to_array()).collect();
            assert!(bytes.chunks(4).any(|p| p[0] > 100), "{backend}, {technique}: a head is seen");
            let twin = pictures.iter().find(|(_, other)| *other == bytes);
            assert!(twin.is_none(), "{backend}: {technique} looks like {:?}", twin.map(|(name, _)| name));
            for (owner, title) in TITLES {
                assert_eq!(
                    window.query_by_label(title).is_some(),
                    owner == technique,
                    "{title} at {technique}"
                );
            }
            pictures.push((technique, bytes));
        }
    }
}

#[test]
fn an_adapter_that_does_not_know_a_technique_leaves_it_to_the_processor_in_words() {
    let mut window = window(TINY, Backend::Gpu);
    press(&mut window, Key::H);
    press(&mut window, key_of(TechniqueName::Truth));
    wait(&mut window, "no truth", |viewer| {
        viewer.sides[0].painted.as_ref().is_some_and(|p| p.technique == TechniqueName::Truth)
    });
    assert!(window.state().failure(0).is_none(), "{:?}", window.state().failure(0));
    assert!(painted(&window).machine.contains("threads"), "{}", painted(&window).machine);
}

#[test]
fn numbers_are_remembered_while_others_draw_and_each_side_has_its_own() {
    let mut window = window([420.0, 300.0], Backend::Cpu);
    press(&mut window, key_of(TechniqueName::Wrap));
    window.state_mut().looks[0].drawing.techniques.wrap.wrap = 0.7;
    press(&mut window, key_of(TechniqueName::TextureBlur));
    window.state_mut().looks[0].drawing.techniques.texture_blur.passes = 5;
    press(&mut window, key_of(TechniqueName::Wrap));
    let techniques = |window: &Window, side: usize| window.state().looks[side].drawing.techniques.clone();
    assert_eq!(techniques(&window, 0).wrap.wrap, 0.7);
    assert_eq!(techniques(&window, 0).texture_blur.passes, 5);
    press(&mut window, Key::S);
    window.state_mut().edited = 1;
    press(&mut window, key_of(TechniqueName::Wrap));
    window.state_mut().looks[1].drawing.techniques.wrap.wrap = 0.1;
    window.step();
    assert_eq!((techniques(&window, 0).wrap.wrap, techniques(&window, 1).wrap.wrap), (0.7, 0.1));
}

#[test]
fn a_number_of_a_technique_changes_its_picture_and_no_other() {
    let mut window = window(TINY, Backend::Cpu);
    press(&mut window, Key::H);
    press(&mut window, key_of(TechniqueName::Wrap));
    settle(&mut window);
    let (before, number) = (painted(&window).image.clone(), painted(&window).number);
    window.state_mut().looks[0].drawing.techniques.wrap.wrap = 0.9;
    settle(&mut window);
    assert!(painted(&window).image != before, "nothing has changed");
    window.state_mut().looks[0].drawing.techniques.wrap.wrap = 0.2;
    settle(&mut window);
    assert!(painted(&window).image == before && painted(&window).number > number, "back where it was");
    let number = painted(&window).number;
    window.state_mut().looks[0].drawing.techniques.image_space.samples = 9;
    settle(&mut window);
    assert_eq!(painted(&window).number, number, "nothing is drawn anew for a technique that does not draw");
}

#[test]
fn buttons_bring_back_the_defaults_and_the_papers() {
    let mut window = window([900.0, 2400.0], Backend::Cpu);
    window.state_mut().size = Some([8, 8]);
    let click = |window: &mut Window, label: &str| {
        window.get_by_label(label).click();
        window.run_steps(3);
    };
    press(&mut window, key_of(TechniqueName::TextureBlur));
    window.state_mut().looks[0].drawing.techniques.texture_blur.passes = 5;
    window.state_mut().looks[0].drawing.techniques.wrap.wrap = 0.7;
    window.run_steps(3);
    click(&mut window, Paper::Green2004.title());
    let usual = cutis_render::settings::TechniqueSettings::default();
    let green = Paper::Green2004.settings(usual.clone());
    assert_eq!(window.state().looks[0].drawing.techniques.texture_blur, green.texture_blur);
    assert_eq!(window.state().looks[0].drawing.techniques.wrap.wrap, 0.7, "another technique's stay");
    click(&mut window, "reset all");
    assert_eq!(window.state().looks[0].drawing.techniques.texture_blur, usual.texture_blur);
    press(&mut window, key_of(TechniqueName::ImageSpace));
    window.run_steps(3);
    click(&mut window, Paper::Mertens2003.title());
    let (state, mertens) = (window.state(), Paper::Mertens2003.settings(usual));
    let look = &state.looks[0];
    assert_eq!(look.drawing.techniques.image_space, mertens.image_space);
    assert_eq!((state.size, look.skin.preset.as_deref()), (Some([500, 500]), Some("skin1")));
    let side_mm = state.scene.longest_side_mm().expect("a head");
    assert_eq!(look.skin.free_path, [side_mm / 100.0; 3]);
}

#[test]
fn a_picture_with_a_pattern_is_drawn_again_until_all_rounds_are_in_the_mean() {
    for backend in backends("a_picture_with_a_pattern_is_drawn_again_until_all_rounds_are_in_the_mean") {
        let mut window = window(TINY, backend);
        press(&mut window, Key::H);
        press(&mut window, key_of(TechniqueName::ImageSpace));
        settle(&mut window);
        assert_eq!(painted(&window).quality, "fine, 64 of 64 rounds");
        assert!(painted(&window).is_final);
        // Something else is wanted in the middle of it: it begins anew, and ends at once where nothing has a pattern.
        window.state_mut().looks[0].skin.roughness = 0.7;
        let changed = painted(&window).number + 1;
        wait(&mut window, "no rounds", |viewer| {
            let painted = viewer.sides[0].painted.as_ref();
            painted.is_some_and(|p| p.number == changed && p.quality.ends_with("of 64 rounds"))
        });
        assert!(!window.state().is_settled(), "{}", painted(&window).quality);
        press(&mut window, key_of(TechniqueName::TextureSpace));
        settle(&mut window);
        assert_eq!((painted(&window).quality.as_str(), painted(&window).is_final), ("fine", true));
        assert!(!window.ctx.has_requested_repaint(), "an idle window is not drawn again");
    }
}

/// Only ratios of lengths count: a scene scaled down in a material is the scene with longer free paths. Both are drawn from
/// the same random numbers; what is left are roundings of f32, which move a hit over an edge here and there.
#[test]
fn a_head_of_10_cm_looks_like_a_mean_free_path_that_is_as_much_longer() {
    let mut window = window(TINY, Backend::Cpu);
    let viewer = window.state_mut();
    viewer.looks[0].drawing.technique = TechniqueName::ImageSpace;
    viewer.draw_as_in(Paper::Mertens2003);
    let (look, stage) = (&viewer.looks[0], Paper::Mertens2003.stage().expect("it tells"));
    let large = look.applied_to(&viewer.scene).expect("is sound");
    let source = SceneSource {
        material: Some(stage.material.to_owned()),
        longest_side_mm: Some(stage.longest_side_mm),
        time_s: 0.0,
        ..viewer.source.clone()
    };
    let small = source.load().expect("is sound");
    for technique in [TechniqueName::ImageSpace, TechniqueName::TextureSpace] {
        let techniques = look.drawing.techniques.clone();
        let settings = Settings {
            technique,
            techniques,
            width: 48,
            height: 40,
            irradiance_size: 128,
            ..Settings::default()
        };
        let draw = |scene: &Scene| CpuRenderer.render(scene, &settings, &Silent).expect("is drawn").pixels;
        let (a, b) = (draw(&large), draw(&small));
        let sum = |pixels: &[Vec4]| pixels.iter().map(|p| p.truncate().element_sum()).sum::<f32>();
        let off: f32 = a.iter().zip(&b).map(|(a, b)| (*a - *b).truncate().abs().element_sum()).sum();
        assert!(off < 1e-3 * sum(&a), "{technique}: {} of the mean", off / sum(&a));
    }
}
