//! Which machine draws: the processor or a graphics adapter.

use crate::talk;
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::{CpuRenderer, Renderer, TechniqueName};
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

fn unknown(technique: TechniqueName) -> String {
    format!("the technique {technique} is not drawn on graphics adapters")
}
