//! The published methods, one file each.

pub mod texture_space;
pub mod truth;
