//! Draws one side of the window, and keeps what the next picture of it can be drawn from.

use super::mean::Mean;
use super::on_cpu::OnCpu;
use super::on_gpu::{Devices, OnGpu};
use super::stage::{Stage, rounds};
use super::watch::Watch;
use super::{Desk, Painted, Wish, Work};
use crate::backend::{Backend, unknown};
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
    /// Of the pictures with other patterns that were drawn of a wish.
    mean: Option<Mean>,
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
    /// Draws a look of a wish; round 0 is the picture of a stage itself, the others are taken into the mean with it. None if
    /// something else is wanted by now.
    pub fn paint(
        &mut self,
        devices: &mut Devices,
        wish: &Wish,
        side: usize,
        (stage, round): (Stage, u32),
        desk: &Desk,
    ) -> Result<Option<Painted>, String> {
        let start = Instant::now();
        let look = &wish.looks[side];
        let mut settings = stage.settings(&look.drawing, wish.size);
        settings.aovs = wish.shown.layers(look.drawing.technique);
        settings.techniques.image_space.round = round;
        let rounds = if stage == Stage::Fine { rounds(wish, side) } else { 1 };
        let finish = |drawn: Drawn, quality: String, is_final: bool| Painted {
            number: wish.number,
            side,
            technique: look.drawing.technique,
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
            // A mean is developed here: the adapter has but the last picture of it.
            film: (settings.aovs.is_empty() && round == 0).then_some(look.film),
            settings,
            wants_maps: wish.shown.wants_maps(),
        };
        match self.draw(devices, &subject, &watch) {
            Ok(mut drawn) => {
                self.average(&mut drawn.frame, round, rounds);
                let is_last = stage == Stage::Fine && round + 1 == rounds;
                Ok(Some(finish(drawn, quality(stage, round, rounds), is_last)))
            }
            Err(RenderError::Stopped) => Ok(None),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Makes the mean of all rounds of a frame.
    fn average(&mut self, frame: &mut Frame, round: u32, rounds: u32) {
        match &mut self.mean {
            Some(mean) if round > 0 && mean.count() == round => mean.take_in(frame),
            mean => *mean = (rounds > 1).then(|| Mean::of(frame)),
        }
    }

    /// On the machine that was chosen; from a graphics processor that fails `auto` goes to the processor, and everyone does
    /// with a technique that is not drawn there.
    fn draw(
        &mut self,
        devices: &mut Devices,
        subject: &Subject,
        watch: &Watch,
    ) -> Result<Drawn, RenderError> {
        let technique = subject.look.drawing.technique;
        let backend = subject.look.drawing.backend;
        if backend == Backend::Cpu {
            return self.cpu.draw(subject, watch);
        }
        if !GpuRenderer::knows(technique) {
            return self.on_processor(subject, watch, &unknown(technique));
        }
        match self.gpu.draw(devices, subject, watch) {
            Ok(drawn) => Ok(drawn),
            Err(RenderError::Backend { reason }) if backend == Backend::Auto => {
                self.on_processor(subject, watch, &reason)
            }
            Err(error) => Err(error),
        }
    }

    /// On the processor, in place of an adapter.
    fn on_processor(&mut self, subject: &Subject, watch: &Watch, why: &str) -> Result<Drawn, RenderError> {
        let mut drawn = self.cpu.draw(subject, watch)?;
        drawn.frame.warnings.push(format!("drawn on the processor, because {why}"));
        Ok(drawn)
    }
}

/// How good a picture is, in words.
fn quality(stage: Stage, round: u32, rounds: u32) -> String {
    match round {
        0 => stage.name().to_owned(),
        _ => format!("{}, {} of {rounds} rounds", stage.name(), round + 1),
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
