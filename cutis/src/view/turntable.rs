//! A turn around the scene, written picture by picture.

use super::orbit::orbit;
use cutis_render::Frame;
use cutis_render::film::{self, Film};
use cutis_scene::Camera;
use glam::Vec2;
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};

/// A turn that is under way.
#[derive(Debug, Clone)]
pub struct Turntable {
    /// Pictures of a whole turn.
    pub pictures: u32,
    /// Those that are written.
    pub done: u32,
    /// Where it began, and where it ends.
    pub start: Camera,
    folder: PathBuf,
}

impl Turntable {
    /// Begins a turn of so many pictures in a new folder beside other pictures.
    ///
    /// # Errors
    /// In words, if the folder cannot be made.
    pub fn begin(beside: &Path, pictures: u32, start: Camera) -> Result<Self, String> {
        let names = (1..).map(|n| beside.join(format!("turntable-{n:04}")));
        let folder = names.into_iter().find(|path| !path.exists()).unwrap_or_default();
        std::fs::create_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(Self { pictures, done: 0, start, folder })
    }

    /// Writes the picture of the step that the turn is at and goes on.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn write(&mut self, frame: &Frame, film: &Film) -> Result<(), String> {
        let path = self.folder.join(format!("{:04}.png", self.done + 1));
        let format = film::check_output(&path, None).map_err(|error| error.to_string())?;
        film::write(&path, format, frame, film).map_err(|error| error.to_string())?;
        self.done += 1;
        Ok(())
    }

    /// Whether all pictures are written.
    pub fn is_done(&self) -> bool {
        self.done >= self.pictures
    }

    /// The camera of the step that the turn is at.
    pub fn camera(&self) -> Camera {
        let mut camera = self.start;
        orbit(&mut camera, Vec2::new(TAU * self.done as f32 / self.pictures as f32, 0.0));
        camera
    }

    /// How far it is, in words.
    pub fn progress(&self) -> String {
        format!("turntable: {} of {} pictures in {}", self.done, self.pictures, self.folder.display())
    }
}
