//! The truth of a scene as it is kept: mean, specular part and standard error, in one EXR file of half floats.

use super::job::{Job, SIZE};
use crate::job::refused;
use crate::progress::Bar;
use crate::whole_file;
use cutis_render::film::annotated_exr;
use cutis_render::{Aov, CpuRenderer, Renderer};
use cutis_scene::{Scene, read_picture};
use glam::{Vec3, Vec4};
use miette::{Result, bail, miette};
use std::path::{Path, PathBuf};

/// A picture by simulation, without what the surface itself reflects.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Pixels in a row.
    pub width: usize,
    /// W/(m² sr), linear Rec. 709.
    pub diffuse: Vec<Vec3>,
    /// Standard error of each pixel, in the same unit. It is that of the whole picture, the specular part included.
    pub standard_errors: Vec<Vec3>,
}

impl Truth {
    /// Where the truth of a scene lies.
    pub fn path(folder: &Path, scene: &str) -> PathBuf {
        folder.join(format!("{scene}.exr"))
    }

    /// Reads the truth of a scene.
    pub fn read(folder: &Path, scene: &str) -> Result<Self> {
        let path = Self::path(folder, scene);
        if !path.exists() {
            bail!(help = "make it with --update", "{}: there is no such file", path.display());
        }
        let layer = |aov: Option<Aov>| {
            let picture = read_picture(&path, aov.map(|aov| aov.to_string()).as_deref()).map_err(refused)?;
            if (picture.width, picture.height) != (SIZE, SIZE) {
                bail!(
                    help = "make it again with --update",
                    "{}: has {} x {} pixels, a truth has {SIZE} x {SIZE}",
                    path.display(),
                    picture.width,
                    picture.height
                );
            }
            Ok(picture.pixels.iter().map(|p: &Vec4| p.truncate()).collect::<Vec<Vec3>>())
        };
        let (picture, specular) = (layer(None)?, layer(Some(Aov::Specular))?);
        let standard_errors = layer(Some(Aov::StandardError))?;
        if standard_errors.iter().any(|error| error.min_element() < 0.0) {
            bail!("{}: a standard error is below 0", path.display());
        }
        let diffuse = picture.iter().zip(&specular).map(|(all, part)| all - part).collect();
        Ok(Self { width: SIZE as usize, diffuse, standard_errors })
    }

    /// Renders the truth of a scene and keeps it.
    pub fn render(job: &Job, name: &str, scene: &Scene, verbose: u8) -> Result<()> {
        let path = Self::path(&job.folder, name);
        let bar = Bar::named(&format!("{name}, truth: "), verbose);
        let frame = CpuRenderer.render(scene, &job.truth_settings(), &bar);
        bar.finish();
        let frame = frame.map_err(|error| miette!("{name}, truth: {error}"))?;
        let bytes = annotated_exr(&frame, &job.command(name));
        let bytes = bytes.map_err(|reason| miette!("{}: cannot be encoded: {reason}", path.display()))?;
        whole_file::write_all(&[(path.as_path(), &bytes)])
    }
}
