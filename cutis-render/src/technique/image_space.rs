//! Samples of the diffusion profile around the point that is looked at, taken from an image of the irradiance
//! (Mertens, Kautz, Bekaert, Van Reeth & Seidel 2003, "Efficient rendering of local subsurface scattering").
//!
//! Symbols: x' a sample on the tangent plane, r' its distance from the point; p what the image shows in its place, r the true
//! distance of p; E irradiance. The estimate of ∫ R(r) E dA is Σ R(r) E(p) |dA/dA'| / (N p(r')), r' drawn with density p.
//! The medium may differ from pixel to pixel (see [`crate::prepare::mixtures`]).
//! Beside the paper: samples of all channels at once, of any profile; the place of a sample lies on the plane of the texel
//! that shows it, not at its middle. The paper combines images by the balance heuristic, which needs them to agree on what
//! they show: maps of different grain do not, and dark stripes come of it. The first image that shows a place answers for it.
//! Not modelled: what no image shows. Light that enters there is missing, or counts as what is seen.

use super::{Exitance, Inside};
use crate::lit_scene::Lit;
use crate::passes::irradiance_image::{IrradianceImage, View};
use crate::passes::resolve::Place;
use crate::prepare::LightView;
use crate::prepare::mixtures::{self, mixture_at};
use crate::prepare::radial::{PlaceToLook, RadialKernel};
use crate::settings::within;
use crate::{Progress, RenderError};
use cutis_scene::{Camera, Object, SurfacePoint};
use glam::Vec3;
use std::fmt;

/// Lights whose far sides are looked for: more would each cost as much as the camera's own image.
pub const MAX_LIGHT_VIEWS: usize = 4;
/// Width and height of what a light sees, texels.
pub const LIGHT_VIEW_TEXELS: usize = 512;

/// Most that a sample may count, in times of one that lies where it was drawn: at contours some are seen much nearer than that,
/// and a few of them would make specks. Without the Jacobian, which holds most of them in check, none counts more.
pub const MAX_GAIN: f32 = 2.0;

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
    /// Those that met the body, as in the paper: what the image does not show counts like what it shows. Where lights have
    /// images of their own, these show it, and all samples count.
    Valid,
    /// All of them: what the image does not show is dark.
    All,
}

/// What radii are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageSpaceProfile {
    /// The dipole of the medium or the multipole of layers, where they are known; else the sum of Gaussians.
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
        let is_good = radius_mm > 0.0 && radius_mm <= 1e6;
        within("radius of the uniform samples", radius_mm, "above 0, up to 1000000 mm", is_good)
    }
}

/// Light gathered from images of the irradiance.
pub struct Sampled<'a> {
    lit: Lit<'a>,
    /// What the camera sees, then what lights see.
    images: Vec<IrradianceImage>,
    /// Of every object, in order.
    kernels: Vec<Kernels>,
}

/// Profiles of one object's mixtures, for places that are a whole pixel and for those that share it.
struct Kernels {
    whole: Vec<RadialKernel>,
    shared: Vec<RadialKernel>,
}

impl Kernels {
    /// The profile of a place.
    fn at(&self, place: &Place, settings: &ImageSpaceSettings) -> &RadialKernel {
        let all = if place.is_whole_pixel { &self.whole } else { &self.shared };
        let share = place.object.material.share_at(place.point.map_uv);
        &all[mixture_at(share, all.len() as u32, place.sample, settings)]
    }
}

impl<'a> Sampled<'a> {
    /// Draws the images.
    ///
    /// # Errors
    /// If a material has no profile, or nobody wants the picture any more.
    pub fn new(lit: Lit<'a>, camera: &Camera, progress: &dyn Progress) -> Result<Self, RenderError> {
        let settings = lit.settings;
        let grid = settings.samples_grid();
        let kernels = |object: &Object| {
            let material = &object.material;
            let whole =
                RadialKernel::of_mixtures(material, settings, mixtures::count([material].into_iter()))?;
            let again = |kernel: &RadialKernel| kernel.sampled(&settings.techniques.image_space, grid * grid);
            let shared = whole.iter().map(again).collect::<Result<_, _>>()?;
            Ok(Kernels { whole, shared })
        };
        let kernels = lit.scene.objects.iter().map(kernels).collect::<Result<_, RenderError>>()?;
        let size = [settings.width, settings.height].map(|side| (side * grid) as usize);
        let view = View::of_camera(camera, size[0] as f32 / size[1] as f32);
        let of_camera = (view, size);
        let of_lights = light_views(lit).into_iter().map(|view| (view, [LIGHT_VIEW_TEXELS; 2]));
        let images = std::iter::once(of_camera)
            .chain(of_lights)
            .map(|(view, size)| IrradianceImage::new(lit, view, size, progress))
            .collect();
        if progress.goes_on() { Ok(Self { lit, images, kernels }) } else { Err(RenderError::Stopped) }
    }
}

