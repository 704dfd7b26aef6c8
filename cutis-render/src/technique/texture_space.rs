//! Texture-space diffusion with translucent shadows: the algorithm of d'Eon, Luebke & Enderton 2007, section 5.4.

use crate::frame::{Frame, Layer, PassTime};
use crate::passes::ambient::Ambient;
use crate::passes::atlas::Atlas;
use crate::passes::blur::Fields;
use crate::passes::diffusion::operator;
use crate::passes::half_size::{HalfSize, Rays};
use crate::passes::irradiance::{IrradianceInputs, distance_slot, irradiance};
use crate::passes::object_maps::ObjectMaps;
use crate::passes::picture::picture;
use crate::passes::resolve::Resolve;
use crate::passes::seam_map::chart_numbers;
use crate::passes::seams::{DiffusionReport, diffusion_report};
use crate::passes::stretch::stretch_mm_per_texel;
use crate::passes::transmission::{Bodies, Transmission};
use crate::prepare::kernel::kernel_of;
use crate::prepare::{FilteredEnvironment, Kernel, RhoDt};
use crate::settings::{Aov, AovSpace, Diffusion, Settings};
use crate::{Progress, RenderError};
use cutis_optics::{Dipole, Medium, presets};
use cutis_scene::{Bvh, Camera, Material, Object, Scattering, Scene};
use glam::Vec4;
use std::ops::Deref;
use std::sync::Arc;
use std::time::Instant;

/// Standard deviations of the widest Gaussian beyond which a body is opaque: exp(-5.5²/2) = 3e-7 comes through, which
/// transmission takes for nothing.
const OPAQUE_DEVIATIONS: f32 = 5.5;
/// Smallest irradiance texture of an object that is much smaller than the largest.
const MIN_ATLAS: u32 = 64;

/// A scene whose light has been gathered and spread, ready to be looked at from anywhere. It borrows the scene, or owns it.
pub struct LitScene<S> {
    scene: S,
    bvh: Bvh,
    environment: Option<FilteredEnvironment>,
    maps: Vec<ObjectMaps>,
    transmission: Vec<Transmission>,
    clock: Clock,
}

/// Draws a scene.
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
    frame.warnings = warnings(scene);
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
        let bodies = Bodies { scene: &scene, bvh: &bvh, maps: &maps };
        let transmission = clock.time("transmission", || {
            scene.objects.iter().zip(&maps).map(|(o, maps)| bodies.transmission(o, maps, progress)).collect()
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
        let environment = self.environment.as_ref();
        let seams: Vec<_> = if aovs.contains(&Aov::Seams) {
            self.scene.objects.iter().zip(&self.maps).map(|(object, maps)| maps.seam_map(object)).collect()
        } else {
            Vec::new()
        };
        let resolve = Resolve {
            scene: &self.scene,
            bvh: &self.bvh,
            environment,
            maps: &self.maps,
            transmission: &self.transmission,
            seams: &seams,
            aovs,
        };
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

    /// Distances through the body towards the first four lights, texel by texel, mm.
    fn distances_mm(&self, maps: &ObjectMaps) -> Vec<Vec4> {
        let layers = &maps.diffused.levels[0].layers;
        let mut distances = vec![Vec4::ZERO; layers[0].len()];
        for l in 0..self.scene.lights.len().min(4) {
            let (layer, component) = distance_slot(l);
            distances.iter_mut().zip(&layers[layer]).for_each(|(to, from)| to[l] = from[component]);
        }
        distances
    }

    /// A pass's own texture, of the first object. `None` for layers that exist only in the picture.
    pub fn texture_layer(&self, aov: Aov) -> Option<Layer> {
        let maps = self.maps.first()?;
        let level = |i: usize| maps.diffused.levels.get(i).map(|l| (l.charts.size, l.layers[0].clone()));
        let (size, pixels) = match aov {
            Aov::Irradiance => level(0)?,
            Aov::Blur(i) => level(usize::from(i) + 1)?,
            Aov::Thickness => (maps.atlas.size, self.distances_mm(maps)),
            Aov::Stretch => {
                (maps.atlas.size, maps.stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0)).collect())
            }
            Aov::Charts => (maps.atlas.size, chart_numbers(&maps.atlas.charts)),
            Aov::Seams => (maps.atlas.size, maps.seam_map(self.scene.objects.first()?)),
            Aov::ShadowSamples => {
                (maps.atlas.size, maps.tried.iter().map(|&tried| Vec4::splat(tried as f32)).collect())
            }
            Aov::Normal
            | Aov::Albedo
            | Aov::Specular
            | Aov::Transmission
            | Aov::Diffuse
            | Aov::Exitance
            | Aov::Samples
            | Aov::StandardError => return None,
        };
        Some(Layer {
            name: aov.to_string(),
            width: size as u32,
            height: size as u32,
            channels: aov.channels(),
            pixels,
        })
    }
}

/// The passes that fill one object's textures.
struct ObjectPass<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    bvh: &'a Bvh,
    environment: Option<&'a FilteredEnvironment>,
    object: &'a Object,
}

