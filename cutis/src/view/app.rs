//! The window: takes in what the person does and what the painter has drawn, and asks for the next picture.

use super::files::{Loading, dropped, write_image, write_look, write_picture};
use super::keys::{Command, command};
use super::look::{Drawing, Look};
use super::painter::{News, Painter, Wish};
use super::shown::{Shown, View, camera_layers};
use super::side::Side;
use super::turntable::Turntable;
use super::{canvas, help, panel};
use crate::scene_source::SceneSource;
use crate::techniques::paper::Paper;
use crate::techniques::take_own;
use cutis_render::TechniqueName;
use cutis_scene::{Light, Scene};
use eframe::egui::{CentralPanel, Context, Event, InputState, Panel, Ui};
use std::path::PathBuf;
use std::sync::Arc;

/// Narrowest panel, points.
const PANEL_WIDTH: f32 = 340.0;

/// The state of the window.
pub struct Viewer {
    /// Where the scene comes from.
    pub source: SceneSource,
    /// The scene as it was read.
    pub scene: Arc<Scene>,
    /// How it is looked at, left and right.
    pub looks: [Look; 2],
    /// The look before anything was changed.
    pub original: Look,
    /// Which look the panel changes.
    pub edited: usize,
    /// Where the picture is divided, as a share of its width, if two looks are compared.
    pub split: Option<f32>,
    /// What is to be seen.
    pub shown: Shown,
    /// Width and height of the picture, pixels, where it is not as large as the window leaves room.
    pub size: Option<[u32; 2]>,
    /// Number of the light that follows the mouse.
    pub light: usize,
    /// What was drawn.
    pub sides: [Side; 2],
    /// What went well or wrong last.
    pub message: Option<String>,
    /// Where pictures are written.
    pub folder: PathBuf,
    /// Whether lights that move are moving.
    pub is_playing: bool,
    /// A turn around the scene that is being written.
    pub turntable: Option<Turntable>,
    panel: bool,
    hidden: bool,
    help: bool,
    loading: Option<Loading>,
    painter: Painter,
    asked: Option<Wish>,
}

impl Viewer {
    /// A window on a scene.
    ///
    /// # Errors
    /// If no thread can be had.
    pub fn new(
        context: &Context,
        source: SceneSource,
        scene: Scene,
        drawing: Drawing,
    ) -> std::io::Result<Self> {
        let original = Look::of(&scene, drawing);
        Ok(Self {
            message: scene.warnings.first().map(|warning| format!("warning: {warning}")),
            source,
            scene: Arc::new(scene),
            looks: [original.clone(), original.clone()],
            original,
            edited: 0,
            split: None,
            shown: Shown::default(),
            size: None,
            light: 0,
            sides: [Side::default(), Side::default()],
            folder: PathBuf::from("."),
            turntable: None,
            is_playing: false,
            panel: true,
            hidden: false,
            help: false,
            loading: None,
            painter: Painter::start(context.clone())?,
            asked: None,
        })
    }

    /// Everything in the window.
    pub fn show(&mut self, ui: &mut Ui) {
        self.take_in(ui.ctx());
        if !self.hidden {
            Panel::bottom("status").show(ui, |ui| panel::status(self, ui));
            if self.panel {
                let width = PANEL_WIDTH.min(0.9 * ui.available_width());
                Panel::right("panel")
                    .resizable(true)
                    .default_size(width)
                    .show(ui, |ui| panel::show(self, ui));
            }
        }
        let size = CentralPanel::no_frame().show(ui, |ui| canvas::show(self, ui)).inner;
        help::show(ui.ctx(), &mut self.help);
        self.ask(size);
        for side in 0..self.side_count() {
            self.sides[side].develop(ui.ctx(), side, self.looks[side].developing(self.shown));
        }
    }

    fn take_in(&mut self, context: &Context) {
        for news in self.painter.news() {
            self.take_news(context, news);
        }
        let dropped_paths = |input: &InputState| {
            input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>()
        };
        let paths = context.input(dropped_paths);
        if !paths.is_empty() {
            let now = self.loading.as_ref().map_or(&self.source, |loading| &loading.source).clone();
            self.open(context, paths.iter().fold(now, |source, path| dropped(path, &source)));
        }
        self.take_scene();
        self.turn();
        self.play(context);
        if !context.egui_wants_keyboard_input() {
            self.take_keys(context);
        }
    }

