//! Frames ask the device for nothing once the first has been drawn.

mod common;

use common::{head_in_the_studio, renderer};
use cutis_gpu::scene::development::Developing;
use cutis_gpu::{Gpu, GpuScene};
use cutis_render::film::Film;
use cutis_render::{Settings, Silent};

/// Frames drawn.
const FRAMES: u32 = 20;

/// Allocations of the device's memory and their bytes, where the driver's allocator tells them.
fn allocated(gpu: &Gpu) -> Option<(usize, u64, u64)> {
    let report = gpu.device.generate_allocator_report()?;
    Some((report.allocations.len(), report.total_allocated_bytes, report.total_reserved_bytes))
}

fn draw(gpu: &Gpu, ready: &GpuScene, frames: u32) {
    for _ in 0..frames {
        ready.draw(gpu).expect("is drawn");
        gpu.wait().expect("is done");
    }
}

#[test]
fn a_frame_asks_the_device_for_nothing() {
    let test = "a_frame_asks_the_device_for_nothing";
    if renderer(test).is_none() {
        return;
    }
    // A device of its own: other tests ask for memory at the same time.
    let own = cutis_gpu::GpuRenderer::new(cutis_gpu::Adapters::Any).expect("was there a moment ago");
    let settings = Settings { width: 64, height: 48, irradiance_size: 128, ..Settings::default() };
    let mut ready = own.scene(&head_in_the_studio(), &settings, &Silent).expect("is uploaded");
    let how = Developing { film: Film::default(), behind: 0.02 };
    ready.set_film(&own.gpu, &own.passes, how).expect("is laid");
    // The first frames follow the geometry, and return what the upload has borrowed.
    draw(&own.gpu, &ready, 2);
    let counting = own.gpu.counting();
    let before = allocated(&own.gpu);
    // Not every driver tells.
    assert!(before.is_none_or(|(count, bytes, _)| count > 50 && bytes > 1 << 20), "{test}: {before:?}");
    draw(&counting, &ready, FRAMES);
    assert_eq!(counting.asked_bytes(), 0, "bytes of textures and buffers");
    assert_eq!(allocated(&own.gpu), before, "allocations, their bytes, and what is held for more");
}
