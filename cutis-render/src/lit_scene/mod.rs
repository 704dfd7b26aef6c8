//! A scene whose light has been gathered: what all techniques but the truth stand on.
//!
//! Atlas, openness, shadows and irradiance are the same for all of them, and so is the final pass. A technique says how
//! light is spread over the texture, and what leaves at the place that is looked at ([`crate::technique::Inside`]).

mod clock;
mod kernel;
mod object_pass;
mod texture_layers;
mod warnings;

use crate::frame::Frame;
use crate::passes::blur::Fields;
use crate::passes::diffusion::{Diffused, operator};
use crate::passes::object_maps::ObjectMaps;
use crate::passes::picture::picture;
use crate::passes::resolve::Resolve;
use crate::passes::seams::{DiffusionReport, diffusion_report};
use crate::passes::thin_parts::come_through;
use crate::passes::transmission::{Bodies, Transmission};
use crate::prepare::FilteredEnvironment;
use crate::prepare::kernel::kernel_of;
use crate::settings::{Aov, AovSpace, Settings, TechniqueName};
use crate::technique::{Inside, depth_absorption, image_space, texture_blur, texture_space, wrap};
use crate::{PassTime, Progress, RenderError};
use clock::Clock;
use cutis_scene::{Bvh, Camera, Object, Scene};
pub use kernel::{chosen_kernel, opaque_mm};
use object_pass::ObjectPass;
use std::ops::Deref;
use std::sync::Arc;
pub use warnings::{laid_out_anew, left_out, warnings};

/// Smallest irradiance texture of an object that is much smaller than the largest.
const MIN_ATLAS: u32 = 64;
/// Width of a chart and its padding, texels, if all charts of an object had as much of its texture.
const CHART_TEXELS: f64 = 8.0;

/// A scene whose light has been gathered and spread, ready to be looked at from anywhere. It borrows the scene, or owns it.
pub struct LitScene<S> {
    scene: S,
    bvh: Bvh,
    environment: Option<FilteredEnvironment>,
    maps: Vec<ObjectMaps>,
    transmission: Vec<Transmission>,
    clock: Clock,
}

/// What is known of a scene once its light has been gathered.
#[derive(Clone, Copy)]
pub struct Lit<'a> {
    /// The whole scene.
    pub scene: &'a Scene,
    /// Rays against it.
    pub bvh: &'a Bvh,
    /// The environment, if there is one.
    pub environment: Option<&'a FilteredEnvironment>,
    /// Textures and tables of each object.
    pub maps: &'a [ObjectMaps],
    /// How it is drawn.
    pub settings: &'a Settings,
}

/// Draws a scene by any technique but the truth.
///
/// # Errors
/// If a material cannot be turned into a kernel.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Frame, RenderError> {
    let mut lit = LitScene::new(scene, settings, progress)?;
    let mut frame = lit.resolve(&scene.camera, settings, progress)?;
    if settings.aov_space == AovSpace::Texture {
        frame.layers = settings.aovs.iter().filter_map(|&aov| lit.texture_layer(aov)).collect();
    }
    if settings.diffusion_report {
        frame.diffusion_reports = lit.reports();
    }
    frame.passes = lit.take_passes();
    frame.warnings = warnings(scene, settings);
    Ok(frame)
}

impl<S: Deref<Target = Scene>> LitScene<S> {
    /// Runs every pass but the last.
    ///
    /// # Errors
    /// If a material cannot be turned into a kernel.
    pub fn new(scene: S, settings: &Settings, progress: &dyn Progress) -> Result<Self, RenderError> {
        let mut clock = Clock::default();
        let bvh = clock.time("acceleration structure", || Bvh::build(&scene.objects));
        let environment =
            clock.time("environment", || scene.environment.as_ref().map(FilteredEnvironment::new));
        let sizes = atlas_sizes(&scene.objects, settings.irradiance_size);
        let mut maps = Vec::with_capacity(scene.objects.len());
        for (object, size) in scene.objects.iter().zip(sizes) {
            let pass =
                ObjectPass { scene: &scene, settings, bvh: &bvh, environment: environment.as_ref(), object };
            maps.push(pass.run(size as usize, &mut clock, progress)?);
            wanted(progress)?;
        }
        for i in 0..maps.len() {
            let bodies = Bodies { scene: &scene, bvh: &bvh, maps: &maps };
            maps[i].diffused = spread(bodies, i, settings, &mut clock, progress)?;
            wanted(progress)?;
        }
        let bodies = Bodies { scene: &scene, bvh: &bvh, maps: &maps };
        // The others have ways of their own for light that comes through.
        let comes_through = settings.light_inside() == TechniqueName::TextureSpace;
        let transmission = clock.time("transmission", || {
            let pairs = scene.objects.iter().zip(&maps).filter(|_| comes_through);
            pairs.map(|(o, maps)| bodies.transmission(o, maps, progress)).collect()
        });
        Ok(Self { scene, bvh, environment, maps, transmission, clock })
    }

