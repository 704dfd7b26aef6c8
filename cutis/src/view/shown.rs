//! What is to be seen: the picture, one layer of it, or the textures of all passes.

use cutis_render::{Aov, TechniqueName};

/// What fills the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Shown {
    /// Which view.
    pub view: View,
    /// Whether the triangles are drawn over it.
    pub wireframe: bool,
}

/// A view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// The developed picture.
    #[default]
    Picture,
    /// A layer as the camera sees it.
    Layer(Aov),
    /// Textures of all passes at once.
    Maps,
    /// One of those textures.
    Map(Aov),
}

impl Shown {
    /// Layers beside the picture that are needed.
    pub fn layers(self, technique: TechniqueName) -> Vec<Aov> {
        match self.view {
            View::Layer(aov) if !technique.is_estimated() || of_truth(aov) => vec![aov],
            _ => Vec::new(),
        }
    }

    /// Whether textures are needed.
    pub fn wants_maps(self) -> bool {
        matches!(self.view, View::Maps | View::Map(_))
    }
}

/// Layers that the truth can tell.
fn of_truth(aov: Aov) -> bool {
    matches!(aov, Aov::Diffuse | Aov::Specular | Aov::StandardError | Aov::Samples)
}

/// Layers as the camera sees them.
pub fn camera_layers(technique: TechniqueName) -> impl Iterator<Item = Aov> {
    Aov::all()
        .into_iter()
        .filter(move |&aov| if technique.is_estimated() { of_truth(aov) } else { aov != Aov::StandardError })
}

/// Textures of the passes, in their order.
pub fn texture_maps() -> impl Iterator<Item = Aov> {
    let is_texture = |aov: &Aov| {
        let of_light = matches!(aov, Aov::Irradiance | Aov::Blur(_) | Aov::Thickness | Aov::ShadowSamples);
        of_light || matches!(aov, Aov::Stretch | Aov::Charts | Aov::Seams)
    };
    Aov::all().into_iter().filter(is_texture)
}

/// Whether a layer holds plain numbers, which a scale of colours shows.
pub fn is_scaled(aov: Aov) -> bool {
    matches!(aov, Aov::Stretch | Aov::Thickness | Aov::Seams | Aov::Samples | Aov::ShadowSamples)
}

/// What a layer's numbers are measured in.
pub fn unit(aov: Aov) -> &'static str {
    match aov {
        Aov::Irradiance | Aov::Blur(_) | Aov::Exitance => "W/m²",
        Aov::Stretch => "mm per texel",
        Aov::Thickness => "mm",
        Aov::Specular | Aov::Transmission | Aov::Diffuse | Aov::StandardError => "W/(m² sr)",
        Aov::Seams => "of the mean light",
        Aov::Samples => "shaded, taken",
        Aov::ShadowSamples => "places of lights",
        Aov::Normal | Aov::Albedo | Aov::Charts => "",
    }
}
