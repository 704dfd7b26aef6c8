//! Numbers that one technique has of its own: what flags ask for, what a paper had, and how a report tells them.

pub mod paper;
pub mod ramp;
pub mod report;
mod wish;

pub use wish::{Wish, wishes};

use cutis_render::TechniqueName;
use cutis_render::settings::TechniqueSettings;
use miette::{Result, miette};

/// Settings with the wishes in them.
///
/// # Errors
/// Names the first flag whose value is out of its range, the range and the value.
pub fn fulfilled(mut settings: TechniqueSettings, wishes: Vec<Wish>) -> Result<TechniqueSettings> {
    for Wish { flag, technique, set } in wishes {
        set(&mut settings);
        settings.check(technique).map_err(|error| miette!("{flag}: {error}"))?;
    }
    Ok(settings)
}

/// Wishes for a technique that does not draw, in words.
pub fn idle(wishes: &[Wish], technique: TechniqueName) -> Vec<String> {
    let idle = wishes.iter().filter(|wish| wish.technique != technique);
    idle.map(|wish| format!("{} has no effect: the technique is {technique}", wish.flag)).collect()
}

/// Takes the numbers of one technique from others.
pub fn take_own(settings: &mut TechniqueSettings, from: &TechniqueSettings, technique: TechniqueName) {
    match technique {
        TechniqueName::Wrap => settings.wrap = from.wrap,
        TechniqueName::DepthAbsorption => settings.depth_absorption = from.depth_absorption.clone(),
        TechniqueName::TextureBlur => settings.texture_blur = from.texture_blur,
        TechniqueName::ImageSpace => settings.image_space = from.image_space,
        TechniqueName::TextureSpace | TechniqueName::Truth => {}
    }
}
