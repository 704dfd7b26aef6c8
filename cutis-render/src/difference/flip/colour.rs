//! Colours as FLIP compares them: from light to opponents, from opponents to a perceptually even space, and the
//! distance there.

use glam::{DMat3, DVec3, Mat3, Vec2, Vec3};
use std::sync::LazyLock;

/// Exponent that compresses large distances (`q_c` in the paper).
const DISTANCE_EXPONENT: f32 = 0.7;
/// Up to this part of the largest distance … (`p_c`)
const KNEE: f32 = 0.4;
/// … errors take this part of 0..=1 (`p_t`): small differences are what people argue about.
const BELOW_KNEE: f32 = 0.95;

/// Linear Rec. 709 to XYZ, by rows, from the primaries and the white (0.3127, 0.3290) of ITU-R BT.709-6 in whole numbers.
const XYZ_ROWS: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Between light and XYZ divided by that of white.
struct Matrices {
    relative_xyz_from_rgb: Mat3,
    rgb_from_relative_xyz: Mat3,
}

static MATRICES: LazyLock<Matrices> = LazyLock::new(|| {
    let xyz_from_rgb = DMat3::from_cols_array_2d(&XYZ_ROWS).transpose();
    let white = xyz_from_rgb * DVec3::ONE;
    let relative = DMat3::from_diagonal(white.recip()) * xyz_from_rgb;
    Matrices {
        relative_xyz_from_rgb: relative.as_mat3(),
        rgb_from_relative_xyz: relative.inverse().as_mat3(),
    }
});

/// YyCxCz: L*a*b* without its cube roots, so that blurring it is blurring light.
pub(super) fn opponent(rgb: Vec3) -> Vec3 {
    let xyz = MATRICES.relative_xyz_from_rgb * rgb;
    Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
}

/// The light of an opponent colour.
fn light(opponent: Vec3) -> Vec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let xyz = Vec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
    MATRICES.rgb_from_relative_xyz * xyz
}

/// L*a*b* (CIE 1976, white D65) in which dark colours are less colourful: a* and b* are multiplied by L*/100 (Hunt).
#[derive(Debug, Clone, Copy)]
pub(super) struct Perceived(Vec3);

impl Perceived {
    /// Of a blurred opponent colour; what the screen cannot show is clamped.
    pub(super) fn new(opponent: Vec3) -> Self {
        Self::of_light(light(opponent).clamp(Vec3::ZERO, Vec3::ONE))
    }

    fn of_light(rgb: Vec3) -> Self {
        let [x, y, z] = (MATRICES.relative_xyz_from_rgb * rgb).to_array().map(lab_root);
        let lightness = 116.0 * y - 16.0;
        let hunt = 0.01 * lightness;
        Self(Vec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)))
    }

    /// Error of the colour in 0..=1.
    pub(super) fn distance(&self, other: &Self) -> f32 {
        static LARGEST: LazyLock<f32> = LazyLock::new(|| {
            let [green, blue] = [Vec3::Y, Vec3::Z].map(Perceived::of_light);
            green.compressed(&blue)
        });
        stretched(self.compressed(other), *LARGEST)
    }

    /// HyAB: along the lightness by streets, across it as the crow flies.
    fn compressed(&self, other: &Self) -> f32 {
        let d = self.0 - other.0;
        (d.x.abs() + Vec2::new(d.y, d.z).length()).powf(DISTANCE_EXPONENT)
    }
}

/// Spreads 0..=largest over 0..=1, with more room for small errors.
fn stretched(error: f32, largest: f32) -> f32 {
    let knee = KNEE * largest;
    if error < knee {
        BELOW_KNEE * error / knee
    } else {
        BELOW_KNEE + (error - knee) / (largest - knee) * (1.0 - BELOW_KNEE)
    }
}

/// The cube root of CIE 1976, with its straight line near black.
fn lab_root(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opponents_hold_the_light() {
        for rgb in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE, Vec3::new(0.2, 0.7, 0.01)] {
            // Opponents reach 100 and more; their differences are rounded accordingly.
            assert!((light(opponent(rgb)) - rgb).abs().max_element() < 8.0 * f32::EPSILON, "{rgb}");
        }
    }

    #[test]
    fn greys_have_no_hue_and_white_is_100() {
        for grey in [0.0, 0.001, 0.18, 1.0] {
            let Perceived(lab) = Perceived::of_light(Vec3::splat(grey));
            // A few roundings of cube roots near 1, times 500.
            assert!(lab.y.abs() < 5e-4 && lab.z.abs() < 5e-4, "{lab}");
        }
        assert!((Perceived::of_light(Vec3::ONE).0.x - 100.0).abs() < 1e-4);
        // CIE: 18 % grey has L* 49.5 (evaluated by hand: 116 · 0.18^(1/3) - 16 = 49.496).
        assert!((Perceived::of_light(Vec3::splat(0.18)).0.x - 49.496).abs() < 1e-3);
    }

    #[test]
    fn the_largest_distance_is_1() {
        let [green, blue, black] = [Vec3::Y, Vec3::Z, Vec3::ZERO].map(Perceived::of_light);
        assert_eq!(green.distance(&blue), 1.0);
        assert_eq!(green.distance(&blue), blue.distance(&green));
        assert_eq!(black.distance(&black), 0.0);
    }

    #[test]
    fn the_knee_is_met_from_both_sides() {
        let (below, above) = (stretched(0.4 * 41.0 * (1.0 - 1e-6), 41.0), stretched(0.4 * 41.0, 41.0));
        assert!((below - 0.95).abs() < 1e-5 && (above - 0.95).abs() < 1e-5);
    }
}
