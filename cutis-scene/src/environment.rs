//! Light from all around: a latitude-longitude map.

use crate::texture::Texture;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A distant surrounding. +Y is up; the middle column of the map lies towards -Z, a quarter of its width to the right
/// towards +X.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Radiance in latitude-longitude layout, first row at +Y, linear Rec. 709.
    pub map: Arc<Texture>,
    /// Turn about +Y, rad: positive moves what was towards -Z to -X.
    pub rotation_rad: f32,
    /// Factor on the map's radiance, W/(m² sr) per unit of the map.
    pub radiance_scale: Vec3,
    /// Whether the camera sees it behind the scene.
    pub visible: bool,
}

impl Environment {
    /// Radiance that arrives from `dir` (unit vector away from the scene).
    pub fn radiance(&self, dir: Vec3) -> Vec3 {
        self.map.sample_latlong(self.uv(dir)).truncate() * self.radiance_scale
    }

    /// Where a direction falls on the map.
    pub fn uv(&self, dir: Vec3) -> Vec2 {
        let azimuth = dir.x.atan2(-dir.z) + self.rotation_rad;
        Vec2::new((0.5 + azimuth / TAU).rem_euclid(1.0), dir.y.clamp(-1.0, 1.0).acos() / PI)
    }

    /// Direction of a place on the map; the inverse of [`Environment::uv`].
    pub fn dir(&self, uv: Vec2) -> Vec3 {
        let azimuth = (uv.x - 0.5) * TAU - self.rotation_rad;
        let (sin_polar, cos_polar) = (uv.y * PI).sin_cos();
        Vec3::new(sin_polar * azimuth.sin(), cos_polar, -sin_polar * azimuth.cos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Texels;

    fn turned(rotation_rad: f32) -> Environment {
        let map = Arc::new(Texture::new(1, 1, Texels::LinearF32(vec![[1.0; 4]])));
        Environment { map, rotation_rad, radiance_scale: Vec3::ONE, visible: false }
    }

    #[test]
    fn the_middle_of_the_map_lies_towards_minus_z() {
        let uv = turned(0.0).uv(-Vec3::Z);
        assert!((uv - Vec2::new(0.5, 0.5)).length() < 1e-6, "{uv}");
        assert!((turned(0.0).uv(Vec3::X).x - 0.75).abs() < 1e-6);
    }

    #[test]
    fn uv_and_dir_are_inverse() {
        let environment = turned(0.7);
        for i in 1..20 {
            let uv = Vec2::new(i as f32 / 20.0, (i * 7 % 20) as f32 / 20.0 * 0.9 + 0.05);
            assert!((environment.uv(environment.dir(uv)) - uv).length() < 1e-5, "{uv}");
        }
    }

    #[test]
    fn a_positive_turn_moves_the_middle_towards_minus_x() {
        let dir = turned(std::f32::consts::FRAC_PI_2).dir(Vec2::new(0.5, 0.5));
        assert!((dir + Vec3::X).length() < 1e-6, "{dir}");
    }
}
