//! What a device refuses is an error in words and no panic. Each test has a device of its own, for refusals are told once.

mod common;

use common::{head_in_the_studio, renderer};
use cutis_gpu::map::Map;
use cutis_gpu::scene::SceneError;
use cutis_gpu::scene::development::Developing;
use cutis_gpu::{Adapters, Gpu, GpuError};
use cutis_render::film::Film;
use cutis_render::{Settings, Silent};
use wgpu::TextureFormat as Format;

fn own_gpu(test: &str) -> Option<Gpu> {
    renderer(test).map(|_| Gpu::find(Adapters::Any).expect("was there a moment ago"))
}

#[test]
fn a_mistake_is_told_once_in_one_line() {
    let Some(gpu) = own_gpu("a_mistake_is_told_once_in_one_line") else { return };
    assert_eq!(gpu.check(), Ok(()));
    let _refused = Map::square(&gpu, "much too wide", 1 << 20, 1, Format::R8Unorm);
    let error = gpu.wait().expect_err("is refused");
    let words = error.to_string();
    assert!(matches!(error, GpuError::Refused { .. }), "{error:?}");
    assert!(words.starts_with("the graphics adapter refused an order: ") && words.contains("much too wide"));
    assert!(!words.contains('\n'), "{words}");
    assert_eq!(gpu.wait(), Ok(()), "is told once");
}

#[test]
fn a_mistake_before_a_frame_is_told_by_the_frame() {
    let test = "a_mistake_before_a_frame_is_told_by_the_frame";
    let Some(gpu) = own_gpu(test) else { return };
    let own = cutis_gpu::GpuRenderer::with_gpu(gpu);
    let small = Settings { width: 16, height: 16, irradiance_size: 64, ..Settings::default() };
    let ready = own.scene(&head_in_the_studio(), &small, &Silent).expect("is uploaded");
    ready.draw(&own.gpu).expect("is drawn");
    let _refused = Map::square(&own.gpu, "much too wide", 1 << 20, 1, Format::R8Unorm);
    assert!(matches!(ready.draw(&own.gpu), Err(GpuError::Refused { .. })));
    ready.draw(&own.gpu).expect("is drawn again");
    assert!(ready.picture(&own.gpu).is_ok());
}

#[test]
fn more_than_there_is_room_for_is_told_with_advice() {
    let Some(gpu) = own_gpu("more_than_there_is_room_for_is_told_with_advice") else { return };
    // As large as a texture may be: 8192² texels of 16 bytes in 256 layers are 256 GiB.
    let asking = gpu.counting();
    let _refused = Map::square(&asking, "everything", 8192, 256, Format::Rgba32Float);
    let error = asking.check().expect_err("no machine has that");
    assert_eq!(error, GpuError::OutOfMemory { asked_bytes: 1 << 38 });
    let words = error.to_string();
    assert!(words.contains("262144 MiB") && words.contains("--quality low"), "{words}");
}

#[test]
fn a_picture_larger_than_a_texture_is_told_before_any_work() {
    let test = "a_picture_larger_than_a_texture_is_told_before_any_work";
    let Some(renderer) = renderer(test) else { return };
    let huge = Settings { width: 8192, height: 8, samples_per_pixel: 4, ..Settings::default() };
    let error = renderer.scene(&head_in_the_studio(), &huge, &Silent).expect_err("is too large");
    let words = error.to_string();
    assert_eq!(words, "the picture is 16384 × 16 samples, more than the 8192 this graphics adapter takes");
}

#[test]
fn a_scene_counts_what_it_asks_for() {
    let Some(gpu) = own_gpu("a_scene_counts_what_it_asks_for") else { return };
    let counting = gpu.counting();
    let _map = Map::square(&counting, "map", 16, 3, Format::Rgba16Float);
    let _numbers = counting.storage("numbers", &[0u32; 5]);
    assert_eq!(counting.asked_bytes(), 16 * 16 * 3 * 8 + 5 * 4);
    assert_eq!(gpu.asked_bytes(), 0, "counts are apart");
}

#[test]
fn a_lost_device_is_told_in_words_again_and_again() {
    let Some(gpu) = own_gpu("a_lost_device_is_told_in_words_again_and_again") else { return };
    let own = cutis_gpu::GpuRenderer::with_gpu(gpu);
    let small = Settings { width: 16, height: 16, irradiance_size: 64, ..Settings::default() };
    let mut ready = own.scene(&head_in_the_studio(), &small, &Silent).expect("is uploaded");
    let how = Developing { film: Film::default(), behind: 0.0 };
    ready.set_film(&own.gpu, &own.passes, how).expect("is laid");
    ready.draw(&own.gpu).expect("is drawn");
    // A device that is closed ends its work first.
    own.gpu.wait().expect("is done");
    own.gpu.device.destroy();
    let is_lost = |result: Result<(), GpuError>, what: &str| {
        let error = result.expect_err(what);
        assert!(matches!(error, GpuError::Lost { .. }), "{what}: {error:?}");
        let words = error.to_string();
        assert!(words.starts_with("the graphics adapter gave up: ") && words.len() > 32, "{what}: {words}");
    };
    for _ in 0..2 {
        is_lost(ready.draw(&own.gpu), "draw");
        is_lost(ready.draw_timed(&own.gpu).map(drop), "draw timed");
        is_lost(ready.look_timed(&own.gpu).map(drop), "look");
        is_lost(ready.picture(&own.gpu).map(drop), "picture");
        is_lost(ready.develop_timed(&own.gpu).map(drop), "develop");
        is_lost(ready.developed(&own.gpu).map(drop), "codes");
        is_lost(own.gpu.wait(), "wait");
    }
    let again = own.scene(&head_in_the_studio(), &small, &Silent).map(drop);
    assert!(matches!(again, Err(SceneError::Gpu(GpuError::Lost { .. }))), "{again:?}");
}
