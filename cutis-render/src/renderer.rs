//! The public act: scene and settings in, frame out.

use crate::technique::truth;
use crate::{Frame, Progress, Settings, TechniqueName, lit_scene};
use cutis_scene::Scene;

/// Why a scene could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The scene holds no triangles.
    #[error("the scene has nothing to draw: no object with triangles")]
    EmptyScene,
    /// A setting is out of its range.
    #[error("{name} must be {range}, got {value}")]
    BadSetting {
        /// The setting.
        name: &'static str,
        /// What it may be.
        range: &'static str,
        /// What it is.
        value: String,
    },
    /// The state of an earlier run does not fit, or cannot be kept.
    #[error("{reason}")]
    Checkpoint {
        /// What is wrong, with the file's name.
        reason: String,
    },
    /// Whoever watches did not want it any more.
    #[error("stopped")]
    Stopped,
    /// The machine that was to draw it cannot.
    #[error("{reason}")]
    Backend {
        /// What stands in the way.
        reason: String,
    },
    /// A body has no inside.
    #[error("object '{object}': {reason}")]
    BadBody {
        /// Name of the object.
        object: String,
        /// What is wrong with it, and what helps.
        reason: String,
    },
    /// A material cannot be turned into a kernel.
    #[error("material '{material}': {reason}")]
    BadMaterial {
        /// Name of the material.
        material: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// Something that can draw a scene.
pub trait Renderer {
    /// Name of the backend, for reports.
    fn backend(&self) -> &'static str;

    /// Name of the machine it runs on, for reports.
    fn adapter(&self) -> String;

    /// Draws the scene.
    ///
    /// # Errors
    /// If the scene is empty, a setting out of range, or a material unknown.
    fn render(
        &self,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Frame, RenderError>;
}

/// Draws on all cores of the processor, through the global rayon pool.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuRenderer;

impl Renderer for CpuRenderer {
    fn backend(&self) -> &'static str {
        "cpu"
    }

    fn adapter(&self) -> String {
        format!("{} threads", rayon::current_num_threads())
    }

    fn render(
        &self,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Frame, RenderError> {
        settings.check()?;
        if scene.objects.iter().all(|object| object.mesh.triangles.is_empty()) {
            return Err(RenderError::EmptyScene);
        }
        match settings.technique {
            TechniqueName::Truth => truth::render(scene, settings, progress),
            _ => lit_scene::render(scene, settings, progress),
        }
    }
}
