//! Draws on the processor: as long as only the camera moves, the light stays where it is.

use super::artist::{Drawn, Subject, from_nothing};
use super::watch::Watch;
use crate::view::look::Look;
use crate::view::shown::texture_maps;
use cutis_render::lit_scene::{LitScene, warnings};
use cutis_render::{CpuRenderer, RenderError, Renderer, Settings, TechniqueName};
use cutis_scene::Scene;
use std::sync::Arc;

/// Keeps the lit scene of the picture before.
#[derive(Default)]
pub struct OnCpu {
    kept: Option<Kept>,
}

struct Kept {
    scene: Arc<Scene>,
    look: Look,
    irradiance_size: u32,
    shadow_samples: u32,
    warnings: Vec<String>,
    lit: LitScene<Arc<Scene>>,
}

impl Kept {
    /// Better light than is asked for is welcome.
    fn serves(&self, subject: &Subject) -> bool {
        Arc::ptr_eq(&self.scene, subject.scene)
            && self.look.is_lit_like(&self.with_own_wrap(subject.look))
            && self.irradiance_size >= subject.settings.irradiance_size
            && self.shadow_samples >= subject.settings.shadow_samples
    }

    /// The numbers of `wrap` are asked for by the final pass only.
    fn with_own_wrap(&self, look: &Look) -> Look {
        let mut look = look.clone();
        look.drawing.techniques.wrap = self.look.drawing.techniques.wrap;
        look
    }

    fn new(subject: &Subject, watch: &Watch) -> Result<Self, RenderError> {
        let Settings { irradiance_size, shadow_samples, .. } = subject.settings;
        let scene = Arc::new(subject.look.applied_to(subject.scene)?);
        Ok(Self {
            warnings: warnings(&scene, &subject.settings),
            lit: LitScene::new(scene, &subject.settings, watch)?,
            scene: Arc::clone(subject.scene),
            look: subject.look.clone(),
            irradiance_size,
            shadow_samples,
        })
    }
}

impl OnCpu {
    /// Draws it.
    pub fn draw(&mut self, subject: &Subject, watch: &Watch) -> Result<Drawn, RenderError> {
        if subject.look.drawing.technique == TechniqueName::Truth {
            return from_nothing(&CpuRenderer, subject, watch);
        }
        subject.settings.check()?;
        if !self.kept.as_ref().is_some_and(|kept| kept.serves(subject)) {
            // What is there stays until the better light is: while things move a draft needs it.
            self.kept = Some(Kept::new(subject, watch)?);
        }
        let Some(kept) = &mut self.kept else { return Err(RenderError::EmptyScene) };
        let mut frame = kept.lit.resolve(&subject.look.camera, &subject.settings, watch)?;
        frame.passes = kept.lit.take_passes();
        frame.warnings.clone_from(&kept.warnings);
        let wanted = texture_maps().filter(|_| subject.wants_maps);
        let maps = wanted.filter_map(|aov| kept.lit.texture_layer(aov)).collect();
        Ok(Drawn { frame, maps, machine: CpuRenderer.adapter(), work: None, codes: None })
    }
}
