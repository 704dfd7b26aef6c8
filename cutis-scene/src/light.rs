//! Lights that have a direction at every point. The environment is in [`crate::environment`].
//!
//! Units: irradiance in W/m², intensity in W/sr, distances in mm and turned to metres where the inverse square
//! is taken, so that an intensity of 1 gives an irradiance of 1 at one metre.

use crate::Projector;
use glam::{Vec2, Vec3};

/// A light and its place in the scene. Colours are linear Rec. 709.
#[derive(Debug, Clone)]
pub enum Light {
    /// So far away that it comes from one direction.
    Directional {
        /// Unit vector from the scene towards the light.
        dir_to_light: Vec3,
        /// Irradiance on a plane facing the light, W/m².
        irradiance_w_per_m2: Vec3,
        /// Half the angle the light subtends, rad; 0 is a sharp shadow.
        angular_radius_rad: f32,
    },
    /// A small sphere that shines equally in all directions.
    Point {
        /// Centre, mm.
        position_mm: Vec3,
        /// Radiant intensity, W/sr.
        intensity_w_per_sr: Vec3,
        /// Radius of the sphere, mm; 0 is a sharp shadow.
        radius_mm: f32,
    },
    /// A point light behind a round aperture with a soft edge (`KHR_lights_punctual`).
    Spot {
        /// Centre, mm.
        position_mm: Vec3,
        /// Unit vector the light travels along its axis.
        dir_travel: Vec3,
        /// Radiant intensity on the axis, W/sr.
        intensity_w_per_sr: Vec3,
        /// Angle from the axis up to which it is full, rad.
        inner_cone_rad: f32,
        /// Angle from the axis at which it has faded to nothing, rad.
        outer_cone_rad: f32,
        /// Radius of the source, mm.
        radius_mm: f32,
    },
    /// A lamp that throws an image.
    Projector(Projector),
}

/// A light as one point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit vector from the point towards the light.
    pub dir_to_light: Vec3,
    /// Distance to it, mm; infinite for a directional light.
    pub distance_mm: f32,
    /// Irradiance on a plane facing the light, were nothing in between, W/m².
    pub irradiance_w_per_m2: Vec3,
}

impl Light {
    /// The same light some seconds later: images of projectors may move.
    pub fn after(&self, time_s: f32) -> Self {
        match self {
            Light::Projector(projector) => Light::Projector(projector.after(time_s)),
            light => light.clone(),
        }
    }

    /// Whether it changes with time.
    pub fn moves(&self) -> bool {
        matches!(self, Light::Projector(projector) if projector.drift_per_s != Vec2::ZERO)
    }

    /// The light's centre as seen from `point_mm`.
    pub fn sample(&self, point_mm: Vec3) -> LightSample {
        match *self {
            Light::Projector(ref projector) => {
                let white = by_inverse_square(point_mm, projector.position_mm, projector.intensity_w_per_sr);
                let filter = projector.filter(-white.dir_to_light);
                LightSample { irradiance_w_per_m2: white.irradiance_w_per_m2 * filter, ..white }
            }
            Light::Directional { dir_to_light, irradiance_w_per_m2, .. } => {
                LightSample { dir_to_light, distance_mm: f32::INFINITY, irradiance_w_per_m2 }
            }
            Light::Point { position_mm, intensity_w_per_sr, .. } => {
                by_inverse_square(point_mm, position_mm, intensity_w_per_sr)
            }
            Light::Spot {
                position_mm,
                dir_travel,
                intensity_w_per_sr,
                inner_cone_rad,
                outer_cone_rad,
                ..
            } => {
                let full = by_inverse_square(point_mm, position_mm, intensity_w_per_sr);
                let cos_axis = dir_travel.dot(-full.dir_to_light);
                let cone = spot_falloff(cos_axis, inner_cone_rad, outer_cone_rad);
                LightSample { irradiance_w_per_m2: full.irradiance_w_per_m2 * cone, ..full }
            }
        }
    }

