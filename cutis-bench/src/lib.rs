//! Benches of cutis live in `benches/`; this library is empty on purpose.
