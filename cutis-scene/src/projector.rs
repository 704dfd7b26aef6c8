//! A lamp that throws an image, as a slide projector does.

use crate::Texture;
use glam::{Vec2, Vec3};
use std::fmt;
use std::sync::Arc;

/// A projector. Its image is sharp at every distance.
#[derive(Clone)]
pub struct Projector {
    /// Centre of the lens, mm.
    pub position_mm: Vec3,
    /// Unit vectors to the right and up in the image as it leaves the lens, and the way the light travels.
    pub axes: [Vec3; 3],
    /// Half the height of the image over the distance along the axis: the tangent of half its vertical angle.
    pub tan_half_height: f32,
    /// What it throws, rows from the top; its colours filter the light.
    pub image: Arc<Texture>,
    /// Radiant intensity where the image is white, W/sr.
    pub intensity_w_per_sr: Vec3,
    /// Radius of the lens, mm: shadows get soft, the image does not.
    pub radius_mm: f32,
    /// How far the image has moved to the right and up within its frame, in parts of its width and height: what leaves on one
    /// side comes in on the other.
    pub shift: Vec2,
    /// How fast it moves, the same parts per second.
    pub drift_per_s: Vec2,
}

impl Projector {
    /// A projector that looks along a direction; `up` tells how the image is turned, and any other direction does where both
    /// are the same line.
    pub fn axes(dir_travel: Vec3, up: Vec3) -> [Vec3; 3] {
        let right =
            dir_travel.cross(up).try_normalize().unwrap_or_else(|| dir_travel.any_orthonormal_vector());
        [right, right.cross(dir_travel), dir_travel]
    }

    /// What the image lets through in a direction that light travels; black beside the image and behind the lens.
    pub fn filter(&self, dir_travel: Vec3) -> Vec3 {
        let [x, y, z] = self.axes.map(|axis| axis.dot(dir_travel));
        let size = Vec2::new(self.image.width() as f32, self.image.height() as f32);
        // From -1 to 1 over the image.
        let place = Vec2::new(x * size.y / size.x, -y) / (z * self.tan_half_height);
        if z <= 0.0 || place.abs().max_element() > 1.0 {
            return Vec3::ZERO;
        }
        // Textures repeat: the outermost half texel is held instead.
        let uv = (0.5 + 0.5 * place).clamp(0.5 / size, 1.0 - 0.5 / size);
        self.image.sample(uv + Vec2::new(-self.shift.x, self.shift.y)).truncate()
    }

    /// The same projector some seconds later.
    pub fn after(&self, time_s: f32) -> Self {
        // Whole frames change nothing, and cost digits.
        let moved = self.shift + self.drift_per_s * time_s;
        Self { shift: if time_s == 0.0 { self.shift } else { moved.fract_gl() }, ..self.clone() }
    }
}