/// Views of the lights that see far sides, where they are wanted.
pub fn light_views(lit: Lit) -> Vec<View> {
    let points = || lit.scene.objects.iter().flat_map(|o| o.mesh.positions_mm.iter().copied());
    let lights = lit.scene.lights.iter().take(MAX_LIGHT_VIEWS);
    let wanted = lights.filter(|_| lit.settings.techniques.image_space.light_views);
    wanted.filter_map(|light| Some(View::of_light(&LightView::over_points(light, points())?))).collect()
}

/// Normal of the plane that samples lie on, and of what images show: that of the triangle, on which all around the point lies,
/// too. Without the Jacobian triangles would show where they meet, and it is that of the smooth surface, as in the paper.
pub fn plane_normal(settings: &ImageSpaceSettings, point: &SurfacePoint) -> Vec3 {
    if settings.jacobian { point.flat_normal } else { point.normal }
}

/// The point that light is gathered for, and the plane that samples lie on.
struct Gathering<'a> {
    settings: &'a ImageSpaceSettings,
    images: &'a [IrradianceImage],
    kernel: &'a RadialKernel,
    object: usize,
    middle_mm: Vec3,
    normal: Vec3,
}

impl Gathering<'_> {
    /// Light that is found in one image around the point, W/m², of all that the images before do not show.
    fn found_in_image(&self, number: usize, places: &[PlaceToLook]) -> Vec3 {
        let (tangent, bitangent) = self.normal.any_orthonormal_pair();
        let (image, before) = (&self.images[number], &self.images[..number]);
        let (mut sum, mut valid) = (Vec3::ZERO, 0);
        for place in places {
            let offset_mm = tangent * place.offset_mm.x + bitangent * place.offset_mm.y;
            let plane_mm = self.middle_mm + offset_mm;
            let Some(seen) = image.through(plane_mm, self.object) else { continue };
            valid += 1;
            let r = self.kernel.at_mm((offset_mm + seen.from_point_mm).length()).truncate();
            // Beyond the table nothing is drawn, but rounding may lead there.
            let is_nothing = r == Vec3::ZERO || place.density_per_mm2 <= 0.0;
            if is_nothing || before.iter().any(|image| image.shows(&seen, self.object)) {
                continue;
            }
            let on_body = [seen.position_mm, seen.normal];
            let jacobian = match self.settings.jacobian {
                true => image.view.jacobian(on_body, [plane_mm, self.normal]),
                false => 1.0,
            };
            let drawn = self.kernel.at_mm(offset_mm.length()).truncate();
            let most = if self.settings.jacobian { MAX_GAIN } else { 1.0 };
            let most = drawn.abs() * most;
            let found = (r * jacobian).clamp(-most, most);
            sum += found * seen.irradiance_w_per_m2 / place.density_per_mm2;
        }
        // Where lights look for what the camera misses, it must not be made up for: what they miss as well is dark.
        let counts = self.settings.count == SampleCount::Valid && self.images.len() == 1 && valid > 0;
        // Thin layers take light away where they get it to: never more than there is.
        (if counts { sum * (places.len() as f32 / valid as f32) } else { sum }).max(Vec3::ZERO)
    }
}

impl Inside for Sampled<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let settings = &self.lit.settings.techniques.image_space;
        let kernel = self.kernels[place.object_number].at(place, settings);
        let gathering = Gathering {
            settings,
            images: &self.images,
            kernel,
            object: place.object_number,
            middle_mm: place.point.position_mm,
            normal: plane_normal(settings, &place.point),
        };
        let places = kernel.places_of(place.sample);
        let of_lights = (1..self.images.len()).map(|number| gathering.found_in_image(number, places));
        Exitance { local: gathering.found_in_image(0, places), transmitted: of_lights.sum() }
    }
}
