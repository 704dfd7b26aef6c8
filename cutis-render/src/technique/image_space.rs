//! Samples of the diffusion profile around the point that is looked at, taken from an image of the irradiance
//! (Mertens, Kautz, Bekaert, Van Reeth & Seidel 2003, "Efficient rendering of local subsurface scattering").
//!
//! Symbols: x' a sample on the tangent plane, r' its distance from the point; p what the image shows in its place, r the true
//! distance of p; E irradiance. The estimate of ∫ R(r) E dA is Σ R(r) E(p) |dA/dA'| / (N p(r')), r' drawn with density p.

use super::{Exitance, Inside};
use crate::lit_scene::Lit;
use crate::passes::irradiance_image::IrradianceImage;
use crate::passes::resolve::Place;
use crate::prepare::radial::RadialKernel;
use crate::settings::within;
use crate::{Progress, RenderError};
use cutis_scene::Camera;
use glam::Vec3;
use std::fmt;

/// Numbers of the technique `image-space`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageSpaceSettings {
    /// Samples of the profile for a pixel, 1 to 4096.
    pub samples: u32,
    /// Samples that are spread evenly over a disc beside them, 0 to 4096: they find light beyond a shadow's border.
    pub uniform_samples: u32,
    /// Radius of that disc, mm; none: that of 95 % of the light.
    pub uniform_radius_mm: Option<f32>,
    /// Whether areas on the tangent plane are turned into areas on the body. The paper leaves that out.
    pub jacobian: bool,
    /// What the sum is divided by.
    pub count: SampleCount,
    /// Whether light that enters on the far side is taken from images that the lights see.
    pub light_views: bool,
    /// What radii are drawn from.
    pub profile: ImageSpaceProfile,
    /// Number of the picture in a row of pictures whose mean is taken: each has a pattern of its own.
    pub round: u32,
}

/// What the sum of the samples is divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleCount {
    /// Those that met the body, as in the paper: what the image does not show counts like what it shows.
    Valid,
    /// All of them: what the image does not show is dark.
    All,
}

/// What radii are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageSpaceProfile {
    /// The dipole of the medium, where there is one; else the sum of Gaussians.
    Medium,
    /// The sum of Gaussians that `texture-space` draws with.
    Gaussians,
}

impl SampleCount {
    /// All of them.
    pub const ALL: [SampleCount; 2] = [SampleCount::Valid, SampleCount::All];
}

impl ImageSpaceProfile {
    /// All of them.
    pub const ALL: [ImageSpaceProfile; 2] = [ImageSpaceProfile::Medium, ImageSpaceProfile::Gaussians];
}

impl fmt::Display for SampleCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SampleCount::Valid => "valid",
            SampleCount::All => "all",
        })
    }
}

impl fmt::Display for ImageSpaceProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ImageSpaceProfile::Medium => "medium",
            ImageSpaceProfile::Gaussians => "gaussians",
        })
    }
}

impl Default for ImageSpaceSettings {
    fn default() -> Self {
        Self {
            samples: 32,
            uniform_samples: 8,
            uniform_radius_mm: None,
            jacobian: true,
            count: SampleCount::Valid,
            light_views: true,
            profile: ImageSpaceProfile::Medium,
            round: 0,
        }
    }
}

impl ImageSpaceSettings {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        let (samples, uniform) = (self.samples, self.uniform_samples);
        within("samples of the profile", samples as f32, "1 to 4096", (1..=4096).contains(&samples))?;
        within("uniform samples", uniform as f32, "0 to 4096", uniform <= 4096)?;
        let radius_mm = self.uniform_radius_mm.unwrap_or(1.0);
        let is_good = radius_mm > 0.0 && radius_mm.is_finite();
        within("radius of the uniform samples", radius_mm, "above 0 and finite, in mm", is_good)
    }
}

/// Light gathered from an image of the irradiance.
pub struct Sampled<'a> {
    lit: Lit<'a>,
    image: IrradianceImage,
    /// Of every object, in order.
    kernels: Vec<RadialKernel>,
}

impl<'a> Sampled<'a> {
    /// Draws the image.
    ///
    /// # Errors
    /// If a material has no profile, or nobody wants the picture any more.
    pub fn new(lit: Lit<'a>, camera: &Camera, progress: &dyn Progress) -> Result<Self, RenderError> {
        let kernel = |object: &cutis_scene::Object| RadialKernel::new(&object.material, lit.settings);
        let kernels = lit.scene.objects.iter().map(kernel).collect::<Result<_, RenderError>>()?;
        let image = IrradianceImage::seen_by_camera(lit, camera, progress);
        if progress.goes_on() { Ok(Self { lit, image, kernels }) } else { Err(RenderError::Stopped) }
    }
}

impl Inside for Sampled<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let settings = &self.lit.settings.techniques.image_space;
        let kernel = &self.kernels[place.object_number];
        let (middle_mm, normal) = (place.point.position_mm, place.point.normal);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let (mut sum, mut valid, mut all) = (Vec3::ZERO, 0, 0);
        for sample in kernel.pattern(place.pixel) {
            all += 1;
            let on_plane_mm = middle_mm + tangent * sample.offset_mm[0] + bitangent * sample.offset_mm[1];
            let Some(seen) = self.image.through(on_plane_mm, place.object_number) else { continue };
            valid += 1;
            let jacobian = if settings.jacobian { seen.jacobian(normal) } else { 1.0 };
            let r_mm = seen.position_mm.distance(middle_mm);
            sum += kernel.at_mm(r_mm) * seen.irradiance_w_per_m2 * (jacobian / sample.pdf_per_mm2);
        }
        let count = if settings.count == SampleCount::Valid { valid } else { all };
        Exitance { local: sum / count.max(1) as f32, transmitted: Vec3::ZERO }
    }
}
