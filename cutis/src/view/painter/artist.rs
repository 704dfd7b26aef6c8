//! Draws one side of the window, and keeps what the next picture of it can be drawn from.

use super::on_cpu::OnCpu;
use super::on_gpu::{Devices, OnGpu};
use super::stage::Stage;
use super::watch::Watch;
use super::{Desk, Painted, Wish, Work};
use crate::backend::Backend;
use crate::view::look::Look;
use crate::view::screen;
use cutis_gpu::GpuRenderer;
use cutis_render::film::Film;
use cutis_render::{CpuRenderer, Frame, Layer, RenderError, Renderer, Settings};
use cutis_scene::Scene;
use eframe::egui::ColorImage;
use std::sync::Arc;
use std::time::Instant;

/// The one for a side.
#[derive(Default)]
pub struct Artist {
    cpu: OnCpu,
    pub(super) gpu: OnGpu,
}

/// A frame, and what it was drawn with.
pub struct Drawn {
    /// The picture.
    pub frame: Frame,
    /// Textures of the passes.
    pub maps: Vec<Layer>,
    /// What drew it.
    pub machine: String,
    /// What that costs any graphics adapter.
    pub work: Option<Work>,
    /// The codes of the developed picture, if the machine has developed it.
    pub codes: Option<Vec<[u8; 4]>>,
}

/// What to draw: one look at one stage.
pub struct Subject<'a> {
    /// The scene as it was read.
    pub scene: &'a Arc<Scene>,
    /// How it is looked at.
    pub look: &'a Look,
    /// How it is drawn.
    pub settings: Settings,
    /// Whether the textures of the passes are wanted.
    pub wants_maps: bool,
    /// The film that the picture is developed on, if that is what is to be seen.
    pub film: Option<Film>,
}

impl Artist {
    /// Draws a look of a wish. None if something else is wanted by now.
    pub fn paint(
        &mut self,
        devices: &mut Devices,
        wish: &Wish,
        side: usize,
        stage: Stage,
        desk: &Desk,
    ) -> Result<Option<Painted>, String> {
        let start = Instant::now();
        let look = &wish.looks[side];
        let mut settings = stage.settings(&look.drawing, wish.size);
        settings.aovs = wish.shown.layers(look.drawing.technique);
        let finish = |drawn: Drawn, quality: String, is_final: bool| Painted {
            number: wish.number,
            side,
            camera: look.camera,
            quality,
            is_final,
            image: image(&drawn, look, wish),
            look: look.developing(wish.shown),
            scene: Arc::clone(&wish.scene),
            maps: Arc::new(drawn.maps),
            machine: drawn.machine,
            work: drawn.work,
            time: start.elapsed(),
            frame: Arc::new(drawn.frame),
        };
        let preview = |frame, quality| {
            let machine = CpuRenderer.adapter();
            finish(Drawn { frame, maps: Vec::new(), machine, work: None, codes: None }, quality, false)
        };
        let watch = Watch::new(desk, stage != Stage::Draft, &preview);
        let subject = Subject {
            scene: &wish.scene,
            look,
            film: settings.aovs.is_empty().then_some(look.film),
            settings,
            wants_maps: wish.shown.wants_maps(),
        };
        match self.draw(devices, &subject, &watch) {
            Ok(drawn) => Ok(Some(finish(drawn, stage.name().to_owned(), stage == Stage::Fine))),
            Err(RenderError::Stopped) => Ok(None),
            Err(error) => Err(error.to_string()),
        }
    }

    /// On the machine that was chosen; `auto` goes from a graphics processor that fails to the processor.
    fn draw(
        &mut self,
        devices: &mut Devices,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, RenderError> {
        let technique = subject.look.drawing.technique;
        let backend = subject.look.drawing.backend;
        if backend == Backend::Cpu || (backend == Backend::Auto && !GpuRenderer::knows(technique)) {
            return self.cpu.draw(subject, watch);
        }
        match self.gpu.draw(devices, subject, watch) {
            Ok(drawn) => Ok(drawn),
            Err(RenderError::Backend { reason }) if backend == Backend::Auto => {
                let mut drawn = self.cpu.draw(subject, watch)?;
                drawn.frame.warnings.push(format!("drawn on the processor, because {reason}"));
                Ok(drawn)
            }
            Err(error) => Err(error),
        }
    }
}

/// Renders from nothing, for techniques that keep nothing.
pub fn from_nothing(renderer: &dyn Renderer, subject: &Subject, watch: &Watch) -> Result<Drawn, RenderError> {
    let scene = subject.look.applied_to(subject.scene)?;
    let frame = renderer.render(&scene, &subject.settings, watch)?;
    Ok(Drawn { frame, maps: Vec::new(), machine: renderer.adapter(), work: None, codes: None })
}

/// What a screen shows of it; developed here where the machine has not done it.
fn image(drawn: &Drawn, look: &Look, wish: &Wish) -> ColorImage {
    let how = look.developing(wish.shown);
    match &drawn.codes {
        Some(codes) => {
            let developed = screen::of_codes([drawn.frame.width, drawn.frame.height], codes);
            screen::overlaid(developed, &look.camera, &how, &wish.scene)
        }
        None => screen::picture(&drawn.frame, &look.camera, &how, &wish.scene),
    }
}
