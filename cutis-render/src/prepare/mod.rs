//! What is computed once before the passes, and what every backend shares: kernel, rho_dt table, filtered
//! environment.

pub mod colour_ramp;
pub mod kernel;
pub mod light_view;
pub mod mixtures;
pub mod prefilter;
pub mod radial;
pub mod rho_dt;
pub mod skin_table;

pub use colour_ramp::ColourRamp;
pub use kernel::Kernel;
pub use light_view::LightView;
pub use prefilter::FilteredEnvironment;
pub use rho_dt::RhoDt;
