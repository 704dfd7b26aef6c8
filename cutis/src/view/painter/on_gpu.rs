//! Draws on a graphics adapter: textures and bindings of the picture before are kept as long as they fit.

use super::Work;
use super::artist::{Drawn, Subject};
use super::watch::Watch;
use crate::backend::Backend;
use crate::view::look::{Look, bad_pose};
use crate::view::screen::BEHIND;
use crate::view::shown::texture_maps;
use cutis_gpu::cost::by_pass;
use cutis_gpu::scene::SceneError;
use cutis_gpu::scene::development::Developing;
use cutis_gpu::{Adapters, GpuError, GpuRenderer, GpuScene};
use cutis_render::lit_scene::warnings;
use cutis_render::{AovSpace, Frame, Progress, RenderError, Renderer, Settings};
use cutis_scene::Scene;
use std::sync::Arc;

/// The open devices, for all sides: one for each kind of adapter, or why there is none.
#[derive(Default)]
pub struct Devices {
    hardware: Option<Result<Arc<GpuRenderer>, GpuError>>,
    any: Option<Result<Arc<GpuRenderer>, GpuError>>,
}

impl Devices {
    /// The renderer on the adapter that a backend means.
    pub fn renderer(&mut self, backend: Backend) -> Result<Arc<GpuRenderer>, GpuError> {
        let (open, adapters) = match backend {
            Backend::Gpu => (&mut self.any, Adapters::Any),
            _ => (&mut self.hardware, Adapters::Hardware),
        };
        if let Some(open) = open {
            return open.clone();
        }
        let opened = GpuRenderer::new(adapters).map(Arc::new);
        // What else stands in the way may pass, as when a driver is restarted.
        if matches!(opened, Ok(_) | Err(GpuError::NoAdapter { .. })) {
            *open = Some(opened.clone());
        }
        opened
    }

    /// With a renderer that passes for one on a graphics processor.
    #[cfg(test)]
    pub fn with_hardware(renderer: Arc<GpuRenderer>) -> Self {
        Self { hardware: Some(Ok(renderer)), any: None }
    }

    /// A device that gave up is opened anew the next time.
    fn forget(&mut self, renderer: &Arc<GpuRenderer>) {
        for open in [&mut self.hardware, &mut self.any] {
            if matches!(open, Some(Ok(one)) if Arc::ptr_eq(one, renderer)) {
                *open = None;
            }
        }
    }
}

/// Keeps the scene of the picture before.
#[derive(Default)]
pub struct OnGpu {
    kept: Option<Kept>,
}

struct Kept {
    renderer: Arc<GpuRenderer>,
    scene: Arc<Scene>,
    look: Look,
    settings: Settings,
    /// As it was uploaded.
    uploaded: Scene,
    ready: GpuScene,
}

impl Kept {
    /// Better light than is asked for is welcome, and poses are taken by the device; other lights are tried. Shadows are the
    /// same at every stage: the device tries enough places of a light's disc from the first.
    fn serves(&self, renderer: &Arc<GpuRenderer>, subject: &Subject) -> bool {
        Arc::ptr_eq(&self.renderer, renderer)
            && Arc::ptr_eq(&self.scene, subject.scene)
            && self.look.is_lit_like(&Look {
                pose: self.look.pose.clone(),
                lights: self.look.lights.clone(),
                surroundings: self.look.surroundings,
                ..subject.look.clone()
            })
            && self.settings.irradiance_size >= subject.settings.irradiance_size
    }

    /// Takes in the lights of a look. Tells whether that could be done.
    fn relight(&mut self, look: &Look) -> bool {
        if self.look.lights == look.lights && self.look.surroundings == look.surroundings {
            return true;
        }
        let lights = std::mem::replace(&mut self.uploaded.lights, look.lights_of(&self.scene));
        let environment = std::mem::replace(&mut self.uploaded.environment, look.environment_of(&self.scene));
        let is_relit = self.ready.set_lights(&self.renderer.gpu, &self.uploaded);
        if is_relit {
            (self.look.lights, self.look.surroundings) = (look.lights.clone(), look.surroundings);
        } else {
            (self.uploaded.lights, self.uploaded.environment) = (lights, environment);
        }
        is_relit
    }
}

impl OnGpu {
    /// The scene that is kept.
    #[cfg(test)]
    pub fn scene(&self) -> Option<&GpuScene> {
        self.kept.as_ref().map(|kept| &kept.ready)
    }