    fn take_news(&mut self, context: &Context, news: News) {
        match news {
            // A picture of what was wanted a moment ago is better than none while things move; another scene is not.
            News::Painted(painted) if Arc::ptr_eq(&painted.scene, &self.scene) => {
                let side = painted.side;
                self.sides[side].show(context, side, *painted);
            }
            News::Failed { number, side, reason } => self.sides[side].failure = Some((number, reason)),
            News::Painted(_) => {}
        }
    }

    /// Reads another scene; what is there stays until it has arrived.
    pub fn open(&mut self, context: &Context, source: SceneSource) {
        self.loading = Some(Loading::start(source, context));
        self.message = Some("reading …".to_owned());
    }

    fn take_scene(&mut self) {
        let Some(result) = self.loading.as_ref().and_then(Loading::done) else { return };
        let Some(loading) = self.loading.take() else { return };
        match result {
            Ok(scene) => self.enter(loading.source, scene),
            Err(reason) => self.message = Some(reason),
        }
    }

    /// Looks at another scene; where only its environment is another, the rest of both looks stays.
    fn enter(&mut self, source: SceneSource, scene: Scene) {
        self.end_turntable();
        self.message = scene.warnings.first().map(|warning| format!("warning: {warning}"));
        let is_another = source.file != self.source.file || self.looks[0].lights.len() != scene.lights.len();
        // Gaussians of another kernel have other numbers.
        let drawing = |look: &Look| Drawing { muted_gaussians: Vec::new(), ..look.drawing.clone() };
        self.original = Look::of(&scene, drawing(&self.looks[0]));
        if is_another {
            self.looks = [0, 1].map(|side| Look::of(&scene, drawing(&self.looks[side])));
            self.light = 0;
        }
        self.sides = [Side::default(), Side::default()];
        (self.source, self.scene) = (source, Arc::new(scene));
    }

    fn take_keys(&mut self, context: &Context) {
        let pressed = |event: &Event| match event {
            Event::Key { key, pressed: true, repeat: false, modifiers, .. } if !modifiers.command => {
                command(*key)
            }
            _ => None,
        };
        let commands: Vec<_> = context.input(|input| input.events.iter().filter_map(pressed).collect());
        commands.into_iter().for_each(|command| self.obey(command));
    }

    /// Does what a key says.
    pub fn obey(&mut self, command: Command) {
        match command {
            Command::Wireframe => self.shown.wireframe ^= true,
            Command::NextView => self.shown.view = self.next_view(),
            Command::Panel => self.panel ^= true,
            Command::Frame => self.frame_scene(),
            Command::Hide => self.hidden ^= true,
            Command::Picture => self.write_picture(),
            Command::Help => self.help ^= true,
            Command::Split => self.split = if self.split.is_some() { None } else { Some(0.5) },
            Command::Technique(n) => {
                if let Some(&technique) = TechniqueName::ALL.get(n) {
                    self.looks[self.edited].drawing.technique = technique;
                }
            }
        }
        if self.split.is_none() {
            self.edited = 0;
        }
    }

    /// Views in the order in which a key goes through them.
    pub fn views(&self) -> Vec<View> {
        let layers = camera_layers(self.looks[self.edited].drawing.technique).map(View::Layer);
        [View::Picture, View::Maps].into_iter().chain(layers).collect()
    }

    fn next_view(&self) -> View {
        let views = self.views();
        let now = views.iter().position(|view| *view == self.shown.view);
        now.and_then(|i| views.get(i + 1)).copied().unwrap_or_default()
    }

    /// Draws the edited side with the numbers that a paper has for its technique, and what was before its camera. The scene is shared by both
    /// sides: instead of it, the mean free path is scaled, which comes to the same.
    pub fn draw_as_in(&mut self, paper: Paper) {
        let look = &mut self.looks[self.edited];
        let of_paper = paper.settings(look.drawing.techniques.clone());
        take_own(&mut look.drawing.techniques, &of_paper, look.drawing.technique);
        let Some(stage) = paper.stage() else { return };
        self.size = Some(stage.size);
        look.skin.preset = Some(stage.material.to_owned());
        // Gaussians of another kernel have other numbers.
        look.drawing.muted_gaussians.clear();
        if let Some(side_mm) = self.scene.longest_side_mm().filter(|side_mm| *side_mm > 0.0) {
            look.skin.free_path = [side_mm / stage.longest_side_mm; 3];
        }
    }

