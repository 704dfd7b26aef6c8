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

/// The open device, for all sides.
#[derive(Default)]
pub struct Device {
    open: Option<(Adapters, Arc<GpuRenderer>)>,
}

impl Device {
    /// The renderer on the adapter that a backend means.
    fn renderer(&mut self, backend: Backend) -> Result<Arc<GpuRenderer>, RenderError> {
        let adapters = if backend == Backend::Gpu { Adapters::Any } else { Adapters::Hardware };
        if let Some((kind, renderer)) = &self.open
            && *kind == adapters
        {
            return Ok(Arc::clone(renderer));
        }
        let renderer = Arc::new(GpuRenderer::new(adapters).map_err(|error| because(&error))?);
        self.open = Some((adapters, Arc::clone(&renderer)));
        Ok(renderer)
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
    /// Better light than is asked for is welcome, and poses are taken by the device. Every place of a light's disc that is
    /// tried costs the same in every frame, so that there are enough of them from the first.
    fn serves(&self, renderer: &Arc<GpuRenderer>, subject: &Subject) -> bool {
        Arc::ptr_eq(&self.renderer, renderer)
            && Arc::ptr_eq(&self.scene, subject.scene)
            && self.look.is_lit_like(&Look { pose: self.look.pose.clone(), ..subject.look.clone() })
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
        device: &mut Device,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, RenderError> {
        let renderer = device.renderer(subject.look.drawing.backend)?;
        let result = self.draw_with(&renderer, subject, watch);
        if matches!(result, Err(RenderError::Backend { .. })) {
            // A device that gave up is opened anew the next time.
            (device.open, self.kept) = (None, None);
        }
        result
    }

    fn draw_with(
        &mut self,
        renderer: &Arc<GpuRenderer>,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, RenderError> {
        let Subject { look, settings, scene, .. } = subject;
        let mut kept = match self.kept.take().filter(|kept| kept.serves(renderer, subject)) {
            Some(kept) => kept,
            None => {
                settings.check()?;
                let uploaded = look.applied_to(scene)?;
                let ready = renderer.scene(&uploaded, settings, watch).map_err(|error| match error {
                    SceneError::Render(error) => error,
                    SceneError::Gpu(error) => because(&error),
                })?;
                Kept {
                    renderer: Arc::clone(renderer),
                    scene: Arc::clone(scene),
                    look: (*look).clone(),
                    settings: settings.clone(),
                    uploaded,
                    ready,
                }
            }
        };
        if !watch.goes_on() {
            self.kept = Some(kept);
            return Err(RenderError::Stopped);
        }
        if kept.look.pose != look.pose {
            let posed = kept.ready.set_pose(&renderer.gpu, &kept.uploaded, &look.pose);
            posed.map_err(|error| bad_pose(&error))?;
            kept.look.pose = look.pose.clone();
        }
        kept.ready.set_picture(&renderer.gpu, &renderer.passes, settings).map_err(|error| because(&error))?;
        kept.ready.set_camera(&renderer.gpu, &look.camera);
        let drawn = Self::frame(renderer, &kept.ready, subject).map_err(|error| because(&error))?;
        self.kept = Some(kept);
        Ok(drawn)
    }

    fn frame(renderer: &GpuRenderer, ready: &GpuScene, subject: &Subject) -> Result<Drawn, GpuError> {
        let settings = &subject.settings;
        let passes = ready.look_timed(&renderer.gpu)?;
        let pixels = ready.picture(&renderer.gpu)?;
        let layers = ready.layers(&renderer.gpu, &renderer.passes, &settings.aovs, AovSpace::Picture)?;
        let wanted: Vec<_> = texture_maps().filter(|_| subject.wants_maps).collect();
        let maps = ready.layers(&renderer.gpu, &renderer.passes, &wanted, AovSpace::Texture)?;
        let mut told = warnings(subject.scene);
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
