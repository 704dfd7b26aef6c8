//! Draws on a graphics adapter: textures and bindings of the picture before are kept as long as they fit.

use super::Work;
use super::artist::{Drawn, Subject};
use super::watch::Watch;
use crate::backend::Backend;
use crate::view::look::{Look, bad_pose};
use crate::view::shown::texture_maps;
use cutis_gpu::cost::by_pass;
use cutis_gpu::scene::SceneError;
use cutis_gpu::{Adapters, GpuError, GpuRenderer, GpuScene};
use cutis_render::technique::texture_space::warnings;
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
    fn renderer(&mut self, backend: Backend) -> Result<Arc<GpuRenderer>, GpuError> {
        let (open, adapters) = match backend {
            Backend::Gpu => (&mut self.any, Adapters::Any),
            _ => (&mut self.hardware, Adapters::Hardware),
        };
        open.get_or_insert_with(|| GpuRenderer::new(adapters).map(Arc::new)).clone()
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
    /// Better light than is asked for is welcome, and poses are taken by the device. Shadows are the
    /// same at every stage: the device tries enough places of a light's disc from the first. What rays find, and the device
    /// cannot, is found anew for the best picture of a pose.
    fn serves(&self, renderer: &Arc<GpuRenderer>, subject: &Subject) -> bool {
        Arc::ptr_eq(&self.renderer, renderer)
            && Arc::ptr_eq(&self.scene, subject.scene)
            && self.look.is_lit_like(&Look { pose: self.look.pose.clone(), ..subject.look.clone() })
            && (!subject.is_best || self.uploaded.pose() == subject.look.pose)
            && self.settings.irradiance_size >= subject.settings.irradiance_size
    }
}

impl OnGpu {
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
        let renderer = devices.renderer(subject.look.drawing.backend).map_err(|error| because(&error))?;
        self.draw_with(&renderer, subject, watch).map_err(|error| match error {
            SceneError::Render(error) => error,
            SceneError::Gpu(error) => {
                if matches!(
                    error,
                    GpuError::Lost { .. } | GpuError::OutOfMemory { .. } | GpuError::Refused { .. }
                ) {
                    devices.forget(&renderer);
                    self.kept = None;
                }
                because(&error)
            }
        })
    }

    fn draw_with(
        &mut self,
        renderer: &Arc<GpuRenderer>,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, SceneError> {
        let Subject { look, settings, scene, .. } = subject;
        if !self.kept.as_ref().is_some_and(|kept| kept.serves(renderer, subject)) {
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
        Ok(Self::frame(renderer, kept, subject)?)
    }

    fn frame(renderer: &GpuRenderer, kept: &Kept, subject: &Subject) -> Result<Drawn, GpuError> {
        let (settings, ready) = (&subject.settings, &kept.ready);
        let passes = ready.look_timed(&renderer.gpu)?;
        let pixels = ready.picture(&renderer.gpu)?;
        let layers = ready.layers(&renderer.gpu, &renderer.passes, &settings.aovs, AovSpace::Picture)?;
        let wanted: Vec<_> = texture_maps().filter(|_| subject.wants_maps).collect();
        let maps = ready.layers(&renderer.gpu, &renderer.passes, &wanted, AovSpace::Texture)?;
        let mut told = warnings(&kept.uploaded);
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
        Ok(Drawn { frame, maps, machine: renderer.adapter(), work })
    }
}

fn because(error: &GpuError) -> RenderError {
    RenderError::Backend { reason: error.to_string() }
}
