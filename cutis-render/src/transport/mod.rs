//! Light transport in the real geometry, by Monte Carlo: what every technique is held to.
//!
//! A body is a closed mesh filled with tissue. Light enters through its rough surface, is scattered and absorbed inside,
//! reflected back at the surface from within, and leaves. Two estimators share these rules and nothing else: paths from the
//! camera ([`path`]), and packets from the lights ([`exitance`]).
//! Not modelled: polarisation, fluorescence, interference, and light that falls from one body's inside into another's where
//! they overlap (the one entered first fills it).

pub mod body;
mod connection;
pub mod emitter;
pub mod estimate;
pub mod exitance;
pub mod interface;
pub mod path;
pub mod random;
pub mod tissue;
pub mod walk;

#[cfg(test)]
pub(crate) mod tests;
