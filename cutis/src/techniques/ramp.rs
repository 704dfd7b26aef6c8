//! Colour ramps over a distance: gradient stops in words, or the middle row of a picture.

use crate::cli::colour;
use cutis_render::prepare::ColourRamp;
use cutis_render::prepare::colour_ramp::RampError;
use cutis_scene::{ColourSpace, Texture, read_image};
use glam::Vec3;
use miette::{Result, miette};
use std::path::Path;

/// From words such as `0:1,0.9,0.8; 4:0.5,0.1,0.05; 20:0,0,0`: distances in mm, linear colours.
///
/// # Errors
/// If a stop cannot be read, or the stops are no ramp.
pub fn of_words(words: &str) -> Result<ColourRamp, String> {
    let stop = |words: &str| -> Result<(f32, Vec3), String> {
        let unknown = || format!("a stop must be MM:R,G,B, such as 4:0.5,0.1,0.05, got '{}'", words.trim());
        let (distance_mm, rgb) = words.split_once(':').ok_or_else(unknown)?;
        let distance_mm = distance_mm.trim().parse().map_err(|_| unknown())?;
        Ok((distance_mm, colour(rgb).map_err(|_| unknown())?))
    };
    let stops = words.split(';').map(stop).collect::<Result<_, _>>()?;
    ColourRamp::new(stops).map_err(|error| error.to_string())
}

/// From a picture, whose left end is no distance and whose right end is `length_mm`.
///
/// # Errors
/// If it cannot be read, is one pixel wide, or the length makes no sense.
pub fn of_image(path: &Path, length_mm: f32, warnings: &mut Vec<String>) -> Result<ColourRamp> {
    if !(length_mm > 0.0 && length_mm.is_finite()) {
        return Err(miette!("--absorption-ramp-length must be above 0 mm and finite, got {length_mm}"));
    }
    crate::job::must_exist(path)?;
    let picture = read_image(path, ColourSpace::Colour, warnings).map_err(|error| miette!("{error}"))?;
    of_texels(&picture, length_mm)
        .map_err(|error| miette!("--absorption-ramp-image {}: {error}", path.display()))
}

/// Stops at the middles of the texels, as a graphics adapter reads a texture.
fn of_texels(picture: &Texture, length_mm: f32) -> Result<ColourRamp, RampError> {
    let (width, row) = (picture.width(), picture.height() / 2);
    let stop = |x: u32| ((x as f32 + 0.5) / width as f32 * length_mm, picture.texel(x, row).truncate());
    ColourRamp::new((0..width).map(stop).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::Texels;

    #[test]
    fn stops_are_read_and_mixed() {
        let ramp = of_words(" 0:1,0.9,0.8; 4 : 0.5,0.1,0.05;20:0,0,0").expect("three stops");
        assert_eq!(ramp.stops().len(), 3);
        assert!((ramp.at_mm(2.0) - Vec3::new(0.75, 0.5, 0.425)).abs().max_element() < 1e-6);
    }

    #[test]
    fn what_is_no_ramp_is_told_in_words() {
        for (words, told) in [
            ("", "a stop must be MM:R,G,B"),
            ("0:1,1,1", "two stops at least, got 1"),
            ("0:1,1,1;", "got ''"),
            ("0:1,1;1:0,0,0", "got '0:1,1'"),
            ("x:1,1,1;1:0,0,0", "got 'x:1,1,1'"),
            ("1:1,1,1;1:0,0,0", "got 1 mm after 1 mm"),
            ("0:1,1,1;1:0,0,-1", "got -1 at 1 mm"),
            ("0:1,1,1;inf:0,0,0", "got inf mm"),
        ] {
            let error = of_words(words).expect_err(words);
            assert!(error.contains(told), "{words}: {error}");
        }
    }

    #[test]
    fn a_picture_is_read_along_its_middle_row_and_to_linear_light() {
        let rows = [[0u8; 3], [255, 188, 0], [9; 3]];
        let texels = rows.iter().flat_map(|row| row.map(|grey| [grey, grey, grey, 255])).collect();
        let ramp = of_texels(&Texture::new(3, 3, Texels::Srgb8(texels)), 6.0).expect("three stops");
        let [first, second, third] = ramp.stops() else { panic!("three stops: {ramp:?}") };
        assert_eq!([first.0, second.0, third.0], [1.0, 3.0, 5.0], "the middles of 2 mm each");
        // Code 188 of sRGB is 0.5028 of linear light (IEC 61966-2-1).
        assert!(first.1 == Vec3::ONE && third.1 == Vec3::ZERO && (second.1.x - 0.5028).abs() < 1e-4);
        let one = Texture::new(1, 1, Texels::Srgb8(vec![[9, 9, 9, 255]]));
        assert!(of_texels(&one, 6.0).is_err());
    }
}
