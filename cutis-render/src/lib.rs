//! How it is drawn: settings, prepared tables, passes, techniques and film, all on the CPU.
//!
//! The public act is [`Renderer::render`]: a [`cutis_scene::Scene`] and [`Settings`] in, a [`Frame`] of linear light
//! out. [`film`] turns the frame into a picture, [`difference`] says how far two of them are apart.

pub mod difference;
pub mod film;
pub mod frame;
pub mod lit_scene;
pub mod passes;
pub mod prepare;
pub mod progress;
pub mod sampling;
pub mod settings;
pub mod specular_brdf;
pub mod technique;
pub mod transport;

mod renderer;

pub use frame::{Frame, Layer, PassTime};
pub use progress::{Progress, Silent};
pub use renderer::{CpuRenderer, RenderError, Renderer};
pub use settings::{Aov, AovSpace, Diffusion, Settings, TechniqueName};