/// Without the texels.
impl fmt::Debug for Projector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Projector")
            .field("position_mm", &self.position_mm)
            .field("axes", &self.axes)
            .field("tan_half_height", &self.tan_half_height)
            .field("image", &[self.image.width(), self.image.height()])
            .field("intensity_w_per_sr", &self.intensity_w_per_sr)
            .field("radius_mm", &self.radius_mm)
            .field("shift", &self.shift)
            .field("drift_per_s", &self.drift_per_s)
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Light, Texels};

    /// 4 × 2 texels: red, green, blue and white above, black below, thrown down -z from 1 m.
    fn slide() -> Projector {
        let above = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]];
        let texels = above.into_iter().chain([[0.0, 0.0, 0.0, 1.0]; 4]).collect();
        Projector {
            position_mm: Vec3::Z * 1000.0,
            axes: Projector::axes(-Vec3::Z, Vec3::Y),
            tan_half_height: 0.1,
            image: Arc::new(Texture::new(4, 2, Texels::LinearF32(texels))),
            intensity_w_per_sr: Vec3::splat(2.0),
            radius_mm: 0.0,
            shift: Vec2::ZERO,
            drift_per_s: Vec2::ZERO,
        }
    }

    #[test]
    fn the_image_stands_upright_as_large_as_its_angle() {
        let light = Light::Projector(slide());
        let irradiance = |x: f32, y: f32| light.sample(Vec3::new(x, y, 0.0)).irradiance_w_per_m2;
        // At 1 m it is 200 mm high and 400 mm wide; seen from the lens, x grows to the right.
        for (x, colour) in [(-150.0, Vec3::X), (-50.0, Vec3::Y), (50.0, Vec3::Z), (150.0, Vec3::ONE)] {
            let distance2_m2 = 1.0 + (x * x + 2500.0) * 1e-6;
            assert!((irradiance(x, 50.0) - colour * 2.0 / distance2_m2).length() < 1e-5, "{x}");
            assert_eq!(irradiance(x, -50.0), Vec3::ZERO);
        }
        for (x, y) in [(201.0, 50.0), (-201.0, 50.0), (0.0, 101.0)] {
            assert_eq!(irradiance(x, y), Vec3::ZERO, "{x}, {y}");
        }
        assert!(irradiance(199.0, 99.0).min_element() > 0.0 && irradiance(-199.0, 99.0).y == 0.0);
        assert_eq!(light.sample(Vec3::Z * 2000.0).irradiance_w_per_m2, Vec3::ZERO, "behind the lens");
    }

    /// A quarter of the width a second to the right and half the height up: colours follow each other, and what left comes in on
    /// the other side.
    #[test]
    fn the_image_moves_within_its_frame() {
        let moving = Projector { drift_per_s: Vec2::new(0.25, 0.5), ..slide() };
        let colours = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
        for (second, above) in [(0, true), (1, false), (2, true), (7, false), (4001, false)] {
            let light = Light::Projector(moving.after(second as f32));
            for (i, x) in [-150.0, -50.0, 50.0, 150.0].into_iter().enumerate() {
                let at = |y: f32| light.sample(Vec3::new(x, y, 0.0)).irradiance_w_per_m2;
                let distance2_m2 = 1.0 + (x * x + 2500.0) * 1e-6;
                let expected = colours[(i + 4004 - second) % 4] * 2.0 / distance2_m2;
                let [lit, dark] = if above { [50.0, -50.0] } else { [-50.0, 50.0] }.map(at);
                assert!((lit - expected).length() < 1e-4, "{second} s, {x} mm: {lit}, {expected}");
                assert!(dark.length() < 1e-4, "{second} s: {dark}");
            }
        }
        // Upwards, by a quarter of the height of four rows.
        let rows = colours.map(|c| [c.x, c.y, c.z, 1.0]).to_vec();
        let image = Arc::new(Texture::new(1, 4, Texels::LinearF32(rows)));
        let rising = Projector { image, shift: Vec2::new(0.0, 0.25), ..slide() };
        let light = Light::Projector(rising);
        for (y, colour) in [(75.0, Vec3::Y), (25.0, Vec3::Z), (-25.0, Vec3::ONE), (-75.0, Vec3::X)] {
            let found = light.sample(Vec3::new(0.0, y, 0.0)).irradiance_w_per_m2.normalize();
            assert!((found - colour.normalize()).length() < 1e-4, "{y} mm: {found}");
        }
        let beside = Light::Projector(moving.after(1.0)).sample(Vec3::new(201.0, 50.0, 0.0));
        assert_eq!(beside.irradiance_w_per_m2, Vec3::ZERO, "the frame stays where it is");
    }

    #[test]
    fn an_upright_direction_leaves_no_axis_undefined() {
        for axes in [Projector::axes(Vec3::Y, Vec3::Y), Projector::axes(-Vec3::Z, Vec3::Y)] {
            let [right, up, along] = axes;
            assert!((right.cross(along) + up).length() < 1e-6 || (right.cross(along) - up).length() < 1e-6);
            assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-6));
        }
        assert_eq!(Projector::axes(-Vec3::Z, Vec3::Y), [Vec3::X, Vec3::Y, -Vec3::Z]);
    }
}
