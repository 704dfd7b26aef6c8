//! What is computed once before the passes, and what every backend shares: kernel, rho_dt table, filtered
//! environment.

pub mod kernel;
pub mod prefilter;
pub mod rho_dt;

pub use kernel::Kernel;
pub use prefilter::FilteredEnvironment;
pub use rho_dt::RhoDt;
