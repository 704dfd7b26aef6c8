//! Benches of cutis live in `benches/`, one group per stage; this library is empty on purpose.
//!
//! - `cargo bench -p cutis-bench --bench optics`: fits of Gaussians to the dipole.
//! - `cargo bench -p cutis-bench --bench diffusion`: the blur against plain copies of its texture.
//! - `cargo bench -p cutis-bench --bench frame`: whole pictures of heads.
//! - `cargo bench -p cutis-bench --bench techniques`: every technique on both backends, and samples beside blurred textures.
//! - `cargo bench -p cutis-bench --bench truth`: light transport in a head.
//!
//! Those of `diffusion`, `frame` and `techniques` also print reports of their own on stderr; `-- table` after the command prints them alone.