    /// The final pass: a picture through a camera.
    ///
    /// # Errors
    /// Only [`RenderError::Stopped`].
    pub fn resolve(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Frame, RenderError> {
        let aovs: &[Aov] = if settings.aov_space == AovSpace::Picture { &settings.aovs } else { &[] };
        let lit = Lit {
            scene: &self.scene,
            bvh: &self.bvh,
            environment: self.environment.as_ref(),
            maps: &self.maps,
            settings,
        };
        let seams: Vec<_> = if aovs.contains(&Aov::Seams) {
            self.scene.objects.iter().zip(&self.maps).map(|(object, maps)| maps.seam_map(object)).collect()
        } else {
            Vec::new()
        };
        let inside = inside(lit, &self.transmission, camera, &mut self.clock, progress)?;
        let resolve = Resolve { lit, inside: inside.as_ref(), seams: &seams, aovs };
        let frame = self.clock.time("resolve", || picture(&resolve, camera, settings, progress));
        wanted(progress)?;
        Ok(frame)
    }

    /// Energy and seam error of every object.
    pub fn reports(&self) -> Vec<DiffusionReport> {
        self.scene
            .objects
            .iter()
            .zip(&self.maps)
            .map(|(object, maps)| diffusion_report(object, maps))
            .collect()
    }

    /// Textures and tables of each object.
    pub fn maps(&self) -> &[ObjectMaps] {
        &self.maps
    }

    /// What was done and how long it took, since the light was gathered or this was asked for the last time.
    pub fn take_passes(&mut self) -> Vec<PassTime> {
        std::mem::take(&mut self.clock.passes)
    }
}

/// The light of object number `i`, spread over its texture. The light that enters the others is known already.
fn spread(
    bodies: Bodies,
    i: usize,
    settings: &Settings,
    clock: &mut Clock,
    progress: &dyn Progress,
) -> Result<Diffused, RenderError> {
    let (object, maps) = (&bodies.scene.objects[i], &bodies.maps[i]);
    let through = if adds_thin_parts(settings) {
        let deviation_mm =
            clock.time("kernel", || kernel_of(&object.material, settings.gaussians))?.deviation_mm();
        Some(clock.time("transmission", || come_through(&bodies, i, deviation_mm, progress)))
    } else {
        None
    };
    let [made, spread] = names(settings);
    let operator = clock.time(made, || operator(settings, object, maps, through))?;
    let layers = Arc::clone(&maps.diffused.levels[0].layers);
    let fields = Fields { layers, stretch_mm: maps.stretch_mm.clone() };
    let charts = Arc::clone(&maps.atlas.charts);
    let variances_mm2 = &maps.kernel.variances_mm2;
    Ok(clock.time(spread, || operator.diffuse(charts, fields, variances_mm2, progress)))
}

/// What making the operator is called, and spreading light by it.
fn names(settings: &Settings) -> [&'static str; 2] {
    if settings.lets_heat_flow() { ["links", "heat flow"] } else { ["kernel", "blur"] }
}

/// Whether light that comes through thin parts is spread with what falls in.
pub fn adds_thin_parts(settings: &Settings) -> bool {
    settings.light_inside() == TechniqueName::TextureBlur && settings.techniques.texture_blur.depth
}

/// What the technique knows of the light inside; seen by a camera, where that is how it looks.
fn inside<'a>(
    lit: Lit<'a>,
    transmission: &'a [Transmission],
    camera: &Camera,
    clock: &mut Clock,
    progress: &dyn Progress,
) -> Result<Box<dyn Inside + 'a>, RenderError> {
    let spread = || Box::new(texture_space::Spread::new(transmission));
    Ok(match lit.settings.light_inside() {
        TechniqueName::Wrap => Box::new(wrap::Wrapped::new(lit)?),
        TechniqueName::DepthAbsorption => {
            Box::new(clock.time("depth map", || depth_absorption::Absorbed::new(lit))?)
        }
        TechniqueName::TextureBlur => Box::new(texture_blur::Blurred),
        TechniqueName::ImageSpace => {
            Box::new(clock.time("irradiance image", || image_space::Sampled::new(lit, camera, progress))?)
        }
        TechniqueName::TextureSpace | TechniqueName::Truth => spread(),
    })
}

/// Ends the work if nobody wants it any more.
fn wanted(progress: &dyn Progress) -> Result<(), RenderError> {
    if progress.goes_on() { Ok(()) } else { Err(RenderError::Stopped) }
}

/// Size of each object's texture: the largest object gets all of it (rounded up so that it can be halved), others by the square root of
/// their area, in powers of two below, but no less than their charts need to have texels each.
pub fn atlas_sizes(objects: &[Object], largest: u32) -> Vec<u32> {
    let area = |object: &Object| {
        (0..object.mesh.triangles.len()).map(|t| f64::from(object.mesh.area_mm2(t))).sum::<f64>()
    };
    let areas: Vec<f64> = objects.iter().map(area).collect();
    let most = areas.iter().copied().fold(0.0, f64::max);
    let largest = largest.next_multiple_of(8);
    let size = |(area, object): (&f64, &Object)| {
        let least = MIN_ATLAS.max((CHART_TEXELS * f64::from(object.charts.count).sqrt()) as u32);
        let mut size = largest;
        while size.is_multiple_of(2)
            && size / 2 >= least
            && f64::from(size / 2) >= f64::from(largest) * (area / most).sqrt()
        {
            size /= 2;
        }
        size
    };
    areas.iter().zip(objects).map(size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::Material;
    use cutis_scene::validation::shapes::capsule;
    use glam::Vec3;

    /// A small body has a small map, unless it lies on the texture in a thousand pieces.
    #[test]
    fn maps_are_as_large_as_bodies_and_their_charts_need() {
        let body =
            |radius_mm| Object::new("body", capsule(Vec3::ZERO, radius_mm, 0.0, 64), Material::default());
        let (large, small) = (body(100.0), body(1.0));
        let mut cut = small.clone();
        cut.charts.count = 1000;
        assert_eq!(atlas_sizes(&[large.clone(), small], 1020), [1024, 64]);
        assert_eq!(atlas_sizes(&[large, cut], 1020), [1024, 256]);
    }
}
