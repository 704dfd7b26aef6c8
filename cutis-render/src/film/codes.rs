//! 8-bit codes of a screen.

use super::dither::dithered;
use super::{Picture, linear_to_srgb};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// The codes of a developed picture before a plain, display-linear grey, row by row: red, green, blue, and 255.
pub fn codes(picture: &Picture, behind: f32) -> Vec<[u8; 4]> {
    let code = |(i, pixel): (usize, &Vec4)| {
        let at = [i as u32 % picture.width, i as u32 / picture.width];
        let [r, g, b] = encoded(pixel.truncate() + (1.0 - pixel.w) * behind, at);
        [r, g, b, 255]
    };
    picture.pixels.par_iter().enumerate().map(code).collect()
}

/// The codes of a display-linear colour at a place of a picture; the place decides how it is dithered.
pub fn encoded(linear: Vec3, at: [u32; 2]) -> [u8; 3] {
    let linear = linear.clamp(Vec3::ZERO, Vec3::ONE);
    [0, 1, 2].map(|channel| dithered(linear_to_srgb(linear[channel]), at, channel as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_behind_shows_through_by_what_is_not_covered() {
        let pixels = vec![Vec4::ZERO, Vec4::splat(0.5), Vec4::ONE, Vec4::new(0.0, 0.0, 0.0, 1.0)];
        let picture = Picture { width: 4, height: 1, pixels, ..Picture::default() };
        let reds = |behind| codes(&picture, behind).iter().map(|code| code[0]).collect::<Vec<_>>();
        let shown = reds(1.0);
        assert_eq!((shown[0], shown[2], shown[3]), (255, 255, 0));
        // Half of white is between codes 187 and 188.
        let shown = reds(0.0);
        assert!(shown[0] == 0 && (187..=188).contains(&shown[1]), "{shown:?}");
    }
}
