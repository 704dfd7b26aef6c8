//! Lights that move.

use super::drive::{Window, backends, drop_file, settle, window};
use std::path::Path;

const SIZE: [f32; 2] = [640.0, 420.0];

/// A checkerboard of eight squares that drifts by two of them in eight seconds.
fn marble(backend: crate::backend::Backend) -> Window {
    let mut window = window(SIZE, backend);
    drop_file(&mut window, &Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/marble_checkerboard.toml"));
    settle(&mut window);
    window
}

fn picture_at(window: &mut Window, time_s: f32) -> Vec<u8> {
    window.state_mut().looks[0].time_s = time_s;
    settle(window);
    let painted = window.state().sides[0].painted.as_ref().expect("something is drawn");
    painted.image.pixels.iter().flat_map(|p| p.to_array()).collect()
}

#[test]
fn a_pattern_drifts_and_comes_back() {
    for backend in backends("a_pattern_drifts_and_comes_back") {
        let mut window = marble(backend);
        let [first, later, again] = [0.0, 3.0, 8.0].map(|time_s| picture_at(&mut window, time_s));
        let apart = |other: &[u8]| first.iter().zip(other).filter(|(a, b)| a.abs_diff(**b) > 4).count();
        let moved = apart(&later);
        assert!(moved > first.len() / 50, "{backend}: {moved} of {} bytes differ", first.len());
        assert!(apart(&again) < moved / 20, "{backend}: {} bytes differ after a whole turn", apart(&again));
    }
}

#[test]
fn time_goes_on_while_lights_move_and_only_where_they_can() {
    let mut still = window(SIZE, crate::backend::Backend::Cpu);
    let mut moving = marble(crate::backend::Backend::Cpu);
    for window in [&mut still, &mut moving] {
        window.state_mut().is_playing = true;
        (0..3).for_each(|_| window.step());
    }
    assert!(!still.state().is_playing && still.state().looks[0].time_s == 0.0);
    let time_s = moving.state().looks[0].time_s;
    assert!(moving.state().is_playing && time_s > 0.0 && time_s < 1.0, "{time_s}");
}
