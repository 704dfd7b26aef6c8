//! Draws in the background: the latest wish first as a quick draft, then ever better while nothing changes.

mod artist;
mod mean;
mod on_cpu;
mod on_gpu;
mod stage;
#[cfg(test)]
mod tests;
mod watch;

use super::look::Look;
use super::mailbox::Mailbox;
use super::shown::Shown;
use artist::Artist;
use cutis_gpu::cost::Cost;
use cutis_render::film::Film;
use cutis_render::{Frame, Layer, TechniqueName};
use cutis_scene::{Camera, Pose, Scene};
use eframe::egui;
use on_gpu::Devices;
use stage::{Stage, rounds};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// What is to be drawn.
#[derive(Debug, Clone)]
pub struct Wish {
    /// Grows with every wish; tells whether what was drawn is still what is wanted.
    pub number: u64,
    /// The scene as it was read.
    pub scene: Arc<Scene>,
    /// How it is looked at: once, or twice side by side.
    pub looks: Vec<Look>,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// What is to be seen.
    pub shown: Shown,
    /// Whether only the best picture is wanted.
    pub is_for_a_file: bool,
}

impl Wish {
    /// Whether it asks for the same frames; how they are developed is another matter.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.looks.len() == other.looks.len()
            && self.looks.iter().zip(&other.looks).all(|(a, b)| a.is_drawn_like(b))
            && self.size == other.size
            && self.shown.view == other.shown.view
            && self.is_for_a_file == other.is_for_a_file
    }
}

/// What was drawn.
#[derive(Debug, Clone)]
pub struct Painted {
    /// Number of the wish.
    pub number: u64,
    /// Which of its looks.
    pub side: usize,
    /// By which method.
    pub technique: TechniqueName,
    /// From where it is seen.
    pub camera: Camera,
    /// How good it is by now, in words.
    pub quality: String,
    /// Whether nothing better will come.
    pub is_final: bool,
    /// What it shows.
    pub scene: Arc<Scene>,
    /// Ready for the screen.
    pub image: egui::ColorImage,
    /// How the image was made of the frame.
    pub look: Developing,
    /// The light of it, with times and warnings.
    pub frame: Arc<Frame>,
    /// Textures of the passes, where they are shown.
    pub maps: Arc<Vec<Layer>>,
    /// What drew it.
    pub machine: String,
    /// What that costs any graphics adapter; none for the processor.
    pub work: Option<Work>,
    /// How long it took.
    pub time: Duration,
}

/// How an image is made of a frame: none of it needs new light.
#[derive(Debug, Clone, PartialEq)]
pub struct Developing {
    /// Exposure, bloom, tone mapper.
    pub film: Film,
    /// What is to be seen of the frame.
    pub shown: Shown,
    /// The pose of the triangles drawn over it.
    pub pose: Pose,
}

/// What a frame costs a graphics adapter.
#[derive(Debug, Clone)]
pub struct Work {
    /// Textures and buffers that are kept.
    pub memory_bytes: u64,
    /// What each pass moves through memory.
    pub costs: Vec<Cost>,
}

/// News from the painter.
#[derive(Debug, Clone)]
pub enum News {
    /// A picture.
    Painted(Box<Painted>),
    /// There is none, and why.
    Failed {
        /// Number of the wish.
        number: u64,
        /// Which of its looks.
        side: usize,
        /// In words.
        reason: String,
    },
}

/// The one who draws, on a thread of its own.
#[derive(Debug)]
pub struct Painter {
    wishes: Arc<Mailbox<Wish>>,
    news: Arc<Mutex<Vec<News>>>,
}

impl Painter {
    /// Starts it; `context` is woken when there is news.
    pub fn start(context: egui::Context) -> std::io::Result<Self> {
        let (wishes, news) = (Arc::new(Mailbox::default()), Arc::new(Mutex::new(Vec::new())));
        let desk = Desk { wishes: Arc::clone(&wishes), news: Arc::clone(&news), context };
        std::thread::Builder::new().name("painter".to_owned()).spawn(move || work(&desk))?;
        Ok(Self { wishes, news })
    }

