//! Pictures that follow each other, with other lights.

use super::artist::Artist;
use super::on_gpu::Devices;
use super::stage::Stage;
use super::{Desk, Painted, Wish};
use crate::backend::Backend;
use crate::view::look::{Drawing, Look};
use crate::view::shown::Shown;
use crate::view::tests::drive::backends;
use cutis_scene::head::HeadDetail;
use cutis_scene::studio;
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
    let painted = artist.paint(devices, wish, 0, Stage::Draft, &desk).expect("is drawn");
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
