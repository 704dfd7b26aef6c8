//! The truth: light transport in the real geometry by Monte Carlo, with a standard error for every pixel.
//!
//! What it solves is in [`crate::transport`]. Samples come in passes over the whole picture, so that it may stop when the
//! noise is low enough, and go on another day.

mod exitance_map;
mod film;
mod key;

use crate::film::Checkpoint;
use crate::frame::{Frame, PassTime};
use crate::lit_scene::{laid_out_anew, left_out};
use crate::settings::{Aov, AovSpace, Settings, TechniqueName};
use crate::transport::path::Transport;
use crate::{Progress, RenderError};
use cutis_scene::closing::{check_closed, close_holes};
use cutis_scene::{ScalarMap, Scene};
pub use exitance_map::{ExitanceMap, Start};
use film::Film;
use std::time::{Duration, Instant};

/// Pixels times samples of a step, after which the state may be kept: some seconds.
const STEP: u64 = 1 << 18;
/// Noise is only believed after so many samples per pixel.
const SAMPLES_MIN: u64 = 16;
/// Time between two states kept.
const KEEP_EVERY: Duration = Duration::from_secs(20);

/// Draws a scene.
///
/// # Errors
/// If a body is open, a material has no medium, a layer is not known here, a light could never be seen, or the checkpoint
/// belongs to something else or cannot be kept.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Frame, RenderError> {
    check_layers(settings)?;
    let start = Instant::now();
    let scene = &closed(scene, settings.close_holes)?;
    let transport = Transport::new(scene, settings.seed)?;
    check_lights(&transport)?;
    let mut passes = vec![PassTime { name: "bodies".to_owned(), time: start.elapsed() }];
    let start = Instant::now();
    let film = expose(&transport, settings, progress)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut frame = film.frame(settings);
    passes.push(PassTime { name: "paths".to_owned(), time: start.elapsed() });
    let (events, noise) = (film.events() as f64, film.noise());
    tracing::info!(
        "{events:.3e} collisions, {:.3e} in a second, noise {:.3} %",
        events / seconds,
        100.0 * noise
    );
    if settings.aov_space == AovSpace::Texture {
        let start = Instant::now();
        let map = ExitanceMap::new(&transport, settings, progress)?;
        frame.layers = settings.aovs.iter().filter_map(|&aov| map.layer(aov)).collect();
        passes.push(PassTime { name: "exitance".to_owned(), time: start.elapsed() });
    }
    frame.passes = passes;
    frame.warnings = warnings(scene, settings);
    Ok(frame)
}

/// What a person should know of a scene that is drawn by this technique.
fn warnings(scene: &Scene, settings: &Settings) -> Vec<String> {
    let scaled = scene.objects.iter().filter(|object| object.material.thickness_scale != 1.0);
    let words = scaled.map(|object| {
        let (name, scale) = (&object.name, object.material.thickness_scale);
        format!("the truth takes '{name}' as thick as it is: it does not know the thickness scale of {scale}")
    });
    let left_out = left_out(scene, TechniqueName::Truth, settings.diffusion);
    words.chain(left_out).chain(laid_out_anew(scene, settings)).collect()
}