    /// Asks for a picture; whatever was asked before is forgotten.
    pub fn ask(&self, wish: Wish) {
        self.wishes.put(wish);
    }

    /// What has come in since the last time.
    pub fn news(&self) -> Vec<News> {
        std::mem::take(&mut *self.news.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The thread ends by itself when it finds the mailbox closed; nobody waits for it.
impl Drop for Painter {
    fn drop(&mut self) {
        self.wishes.close();
    }
}

/// Where wishes come in and news goes out.
struct Desk {
    wishes: Arc<Mailbox<Wish>>,
    news: Arc<Mutex<Vec<News>>>,
    context: egui::Context,
}

impl Desk {
    fn tell(&self, news: News) {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).push(news);
        self.context.request_repaint();
    }
}

fn work(desk: &Desk) {
    let mut studio = Studio::default();
    while let Some(wish) = desk.wishes.wait() {
        let drawing = std::panic::AssertUnwindSafe(|| studio.fulfil(&wish, desk));
        if let Err(panic) = std::panic::catch_unwind(drawing) {
            studio = Studio::default();
            let why = panic.downcast_ref::<String>().cloned();
            let why = why.or_else(|| panic.downcast_ref::<&str>().map(|&s| s.to_owned()));
            let reason = format!("a fault of cutis worth reporting: {}", why.unwrap_or_default());
            (0..wish.looks.len()).for_each(|side| {
                desk.tell(News::Failed { number: wish.number, side, reason: reason.clone() });
            });
        }
    }
}

/// Where it is drawn: each side keeps what its next picture can be drawn from.
#[derive(Default)]
struct Studio {
    devices: Devices,
    sides: [Artist; 2],
}

impl Studio {
    /// Draws all looks at every stage until something else is wanted.
    fn fulfil(&mut self, wish: &Wish, desk: &Desk) {
        let mut failed = [false; 2];
        for stage in Stage::ALL {
            for (side, look) in wish.looks.iter().enumerate() {
                // Drafts of both sides belong together: they look from one place.
                if stage != Stage::Draft && desk.wishes.has_news() {
                    return;
                }
                let is_skipped = wish.is_for_a_file && stage != Stage::Fine;
                if failed[side] || is_skipped || !stage.is_for(look.drawing.technique) {
                    continue;
                }
                match self.paint(wish, side, (stage, 0), desk) {
                    Some(is_drawn) => failed[side] = !is_drawn,
                    None => return,
                }
            }
        }
        self.refine(wish, failed, desk);
    }

    /// Draws what is not estimated by chance, but with a pattern, again with other patterns, for the mean of all.
    fn refine(&mut self, wish: &Wish, mut failed: [bool; 2], desk: &Desk) {
        let most = (0..wish.looks.len()).map(|side| rounds(wish, side)).max().unwrap_or(1);
        for round in 1..most {
            for (side, failed) in failed.iter_mut().enumerate().take(wish.looks.len()) {
                if desk.wishes.has_news() {
                    return;
                }
                if *failed || round >= rounds(wish, side) {
                    continue;
                }
                match self.paint(wish, side, (Stage::Fine, round), desk) {
                    Some(is_drawn) => *failed = !is_drawn,
                    None => return,
                }
            }
        }
    }

    /// Draws a side and tells it. Whether that could be done; none if something else is wanted by now.
    fn paint(&mut self, wish: &Wish, side: usize, step: (Stage, u32), desk: &Desk) -> Option<bool> {
        match self.sides[side].paint(&mut self.devices, wish, side, step, desk) {
            Ok(Some(painted)) => desk.tell(News::Painted(Box::new(painted))),
            Ok(None) => return None,
            Err(reason) => {
                desk.tell(News::Failed { number: wish.number, side, reason });
                return Some(false);
            }
        }
        Some(true)
    }
}
