//! `cutis view`: the window in which skin is looked at.
//!
//! What is shown follows from a [`look::Look`], plain numbers that panel, mouse and keys change; the [`painter`] draws it in
//! the background. The window itself draws nothing but what the painter has sent.

mod app;
mod canvas;
mod files;
mod help;
mod keys;
mod look;
mod mailbox;
mod mouse;
mod orbit;
mod painter;
mod panel;
mod screen;
mod shown;
mod side;
mod turntable;
mod wireframe;

use crate::Outcome;
use crate::backend::Backend;
use crate::cli::ViewArgs;
use crate::job::{atlas, must_exist, named};
use crate::scene_source::SceneSource;
use app::Viewer;
use cutis_render::Settings;
use cutis_render::settings::{Quality, TechniqueSettings};
use cutis_scene::ReadOptions;
use cutis_scene::head::HeadDetail;
use eframe::egui;
use look::Drawing;
use miette::{Result, miette};

/// Width and height of the window at first, points.
const WINDOW: [f32; 2] = [1280.0, 800.0];

/// Runs the command.
pub fn run(args: &ViewArgs) -> Result<Outcome> {
    let source = source(args)?;
    let backend = named("--backend", &args.backend, Backend::ALL.map(|b| (b.to_string(), b)))?;
    let drawing = Drawing { backend, ..Drawing::default() };
    let scene = source.load().map_err(|error| miette!("{error}"))?;
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size(WINDOW).with_title("cutis"),
        ..eframe::NativeOptions::default()
    };
    let make = move |creation: &eframe::CreationContext| -> std::result::Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(Viewer::new(&creation.egui_ctx, source, scene, drawing)?))
    };
    eframe::run_native("cutis", options, Box::new(make)).map_err(|error| {
        miette!(help = "cutis render draws without a window", "there is no window to be had: {error}")
    })?;
    Ok(Outcome::Done)
}

fn source(args: &ViewArgs) -> Result<SceneSource> {
    [&args.scene, &args.environment].into_iter().flatten().try_for_each(|path| must_exist(path))?;
    let options = ReadOptions {
        millimetres_per_unit: args.millimetres_per_unit,
        // Files may be dropped into the window later.
        atlas: atlas(args.atlas.as_deref(), true)?,
        ..ReadOptions::default()
    };
    if options.millimetres_per_unit.is_some_and(|mm| !(mm > 0.0 && mm.is_finite())) {
        return Err(miette!("--millimetres-per-unit must be above 0 mm"));
    }
    Ok(SceneSource {
        file: args.scene.clone(),
        options,
        environment: args.environment.clone(),
        detail: HeadDetail::default(),
        material: None,
        longest_side_mm: None,
        time_s: 0.0,
    })
}

impl Default for Drawing {
    fn default() -> Self {
        let Settings { technique, diffusion, gaussians, .. } = Settings::default();
        Self {
            technique,
            techniques: TechniqueSettings::default(),
            diffusion,
            backend: Backend::Auto,
            quality: Quality::Auto,
            irradiance_size: 1024,
            gaussians,
            muted_gaussians: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