    /// A point of the light's disc as seen from `point_mm`: `disc` lies in the unit disc. The irradiance is that of
    /// the centre, which is exact for lights that are small against their distance.
    pub fn sample_disc(&self, point_mm: Vec3, disc: glam::Vec2) -> LightSample {
        let centre = self.sample(point_mm);
        let (tangent, bitangent) = centre.dir_to_light.any_orthonormal_pair();
        let aside = tangent * disc.x + bitangent * disc.y;
        match *self {
            Light::Directional { angular_radius_rad, .. } => {
                let dir_to_light = (centre.dir_to_light + aside * angular_radius_rad.tan()).normalize();
                LightSample { dir_to_light, ..centre }
            }
            Light::Point { radius_mm, .. }
            | Light::Spot { radius_mm, .. }
            | Light::Projector(Projector { radius_mm, .. }) => {
                let to_light = centre.dir_to_light * centre.distance_mm + aside * radius_mm;
                let distance_mm = to_light.length().max(f32::MIN_POSITIVE);
                LightSample { dir_to_light: to_light / distance_mm, distance_mm, ..centre }
            }
        }
    }

    /// Whether the light has an extent, so that its shadows have soft edges.
    pub fn has_extent(&self) -> bool {
        match *self {
            Light::Directional { angular_radius_rad, .. } => angular_radius_rad > 0.0,
            Light::Point { radius_mm, .. }
            | Light::Spot { radius_mm, .. }
            | Light::Projector(Projector { radius_mm, .. }) => radius_mm > 0.0,
        }
    }
}

fn by_inverse_square(point_mm: Vec3, position_mm: Vec3, intensity_w_per_sr: Vec3) -> LightSample {
    let to_light = position_mm - point_mm;
    // A point at the light's very centre has no direction; MIN_POSITIVE keeps the division finite.
    let distance_mm = to_light.length().max(f32::MIN_POSITIVE);
    // Within a millimetre the inverse square of a real lamp no longer holds: it would only make infinities.
    let distance_m = distance_mm.max(1.0) * 1e-3;
    LightSample {
        dir_to_light: to_light / distance_mm,
        distance_mm,
        irradiance_w_per_m2: intensity_w_per_sr / (distance_m * distance_m),
    }
}

/// Fall-off of a spot's edge: the smooth ramp between the cosines of the two cones recommended by
/// `KHR_lights_punctual` (section "Inner and Outer Cone Angles").
fn spot_falloff(cos_axis: f32, inner_cone_rad: f32, outer_cone_rad: f32) -> f32 {
    let (cos_inner, cos_outer) = (inner_cone_rad.cos(), outer_cone_rad.cos());
    // The specification's own floor for cones that coincide.
    let ramp = (cos_axis - cos_outer) / (cos_inner - cos_outer).max(1e-3);
    let ramp = ramp.clamp(0.0, 1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_watt_per_steradian_gives_one_watt_per_square_metre_at_one_metre() {
        let light =
            Light::Point { position_mm: Vec3::Z * 1000.0, intensity_w_per_sr: Vec3::ONE, radius_mm: 0.0 };
        assert!((light.sample(Vec3::ZERO).irradiance_w_per_m2.x - 1.0).abs() < 1e-6);
        assert!((light.sample(Vec3::Z * -1000.0).irradiance_w_per_m2.x - 0.25).abs() < 1e-6);
    }

    #[test]
    fn spot_is_full_on_its_axis_and_dark_outside_its_cone() {
        let light = Light::Spot {
            position_mm: Vec3::Z * 1000.0,
            dir_travel: -Vec3::Z,
            intensity_w_per_sr: Vec3::ONE,
            inner_cone_rad: 0.1,
            outer_cone_rad: 0.2,
            radius_mm: 0.0,
        };
        assert!((light.sample(Vec3::ZERO).irradiance_w_per_m2.x - 1.0).abs() < 1e-6);
        assert_eq!(light.sample(Vec3::X * 300.0).irradiance_w_per_m2, Vec3::ZERO);
    }

    #[test]
    fn disc_samples_stay_on_the_disc() {
        let light =
            Light::Point { position_mm: Vec3::Z * 100.0, intensity_w_per_sr: Vec3::ONE, radius_mm: 5.0 };
        let sample = light.sample_disc(Vec3::ZERO, glam::Vec2::new(0.6, 0.8));
        let there = sample.dir_to_light * sample.distance_mm;
        assert!(((there - Vec3::Z * 100.0).length() - 5.0).abs() < 1e-3);
    }
}
