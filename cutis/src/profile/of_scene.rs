//! The profile of a scene's material, as a figure for a report.

use super::job::Job;
use super::material::{Material, Substance};
use super::plot::svg_of;
use super::{Profiled, joint_fit};
use crate::profile::channel;
use cutis_optics::{FitMethod, Medium, TissueLayer};
use cutis_render::Settings;
use cutis_scene::Scattering;
use miette::Result;

/// Draws profile, fit, residual and spectrum of a material, with as many Gaussians as are rendered.
pub fn figure_svg(name: &str, scattering: &Scattering) -> Result<String> {
    let job = Job::of_material(Material::of_scene(name, scattering)?);
    let channels = channel::compute(&job)?;
    let joint = joint_fit(&channels, &job)?;
    svg_of(&Profiled { material: &job.material, channels, joint })
}

impl Material {
    fn of_scene(name: &str, scattering: &Scattering) -> Result<Self> {
        let endless = |medium: &Medium| vec![TissueLayer { medium: *medium, thickness_mm: f64::INFINITY }];
        let substance = match scattering {
            Scattering::Preset(name) => return Self::preset(name),
            Scattering::Medium(media) => Substance::Coloured(media.each_ref().map(endless)),
            Scattering::Layers(channels) => Substance::Coloured(channels.clone()),
            Scattering::Kernel(kernel) => Substance::Kernel(kernel.clone()),
        };
        Ok(Self { name: name.to_owned(), origin: "the scene".to_owned(), substance })
    }
}

impl Job {
    /// What is usual for a material.
    fn of_material(material: Material) -> Self {
        let Settings { gaussians, seed, .. } = Settings::default();
        Self {
            material,
            channel: None,
            source: None,
            gaussians,
            gaussians_were_given: false,
            method: FitMethod::Energy,
            seven_tap: false,
            beam_mm: None,
            roughness: None,
            photons: 0,
            seed,
            verbose: 0,
            exports: Vec::new(),
            plot: None,
            explain: false,
            json: false,
        }
    }
}
