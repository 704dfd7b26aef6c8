//! Pictures that follow each other: with other lights, and on a device that was lost between them.

use super::artist::Artist;
use super::on_gpu::Devices;
use super::stage::Stage;
use super::{Desk, Painted, Wish};
use crate::backend::Backend;
use crate::view::look::{Drawing, Look};
use crate::view::shown::Shown;
use crate::view::tests::drive::backends;
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::TechniqueName;
use cutis_scene::head::HeadDetail;
use cutis_scene::studio;
use glam::DVec4;
use std::sync::Arc;

fn wish(backend: Backend) -> Wish {
    let scene = studio::head_in_the_studio(HeadDetail { triangles: 4000, map_size: 64 });
    let drawing = Drawing { backend, irradiance_size: 128, ..Drawing::default() };
    Wish {
        number: 1,
        looks: vec![Look::of(&scene, drawing)],
        scene: Arc::new(scene),
        size: [64, 64],
        shown: Shown::default(),
        is_for_a_file: false,
    }
}

fn draft(artist: &mut Artist, devices: &mut Devices, wish: &Wish) -> Painted {
    let desk = Desk { wishes: Arc::default(), news: Arc::default(), context: Default::default() };
    let painted = artist.paint(devices, wish, 0, (Stage::Draft, 0), &desk).expect("is drawn");
    painted.expect("drafts are drawn to their end")
}

fn has_adapter(test: &str) -> bool {
    backends(test).contains(&Backend::Gpu)
}

#[test]
fn other_lights_need_no_new_scene_and_another_number_of_them_does() {
    if !has_adapter("other_lights_need_no_new_scene_and_another_number_of_them_does") {
        return;
    }
    let (mut artist, mut devices, mut wish) = (Artist::default(), Devices::default(), wish(Backend::Gpu));
    let mut lights_after = |change: fn(&mut Look)| {
        change(&mut wish.looks[0]);
        draft(&mut artist, &mut devices, &wish);
        artist.gpu.scene().expect("is kept").shared.lights.clone()
    };
    let first = lights_after(|_| {});
    assert!(first == lights_after(|look| look.lights[0].turn_degrees = 40.0), "a turned light");
    assert!(first == lights_after(|look| look.surroundings.turn_degrees = 40.0), "turned surroundings");
    assert!(first == lights_after(|look| look.surroundings.strength = 2.0), "brighter surroundings");
    assert!(first != lights_after(|look| look.lights[0].on = false), "one light less");
}

#[test]
fn the_next_picture_is_drawn_on_a_device_that_is_opened_anew() {
    if !has_adapter("the_next_picture_is_drawn_on_a_device_that_is_opened_anew") {
        return;
    }
    let (mut artist, mut devices, wish) = (Artist::default(), Devices::default(), wish(Backend::Gpu));
    let before = draft(&mut artist, &mut devices, &wish);
    let lost = devices.renderer(Backend::Gpu).expect("is open");
    lost.gpu.device.destroy();
    let after = draft(&mut artist, &mut devices, &wish);
    assert!(after.image == before.image, "the same picture");
    let opened = devices.renderer(Backend::Gpu).expect("is open");
    assert!(!Arc::ptr_eq(&lost, &opened), "another device");
}

#[test]
fn auto_goes_to_the_processor_and_says_why() {
    let test = "auto_goes_to_the_processor_and_says_why";
    if !has_adapter(test) {
        return;
    }
    if GpuRenderer::new(Adapters::Hardware).is_ok() {
        eprintln!("SKIPPED: {test}: a graphics processor would be opened anew");
        return;
    }
    let (mut artist, wish) = (Artist::default(), wish(Backend::Auto));
    let stand_in = Arc::new(GpuRenderer::new(Adapters::Any).expect("was there a moment ago"));
    let mut devices = Devices::with_hardware(Arc::clone(&stand_in));
    let before = draft(&mut artist, &mut devices, &wish);
    assert!(before.frame.warnings.iter().all(|warning| !warning.contains("processor")));
    stand_in.gpu.device.destroy();
    let after = draft(&mut artist, &mut devices, &wish);
    let told = after.frame.warnings.last().expect("something is told");
    assert!(told.starts_with("drawn on the processor, because there is no graphics adapter"), "{told}");
}

#[test]
fn rounds_are_the_exact_mean_of_their_pictures_and_another_look_begins_anew() {
    for backend in backends("rounds_are_the_exact_mean_of_their_pictures_and_another_look_begins_anew") {
        let mut wish = wish(backend);
        wish.size = [24, 20];
        wish.looks[0].drawing.technique = TechniqueName::ImageSpace;
        let desk = Desk { wishes: Arc::default(), news: Arc::default(), context: Default::default() };
        // One device for all: on another one the scene would be uploaded anew, with the round in it.
        let mut devices = Devices::default();
        let mut paint = |artist: &mut Artist, wish: &Wish, round: u32| {
            let painted = artist.paint(&mut devices, wish, 0, (Stage::Fine, round), &desk);
            painted.expect("is drawn").expect("is wanted")
        };
        let mut artist = Artist::default();
        let means: Vec<_> = (0..4).map(|round| paint(&mut artist, &wish, round)).collect();
        // One who has drawn no other round shows each as it is.
        let alone: Vec<_> = (0..4).map(|round| paint(&mut Artist::default(), &wish, round)).collect();
        assert!(
            alone[0].frame.pixels != alone[3].frame.pixels,
            "{backend}: rounds have patterns of their own"
        );
        for (i, pixel) in means[3].frame.pixels.iter().enumerate() {
            let sum: DVec4 = alone.iter().map(|painted| painted.frame.pixels[i].as_dvec4()).sum();
            assert_eq!(*pixel, (sum / 4.0).as_vec4(), "{backend}, pixel {i}");
        }
        let words: Vec<_> = means.iter().map(|painted| painted.quality.as_str()).collect();
        assert_eq!(words, ["fine", "fine, 2 of 64 rounds", "fine, 3 of 64 rounds", "fine, 4 of 64 rounds"]);
        assert!(means.iter().all(|painted| !painted.is_final), "there are more to come");
        wish.looks[0].skin.roughness = 0.5;
        let (again, fresh) = (paint(&mut artist, &wish, 0), paint(&mut Artist::default(), &wish, 0));
        assert_eq!(again.frame.pixels, fresh.frame.pixels, "{backend}: nothing is left of the look before");
        wish.is_for_a_file = true;
        assert!(paint(&mut artist, &wish, 0).is_final, "a picture of a turn has one round");
    }
}