impl ObjectPass<'_> {
    fn run(
        &self,
        size: usize,
        clock: &mut Clock,
        progress: &dyn Progress,
    ) -> Result<ObjectMaps, RenderError> {
        let (object, settings) = (self.object, self.settings);
        let kernel = clock.time("kernel", || chosen_kernel(&object.material, settings))?;
        let rho_dt = clock.time("rho_dt", || RhoDt::new(object.material.f0));
        let atlas = clock.time("atlas", || Atlas::new(object, size));
        let stretch_mm = clock.time("stretch", || stretch_mm_per_texel(object, &atlas));
        let samples = if self.environment.is_some() { settings.ambient_samples } else { 0 };
        let half_charts = clock.time("atlas", || atlas.charts.halved());
        let ambient = clock.time("ambient occlusion", || {
            Ambient::new(object, &atlas, half_charts.halved(), self.bvh, samples, settings.seed, progress)
        });
        wanted(progress)?;
        let thickness_scale = object.material.thickness_scale;
        let opaque_mm = opaque_mm(&kernel);
        let rays = Rays { scene: self.scene, bvh: self.bvh, settings, opaque_mm, thickness_scale };
        let half_size = clock.time("shadows", || HalfSize::new(rays, object, &atlas, &half_charts, progress));
        wanted(progress)?;
        let inputs = IrradianceInputs {
            rays,
            object,
            atlas: &atlas,
            half_size: &half_size,
            ambient: &ambient,
            environment: self.environment,
            rho_dt: &rho_dt,
        };
        let lit = clock.time("irradiance", || irradiance(&inputs, progress));
        wanted(progress)?;
        let charts = Arc::clone(&atlas.charts);
        let fields = Fields::new(lit.layers, stretch_mm.clone());
        let diffused = clock.time("blur", || {
            operator(settings.diffusion).diffuse(charts, fields, &kernel.variances_mm2, progress)
        });
        Ok(ObjectMaps {
            atlas,
            half_charts,
            stretch_mm,
            ambient,
            diffused,
            visibility: lit.visibility,
            shares: lit.shares,
            tried: lit.tried,
            kernel,
            rho_dt,
        })
    }
}

/// Ends the work if nobody wants it any more.
fn wanted(progress: &dyn Progress) -> Result<(), RenderError> {
    if progress.goes_on() { Ok(()) } else { Err(RenderError::Stopped) }
}

/// The kernel of a material under the diffusion operator of the settings.
///
/// # Errors
/// If the material cannot be turned into a kernel, or its thickness scale makes no sense.
pub fn chosen_kernel(material: &Material, settings: &Settings) -> Result<Kernel, RenderError> {
    check_thickness_scale(material)?;
    let kernel = kernel_of(material, settings.gaussians)?;
    Ok(match settings.diffusion {
        Diffusion::Separable => kernel.without(&settings.muted_gaussians),
        Diffusion::None => Kernel::opaque(kernel.total()),
    })
}

fn check_thickness_scale(material: &Material) -> Result<(), RenderError> {
    let scale = material.thickness_scale;
    if scale.is_finite() && scale >= 0.0 {
        return Ok(());
    }
    let reason = format!("its thickness scale is {scale}; it must be finite and not negative");
    Err(RenderError::BadMaterial { material: material.name.clone(), reason })
}

/// Thickness of a body, scaled, beyond which nothing comes through, mm.
pub fn opaque_mm(kernel: &Kernel) -> f32 {
    OPAQUE_DEVIATIONS * kernel.reach_mm()
}

/// Size of each object's texture: the largest object gets all of it (rounded up so that it can be halved), others by the square root of their area, in
/// powers of two below.
pub fn atlas_sizes(objects: &[Object], largest: u32) -> Vec<u32> {
    let area = |object: &Object| {
        (0..object.mesh.triangles.len()).map(|t| f64::from(object.mesh.area_mm2(t))).sum::<f64>()
    };
    let areas: Vec<f64> = objects.iter().map(area).collect();
    let most = areas.iter().copied().fold(0.0, f64::max);
    let largest = largest.next_multiple_of(8);
    let size = |area: &f64| {
        let mut size = largest;
        while size.is_multiple_of(2)
            && size / 2 >= MIN_ATLAS
            && f64::from(size / 2) >= f64::from(largest) * (area / most).sqrt()
        {
            size /= 2;
        }
        size
    };
    areas.iter().map(size).collect()
}

/// What a person should know of a scene that is drawn by this technique.
pub fn warnings(scene: &Scene) -> Vec<String> {
    let open = scene.objects.iter().filter(|object| !object.closed).map(|object| {
        let name = &object.name;
        format!("'{name}' is not a closed surface: light that enters may find no way out, and thin parts stay dark")
    });
    let media = scene.objects.iter().filter_map(|object| media_of(&object.material)).flatten();
    let invalid = media.filter_map(|medium| {
        let validity = Dipole::new(&medium).ok()?.validity();
        (!validity.is_good()).then(|| validity.to_string())
    });
    open.chain(invalid).collect()
}

/// The media of a material that is given by its coefficients.
fn media_of(material: &Material) -> Option<[Medium; 3]> {
    match &material.scattering {
        Scattering::Medium(media) => Some(*media),
        Scattering::Preset(name) => presets::find(name).ok()?.media().copied(),
        Scattering::Kernel(_) => None,
    }
}

/// Adds up the time of each pass.
#[derive(Default)]
struct Clock {
    passes: Vec<PassTime>,
}

impl Clock {
    fn time<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let time = start.elapsed();
        match self.passes.iter_mut().find(|pass| pass.name == name) {
            Some(pass) => pass.time += time,
            None => self.passes.push(PassTime { name: name.to_owned(), time }),
        }
        result
    }
}