/// Takes samples until there are enough, or the noise is low enough.
fn expose(transport: &Transport, settings: &Settings, progress: &dyn Progress) -> Result<Film, RenderError> {
    let (key, wanted) = (key::of(transport.scene, settings), u64::from(settings.samples_per_pixel));
    let mut film = Film::new(transport.scene, settings);
    if let Some(checkpoint) = &settings.checkpoint
        && let Some((samples, state)) = checkpoint.load(key, film.state().len()).map_err(checkpoint_error)?
    {
        film.restore(samples, &state);
    }
    let (width, height) = (u64::from(settings.width), u64::from(settings.height));
    let pass = (STEP / (width * height)).clamp(1, 16);
    let rows = (STEP / width).clamp(1, height) as usize;
    let mut last_kept = Instant::now();
    progress.begin("paths", wanted);
    progress.advance(film.samples().min(wanted));
    while film.samples() < wanted {
        let count = pass.min(wanted - film.samples());
        for row in (0..height as usize).step_by(rows) {
            film.expose(transport, count, row..(row + rows).min(height as usize));
            if !progress.goes_on() {
                return Err(RenderError::Stopped);
            }
            if last_kept.elapsed() > KEEP_EVERY {
                keep(settings.checkpoint.as_ref(), key, &film)?;
                last_kept = Instant::now();
            }
        }
        film.finish(count);
        progress.advance(count);
        progress.preview(&|| film.frame(settings));
        let noise = film.noise();
        progress.note(&format!("paths, noise {:.2} %", 100.0 * noise));
        if film.samples() >= SAMPLES_MIN && settings.target_error.is_some_and(|target| noise <= target) {
            break;
        }
    }
    keep(settings.checkpoint.as_ref(), key, &film)?;
    Ok(film)
}

fn keep(checkpoint: Option<&Checkpoint>, key: u64, film: &Film) -> Result<(), RenderError> {
    checkpoint.map_or(Ok(()), |checkpoint| {
        checkpoint.save(key, film.samples(), film.state()).map_err(checkpoint_error)
    })
}

fn checkpoint_error(error: crate::film::CheckpointError) -> RenderError {
    RenderError::Checkpoint { reason: error.to_string() }
}

fn check_layers(settings: &Settings) -> Result<(), RenderError> {
    let (known, range): (&[Aov], _) = match settings.aov_space {
        AovSpace::Picture => (
            &[Aov::Diffuse, Aov::Specular, Aov::StandardError, Aov::Samples],
            "diffuse, specular, standard-error or samples, as the camera sees them",
        ),
        AovSpace::Texture => {
            (&[Aov::Exitance, Aov::StandardError], "exitance or standard-error (of it), as textures")
        }
    };
    match settings.aovs.iter().find(|aov| !known.contains(aov)) {
        Some(aov) => Err(RenderError::BadSetting {
            name: "a layer of the technique truth",
            range,
            value: aov.to_string(),
        }),
        None => Ok(()),
    }
}

/// The scene with closed bodies only.
///
/// # Errors
/// If one is open and is to stay so, or can not be closed.
pub fn closed(scene: &Scene, close: bool) -> Result<Scene, RenderError> {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        let bad = |reason: String| RenderError::BadBody { object: object.name.clone(), reason };
        if close {
            *object = close_holes(object).map_err(|e| bad(e.to_string()))?;
        } else {
            check_closed(&object.mesh).map_err(|e| {
                bad(format!("{e}; a simulation needs a closed body: --close-holes caps its holes"))
            })?;
        }
    }
    Ok(scene)
}

/// Refuses lights that no path from the eye could ever meet.
fn check_lights(transport: &Transport) -> Result<(), RenderError> {
    if !transport.emitters.has_sharp_light() {
        return Ok(());
    }
    let sharp = |material: &cutis_scene::Material| {
        least(&material.roughness) <= 0.0
            || crate::transport::tissue::Tissue::of_material(material)
                .is_ok_and(|t| t.refractive_index == 1.0)
    };
    match transport.scene.objects.iter().find(|object| sharp(&object.material)) {
        Some(object) => Err(RenderError::BadBody {
            object: object.name.clone(),
            reason: "light from a point falls on a surface too smooth for the eye's paths to find it: give the light a \
                     radius, or the surface a roughness"
                .to_owned(),
        }),
        None => Ok(()),
    }
}

/// The least value of a map.
fn least(map: &ScalarMap) -> f32 {
    let Some((texture, channel)) = &map.texture else { return map.offset };
    let texels = (0..texture.height()).flat_map(|y| (0..texture.width()).map(move |x| (x, y)));
    let values = texels.map(|(x, y)| map.offset + map.gain * texture.texel(x, y)[*channel]);
    values.fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests;
