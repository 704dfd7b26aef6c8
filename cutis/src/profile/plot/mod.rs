//! `--plot`: four panels on profile, fit, residual and spectrum, as SVG or PNG.
//!
//! The font for PNG is inside the program (Ubuntu Light, Ubuntu font licence, from the crate `epaint_default_fonts`), so that
//! a machine without fonts draws the same picture; an SVG names `sans-serif` and leaves it to whoever shows it.

mod axes;
mod panels;
mod sampled;

use super::Profiled;
use image::imageops::FilterType;
use image::{ImageFormat, RgbImage};
use miette::{IntoDiagnostic, Result, miette};
use panels::{Figure, draw};
use plotters::prelude::{BitMapBackend, IntoDrawingArea, SVGBackend};
use plotters::style::{FontStyle, register_font};
pub use sampled::Ranges;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Size of the figure in points.
const SIZE: (u32, u32) = (1200, 900);
/// Dots of a PNG per point.
const DOTS_PER_POINT: u32 = 2;
/// Dots drawn for one of the PNG, each way: edges of lines are smoothed by their mean.
const OVERSAMPLING: u32 = 2;

/// A picture to write.
pub struct PlotFile {
    pub path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Svg,
    Png,
}

impl PlotFile {
    /// Refuses every extension but .svg and .png.
    pub fn new(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let kind = match extension.as_str() {
            "svg" => Kind::Svg,
            "png" => Kind::Png,
            _ => return Err(miette!("{}: a plot is written as .svg or .png", path.display())),
        };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// Draws.
    pub fn render(&self, profiled: &Profiled) -> Result<Vec<u8>> {
        match self.kind {
            Kind::Svg => Ok(svg_of(profiled)?.into_bytes()),
            Kind::Png => png_of(profiled),
        }
    }
}

/// The figure as SVG.
pub fn svg_of(profiled: &Profiled) -> Result<String> {
    register_own_font()?;
    let mut text = String::new();
    draw(&Figure::new(profiled), &SVGBackend::with_string(&mut text, SIZE).into_drawing_area(), 1)
        .map_err(|error| miette!("the plot cannot be drawn: {error}"))?;
    Ok(text)
}

fn png_of(profiled: &Profiled) -> Result<Vec<u8>> {
    register_own_font()?;
    let scale = DOTS_PER_POINT * OVERSAMPLING;
    let (width, height) = (SIZE.0 * scale, SIZE.1 * scale);
    let mut dots = vec![0; (3 * width * height) as usize];
    let figure = Figure::new(profiled);
    draw(&figure, &BitMapBackend::with_buffer(&mut dots, (width, height)).into_drawing_area(), scale)
        .map_err(|error| miette!("the plot cannot be drawn: {error}"))?;
    let large =
        RgbImage::from_raw(width, height, dots).ok_or_else(|| miette!("the plot has lost its size"))?;
    let picture =
        image::imageops::resize(&large, width / OVERSAMPLING, height / OVERSAMPLING, FilterType::Triangle);
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png).into_diagnostic()?;
    Ok(bytes.into_inner())
}

fn register_own_font() -> Result<()> {
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| miette!("the font inside the program is broken"))
}
