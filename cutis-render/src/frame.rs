//! What a renderer gives back.

use crate::passes::seams::DiffusionReport;
use glam::Vec4;
use std::time::Duration;

/// A finished picture in linear, scene-referred light, with the layers that were asked for.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Radiance in W/(m² sr), linear Rec. 709, rows from the top; alpha is coverage, colour premultiplied by it.
    pub pixels: Vec<Vec4>,
    /// Layers beside the picture.
    pub layers: Vec<Layer>,
    /// What was done and how long it took, in order.
    pub passes: Vec<PassTime>,
    /// Energy and seam error of every object's diffusion, where they were asked for.
    pub diffusion_reports: Vec<DiffusionReport>,
    /// Things the person who runs the program should know, in words.
    pub warnings: Vec<String>,
}

/// One named layer; it may have a size of its own.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Name, such as `irradiance`.
    pub name: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Channel names, such as `R`, `G`, `B`; as many as the first components of a pixel that count.
    pub channels: Vec<String>,
    /// Values, rows from the top.
    pub pixels: Vec<Vec4>,
}

/// Time one pass took.
#[derive(Debug, Clone)]
pub struct PassTime {
    /// The paper's name of the pass.
    pub name: String,
    /// Wall-clock time.
    pub time: Duration,
}
