//! Which machine draws: the processor or a graphics adapter.

use crate::talk;
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::{CpuRenderer, RenderError, Renderer, TechniqueName};
use cutis_scene::Scene;
use miette::{Result, miette};
use std::fmt;

/// What `--backend` may say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    /// A graphics processor if there is one, else the processor.
    Auto,
    /// The processor.
    Cpu,
    /// A graphics adapter, be it a program that stands in for one.
    Gpu,
}

impl Backend {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Backend; 3] = [Backend::Auto, Backend::Cpu, Backend::Gpu];

    /// Refuses what can be told before any work.
    ///
    /// # Errors
    /// If the GPU is asked for a technique that it does not know.
    pub fn check(self, technique: TechniqueName) -> Result<()> {
        if self == Backend::Gpu && !GpuRenderer::knows(technique) {
            return Err(miette!(help = "leave --backend out, or say cpu", "{}", unknown(technique)));
        }
        Ok(())
    }

    /// Who draws when the renderer that was chosen could not. `None`: nobody else is to.
    pub fn instead(self, renderer: &dyn Renderer, error: &RenderError) -> Option<Box<dyn Renderer>> {
        let RenderError::Backend { reason } = error else { return None };
        if self != Backend::Auto || renderer.backend() == CpuRenderer.backend() {
            return None;
        }
        talk::tell(&format!("backend auto: the processor, because {reason}"));
        Some(Box::new(CpuRenderer))
    }

    /// The renderer for a technique and a scene; the processor for what graphics adapters do not draw.
    ///
    /// # Errors
    /// If the GPU is asked for and there is none.
    pub fn renderer_that_knows(self, technique: TechniqueName, scene: &Scene) -> Result<Box<dyn Renderer>> {
        if self == Backend::Gpu && !GpuRenderer::knows(technique) {
            talk::tell(&format!("backend gpu: the processor, because {}", unknown(technique)));
            return Ok(Box::new(CpuRenderer));
        }
        self.renderer(technique, scene)
    }

    /// The renderer for a technique and a scene.
    ///
    /// # Errors
    /// If the GPU is asked for and there is none.
    pub fn renderer(self, technique: TechniqueName, scene: &Scene) -> Result<Box<dyn Renderer>> {
        match self {
            Backend::Cpu => Ok(Box::new(CpuRenderer)),
            Backend::Gpu => Ok(Box::new(on_any_adapter()?)),
            Backend::Auto => Ok(on_hardware(technique, scene).unwrap_or_else(|why| {
                talk::tell(&format!("backend auto: the processor, because {why}"));
                Box::new(CpuRenderer)
            })),
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Backend::Auto => "auto",
            Backend::Cpu => "cpu",
            Backend::Gpu => "gpu",
        })
    }
}

/// A real graphics processor, or why there is none to be had.
fn on_hardware(technique: TechniqueName, scene: &Scene) -> std::result::Result<Box<dyn Renderer>, String> {
    if !GpuRenderer::knows(technique) {
        return Err(unknown(technique));
    }
    GpuRenderer::check(scene).map_err(|error| error.to_string())?;
    let renderer = GpuRenderer::new(Adapters::Hardware).map_err(|error| error.to_string())?;
    Ok(Box::new(renderer))
}

fn on_any_adapter() -> Result<GpuRenderer> {
    GpuRenderer::new(Adapters::Any)
        .map_err(|error| miette!(help = "leave --backend out, or say cpu", "{error}"))
}

/// Why a graphics adapter does not draw a technique.
pub fn unknown(technique: TechniqueName) -> String {
    format!("the technique {technique} is not drawn on graphics adapters")
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_render::{Frame, Progress, Settings};

    /// A graphics processor that has no room.
    struct Full;

    impl Renderer for Full {
        fn backend(&self) -> &'static str {
            "gpu"
        }

        fn adapter(&self) -> String {
            "full".to_owned()
        }

        fn render(
            &self,
            _: &Scene,
            _: &Settings,
            _: &dyn Progress,
        ) -> std::result::Result<Frame, RenderError> {
            Err(no_room())
        }
    }

    fn no_room() -> RenderError {
        RenderError::Backend { reason: "there is no room".to_owned() }
    }

    #[test]
    fn only_auto_falls_back_and_only_from_a_machine_that_cannot() {
        let instead = |backend: Backend, error| backend.instead(&Full, &error).map(|r| r.backend());
        assert_eq!(instead(Backend::Auto, no_room()), Some("cpu"));
        assert_eq!(instead(Backend::Gpu, no_room()), None);
        assert_eq!(instead(Backend::Auto, RenderError::EmptyScene), None);
        assert!(Backend::Auto.instead(&CpuRenderer, &no_room()).is_none());
    }
}
