//! The renderer: a device with everything compiled.

use crate::passes::Passes;
use crate::passes::inside::Inside;
use crate::scene::SceneError;
use crate::scene::slides::Slides;
use crate::{Adapters, Gpu, GpuError, GpuScene};
use cutis_render::lit_scene::warnings;
use cutis_render::{Frame, PassTime, Progress, RenderError, Renderer, Settings, TechniqueName};
use cutis_scene::Scene;
use std::time::Instant;

/// Draws on a graphics processor.
#[derive(Debug)]
pub struct GpuRenderer {
    /// The device.
    pub gpu: Gpu,
    /// Everything that is compiled.
    pub passes: Passes,
}

impl GpuRenderer {
    /// Opens the best adapter of a kind.
    ///
    /// # Errors
    /// If there is none, it gives no device, or cannot compile the passes.
    pub fn new(adapters: Adapters) -> Result<Self, GpuError> {
        let renderer = Self::with_gpu(Gpu::find(adapters)?);
        renderer.gpu.check()?;
        Ok(renderer)
    }

    /// On a device that is there already, such as that of a window.
    pub fn with_gpu(gpu: Gpu) -> Self {
        let passes = Passes::new(&gpu);
        Self { gpu, passes }
    }

    /// Whether a technique can be drawn here.
    pub fn knows(technique: TechniqueName) -> bool {
        Inside::knows(technique)
    }

    /// Finds out whether a scene can be drawn here.
    ///
    /// # Errors
    /// If projectors throw more than a device takes.
    pub fn check(scene: &Scene) -> Result<(), GpuError> {
        Slides::check(scene)
    }

    /// Uploads a scene, ready to be drawn again and again.
    ///
    /// # Errors
    /// If it cannot be drawn, or is larger than the device takes.
    pub fn scene(
        &self,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<GpuScene, SceneError> {
        let technique = settings.technique;
        if !Self::knows(technique) {
            let reason = format!("the technique {technique} is not drawn on graphics adapters");
            return Err(RenderError::Backend { reason }.into());
        }
        GpuScene::new(&self.gpu, &self.passes, scene, settings, progress)
    }

    fn frame(
        &self,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Frame, SceneError> {
        let start = Instant::now();
        let ready = self.scene(scene, settings, progress)?;
        let preparing = PassTime { name: "prepare".to_owned(), time: start.elapsed() };
        progress.begin("gpu", 1);
        let passes = ready.draw_timed(&self.gpu)?;
        progress.advance(1);
        let start = Instant::now();
        let pixels = ready.picture(&self.gpu)?;
        let layers = ready.layers(&self.gpu, &self.passes, &settings.aovs, settings.aov_space)?;
        let reading = PassTime { name: "read back".to_owned(), time: start.elapsed() };
        let mut told = warnings(scene, settings);
        told.extend(ready.shared.warnings.iter().cloned());
        if settings.diffusion_report {
            told.push("the report on the diffusion is made by the processor only: --backend cpu".to_owned());
        }
        Ok(Frame {
            width: settings.width,
            height: settings.height,
            pixels,
            layers,
            passes: std::iter::once(preparing).chain(passes).chain([reading]).collect(),
            diffusion_reports: Vec::new(),
            warnings: told,
        })
    }
}

impl Renderer for GpuRenderer {
    fn backend(&self) -> &'static str {
        "gpu"
    }

    fn adapter(&self) -> String {
        self.gpu.name()
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
        self.frame(scene, settings, progress).map_err(|error| match error {
            SceneError::Render(error) => error,
            SceneError::Gpu(error) => RenderError::Backend { reason: error.to_string() },
        })
    }
}