    /// Draws it.
    ///
    /// # Errors
    /// `RenderError::Backend` if the adapter is what stands in the way.
    pub fn draw(
        &mut self,
        devices: &mut Devices,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, RenderError> {
        // A device that was lost, as when its driver is restarted, is opened anew once.
        let drawn = match self.try_to_draw(devices, subject, watch) {
            Err(SceneError::Gpu(GpuError::Lost { .. })) => self.try_to_draw(devices, subject, watch),
            once => once,
        };
        drawn.map_err(|error| match error {
            SceneError::Render(error) => error,
            SceneError::Gpu(error) => RenderError::Backend { reason: error.to_string() },
        })
    }

    fn try_to_draw(
        &mut self,
        devices: &mut Devices,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, SceneError> {
        let renderer = devices.renderer(subject.look.drawing.backend)?;
        let drawn = self.draw_with(&renderer, subject, watch);
        if let Err(SceneError::Gpu(
            GpuError::Lost { .. } | GpuError::OutOfMemory { .. } | GpuError::Refused { .. },
        )) = &drawn
        {
            devices.forget(&renderer);
            self.kept = None;
        }
        drawn
    }

    fn draw_with(
        &mut self,
        renderer: &Arc<GpuRenderer>,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, SceneError> {
        let Subject { look, settings, scene, .. } = subject;
        if !self.kept.as_mut().is_some_and(|kept| kept.serves(renderer, subject) && kept.relight(look)) {
            settings.check().map_err(SceneError::Render)?;
            let uploaded = look.applied_to(scene)?;
            let shadow_samples = Settings::default().with_quality(look.drawing.quality).shadow_samples;
            let settings = &Settings { shadow_samples, ..settings.clone() };
            // What is there stays until the better light is: while things move a draft needs it.
            let ready = renderer.scene(&uploaded, settings, watch)?;
            self.kept = Some(Kept {
                renderer: Arc::clone(renderer),
                scene: Arc::clone(scene),
                look: (*look).clone(),
                settings: settings.clone(),
                uploaded,
                ready,
            });
        }
        if !watch.goes_on() {
            return Err(RenderError::Stopped.into());
        }
        let Some(kept) = &mut self.kept else { return Err(RenderError::EmptyScene.into()) };
        if kept.look.pose != look.pose {
            let posed = kept.ready.set_pose(&renderer.gpu, &kept.uploaded, &look.pose);
            posed.map_err(|error| bad_pose(&error))?;
            kept.look.pose = look.pose.clone();
        }
        kept.ready.set_picture(&renderer.gpu, &renderer.passes, settings)?;
        kept.ready.set_camera(&renderer.gpu, &look.camera);
        let sampled = |settings: &Settings| (settings.samples_grid(), settings.techniques.image_space.round);
        if sampled(&kept.settings) != sampled(settings) {
            kept.ready.set_sampling(&renderer.gpu, settings)?;
            kept.settings.samples_per_pixel = settings.samples_per_pixel;
            kept.settings.techniques.image_space.round = settings.techniques.image_space.round;
        }
        match subject.film {
            Some(film) => {
                let how = Developing { film, behind: BEHIND };
                kept.ready.set_film(&renderer.gpu, &renderer.passes, how)?;
            }
            None => kept.ready.unset_film(),
        }
        Ok(Self::frame(renderer, kept, subject)?)
    }

    fn frame(renderer: &GpuRenderer, kept: &Kept, subject: &Subject) -> Result<Drawn, GpuError> {
        let (settings, ready) = (&subject.settings, &kept.ready);
        let passes = ready.look_timed(&renderer.gpu)?;
        // The light itself is what files hold and the pointer reads.
        let (pixels, codes) = (ready.picture(&renderer.gpu)?, ready.developed(&renderer.gpu)?);
        let layers = ready.layers(&renderer.gpu, &renderer.passes, &settings.aovs, AovSpace::Picture)?;
        let wanted: Vec<_> = texture_maps().filter(|_| subject.wants_maps).collect();
        let maps = ready.layers(&renderer.gpu, &renderer.passes, &wanted, AovSpace::Texture)?;
        let mut told = warnings(&kept.uploaded, settings);
        told.extend(ready.shared.warnings.iter().cloned());
        let frame = Frame {
            width: settings.width,
            height: settings.height,
            pixels,
            layers,
            passes,
            diffusion_reports: Vec::new(),
            warnings: told,
        };
        let work = Some(Work { memory_bytes: ready.memory_bytes(), costs: by_pass(&ready.costs()) });
        Ok(Drawn { frame, maps, machine: renderer.adapter(), work, codes })
    }
}
