//! Files that come in and go out while looking: dropped scenes, heads and environments; pictures.

use super::look::Look;
use crate::scene_source::SceneSource;
use cutis_render::Frame;
use cutis_render::film::{self, Film};
use cutis_scene::{Scene, write_scene};
use eframe::egui::{ColorImage, Context};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

/// Highest number of a file.
const MAX_FILES: u32 = 9999;

/// A scene that is being read.
pub struct Loading {
    /// What it comes from.
    pub source: SceneSource,
    scene: Receiver<Result<Scene, String>>,
}

impl Loading {
    /// Reads it in the background; the context is woken when it is there.
    pub fn start(source: SceneSource, context: &Context) -> Self {
        let (sender, scene) = channel();
        let (from, context) = (source.clone(), context.clone());
        std::thread::spawn(move || {
            let read = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| from.load()));
            let read = read.map_err(|_| "a fault of cutis worth reporting, while reading it".to_owned());
            // Nobody listens any more if the window is closed.
            let _ = sender.send(read.and_then(|scene| scene.map_err(|error| error.to_string())));
            context.request_repaint();
        });
        Self { source, scene }
    }

    /// The scene, or why there is none, when it has been read.
    pub fn done(&self) -> Option<Result<Scene, String>> {
        self.scene.try_recv().ok()
    }
}

/// What is to be read when a file is dropped: environments join the scene, everything else replaces it.
pub fn dropped(path: &Path, now: &SceneSource) -> SceneSource {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "hdr" | "exr" => SceneSource { environment: Some(path.to_owned()), ..now.clone() },
        _ => SceneSource { file: Some(path.to_owned()), environment: None, ..now.clone() },
    }
}

/// Writes a picture beside the others of this folder under the first free number.
///
/// # Errors
/// In words, if it cannot be written.
pub fn write_picture(folder: &Path, frame: &Frame, film: &Film) -> Result<PathBuf, String> {
    let path = free_name(folder, "png")?;
    let format = film::check_output(&path, None).map_err(|error| error.to_string())?;
    film::write(&path, format, frame, film).map_err(|error| error.to_string())?;
    Ok(path)
}

/// Writes what is on the screen, under the first free number.
///
/// # Errors
/// In words, if it cannot be written.
pub fn write_image(folder: &Path, image: &ColorImage) -> Result<PathBuf, String> {
    let path = free_name(folder, "png")?;
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
    let [width, height] = image.size.map(|side| side as u32);
    image::save_buffer(&path, &bytes, width, height, image::ExtendedColorType::Rgb8)
        .map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(path)
}

/// Writes a scene file of what is seen, under the first free number; the exposure goes with the camera.
///
/// # Errors
/// In words, if it cannot be written.
pub fn write_look(folder: &Path, scene: &Scene, look: &Look) -> Result<PathBuf, String> {
    let path = free_name(folder, "toml")?;
    let mut scene = look.applied_to(scene).map_err(|error| error.to_string())?;
    scene.camera.exposure_ev = look.film.exposure_ev;
    write_scene(&scene, &path).map_err(|error| error.to_string())?;
    Ok(path)
}

fn free_name(folder: &Path, extension: &str) -> Result<PathBuf, String> {
    let names = (1..=MAX_FILES).map(|n| folder.join(format!("cutis-{n:04}.{extension}")));
    names.into_iter().find(|path| !path.exists()).ok_or_else(|| {
        format!("{}: there are {MAX_FILES} such files already; move some away", folder.display())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::ReadOptions;
    use cutis_scene::head::HeadDetail;
    use glam::Vec4;

    #[test]
    fn an_environment_joins_the_scene_and_a_head_replaces_it() {
        let now = SceneSource {
            material: None,
            longest_side_mm: None,
            time_s: 0.0,
            file: Some("head.obj".into()),
            options: ReadOptions::default(),
            environment: None,
            detail: HeadDetail::default(),
        };
        let lit = dropped(Path::new("Sky.HDR"), &now);
        assert_eq!(lit.file, now.file);
        assert_eq!(lit.environment.as_deref(), Some(Path::new("Sky.HDR")));
        let other = dropped(Path::new("other.glb"), &lit);
        assert_eq!((other.file.as_deref(), other.environment), (Some(Path::new("other.glb")), None));
    }

    #[test]
    fn pictures_never_overwrite_each_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let frame = Frame { width: 1, height: 1, pixels: vec![Vec4::ONE], ..Frame::default() };
        let write = || write_picture(folder.path(), &frame, &Film::default()).expect("is written");
        assert_ne!(write(), write());
        let nowhere = write_picture(&folder.path().join("none"), &frame, &Film::default());
        assert!(nowhere.expect_err("there is no such folder").contains("none"));
    }
}
