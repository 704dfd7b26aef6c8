//! The passes of cutis-render once more, drawn by a graphics processor: the technique `texture-space` in WGSL through wgpu.
//!
//! [`GpuRenderer`] owns the device and its pipelines; [`GpuScene`] owns the textures of one scene and draws frames of it,
//! without making anything new from one frame to the next. Tables (kernel, rho_dt, filtered environment, taps) come from
//! cutis-render: nothing here computes physics of its own. Only what the default limits of WebGPU grant is used.

pub mod cost;
pub mod error;
pub mod faults;
pub mod gpu;
pub mod map;
pub mod passes;
pub mod pipeline;
pub mod readback;
pub mod renderer;
pub mod scene;
pub mod shaders;
pub mod step;
pub mod timing;

pub use error::GpuError;
pub use gpu::{Adapters, Gpu};
pub use renderer::GpuRenderer;
pub use scene::GpuScene;