    /// Sees the whole scene, from where the camera is.
    pub fn frame_scene(&mut self) {
        if let Some(bounds_mm) = self.scene.bounds_mm() {
            super::orbit::frame(&mut self.looks[0].camera, bounds_mm);
        }
    }

    /// Writes what is seen of a side to a file, and says how good it is by now.
    pub fn write_picture(&mut self) {
        let Some(painted) = &self.sides[self.edited].painted else { return };
        let written = match self.shown.view {
            View::Picture if !self.shown.wireframe => {
                write_picture(&self.folder, &painted.frame, &self.looks[self.edited].film)
            }
            _ => write_image(&self.folder, &painted.image),
        };
        self.message = Some(match written {
            Ok(path) => format!("written: {} ({})", path.display(), painted.quality),
            Err(reason) => reason,
        });
    }

    /// Writes a scene file of what is seen.
    pub fn write_look(&mut self) {
        let look = &self.looks[self.edited];
        self.message = Some(match write_look(&self.folder, &self.scene, look) {
            Ok(path) => format!("written: {}", path.display()),
            Err(reason) => reason,
        });
    }

    /// Begins a turn around the scene of so many pictures.
    pub fn begin_turntable(&mut self, pictures: u32) {
        let camera = self.looks[0].camera;
        match Turntable::begin(&self.folder, pictures, camera) {
            Ok(turntable) => self.turntable = Some(turntable),
            Err(reason) => self.message = Some(reason),
        }
    }

    /// Ends it where it began.
    pub fn end_turntable(&mut self) {
        if let Some(turntable) = self.turntable.take() {
            self.looks[0].camera = turntable.start;
            self.message = Some(turntable.progress());
        }
    }

    /// Goes on with a turn around the scene when its picture has been drawn.
    fn turn(&mut self) {
        let (settled, failed) = (self.is_settled(), self.failure(0).is_some());
        let Some(turntable) = &mut self.turntable else { return };
        // The turn alone moves the camera.
        self.looks[0].camera = turntable.camera();
        if failed {
            self.end_turntable();
            return;
        }
        let Some(painted) = &self.sides[0].painted else { return };
        if !settled || painted.camera != self.looks[0].camera {
            return;
        }
        match turntable.write(&painted.frame, &self.looks[0].film) {
            Ok(()) if turntable.is_done() => self.end_turntable(),
            Ok(()) => self.message = Some(turntable.progress()),
            Err(reason) => {
                self.end_turntable();
                self.message = Some(reason);
            }
        }
    }

    /// Lets time go on for lights that move.
    fn play(&mut self, context: &Context) {
        self.is_playing &= self.turntable.is_none() && self.scene.lights.iter().any(Light::moves);
        if self.is_playing {
            // A window that was away for long goes on where it was.
            let step_s = context.input(|input| input.stable_dt).min(0.1);
            self.looks.iter_mut().for_each(|look| look.time_s += step_s);
            context.request_repaint();
        }
    }

    /// Asks for a picture of this size if it is another than was asked for.
    fn ask(&mut self, size: [u32; 2]) {
        // Both sides look from one place.
        self.looks[1].camera = self.looks[0].camera;
        let count = self.side_count();
        let wish = Wish {
            number: self.asked.as_ref().map_or(1, |wish| wish.number + 1),
            scene: Arc::clone(&self.scene),
            looks: self.looks[..count].to_vec(),
            size,
            shown: self.shown,
            is_for_a_file: self.turntable.is_some(),
        };
        if self.asked.as_ref().is_none_or(|asked| !wish.is_same(asked)) {
            self.painter.ask(wish.clone());
            self.asked = Some(wish);
        }
    }

    /// Whether everything that was asked for has been drawn as well as it can be, or cannot be drawn.
    pub fn is_settled(&self) -> bool {
        let Some(asked) = &self.asked else { return false };
        let drawn = |side: usize| {
            let painted = self.sides[side].painted.as_ref();
            painted.is_some_and(|p| p.number == asked.number && p.is_final) || self.failure(side).is_some()
        };
        self.loading.is_none() && (0..asked.looks.len()).all(drawn)
    }

    /// Why a side shows nothing of what was asked for last.
    pub fn failure(&self, side: usize) -> Option<&str> {
        let asked = self.asked.as_ref()?.number;
        let (number, reason) = self.sides[side].failure.as_ref()?;
        (*number == asked).then_some(reason.as_str())
    }

    /// How many sides are shown.
    pub fn side_count(&self) -> usize {
        if self.split.is_some() { 2 } else { 1 }
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }
}
