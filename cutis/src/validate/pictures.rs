//! Pictures to look at: the diffuse part of the truth and of an entry, and the error between them.

use super::stored::Truth;
use crate::measure::{Measured, Seen, map_png};
use crate::whole_file;
use cutis_render::difference::{DEFAULT_PIXELS_PER_DEGREE, diverging, magma};
use miette::{Result, miette};
use std::path::Path;

/// Relative error of the luminance at which its map has its full colour.
const FULL_COLOUR: f32 = 0.5;

/// Writes `SCENE.truth.png`, `SCENE.ENTRY.png` and the maps `SCENE.ENTRY.flip.png` and `SCENE.ENTRY.luminance.png`.
pub fn write(folder: &Path, scene: &str, entry: &str, seen: &Seen, truth: &Truth) -> Result<()> {
    let reference = truth.seen(&truth.diffuse);
    let measured = Measured::new(seen, &reference, DEFAULT_PIXELS_PER_DEGREE);
    let measured = measured.map_err(|error| miette!("{scene}, {entry}: {error}"))?;
    let entry = entry.replace('/', "-");
    let files = [
        (format!("{scene}.truth.png"), reference.png()?),
        (format!("{scene}.{entry}.png"), seen.png()?),
        (format!("{scene}.{entry}.flip.png"), map_png(seen.width, &measured.flip().errors, magma)?),
        (
            format!("{scene}.{entry}.luminance.png"),
            map_png(seen.width, &measured.luminance_errors, |error| diverging(error / FULL_COLOUR))?,
        ),
    ];
    let paths = files.each_ref().map(|(name, _)| folder.join(name));
    let staged: Vec<_> =
        paths.iter().zip(&files).map(|(path, (_, bytes))| (path.as_path(), &bytes[..])).collect();
    whole_file::write_all(&staged)
}
