//! Cameras and punctual lights of nodes. Both look along the node's -Z.

use super::Document;
use crate::{Camera, Light, SceneError};
use glam::{Mat4, Vec3};
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type};
use gltf::json::scene::Node;
use gltf::json::validation::Checked;
use std::f32::consts::{FRAC_PI_2, PI};

/// The light of a node, if it has one.
pub(super) fn of_node(
    document: &Document,
    node: &Node,
    world: Mat4,
    place: &str,
) -> Result<Option<Light>, SceneError> {
    let Some(reference) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) else {
        return Ok(None);
    };
    let extension = document.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let list = extension.map_or(&[][..], |e| e.lights.as_slice());
    let light = document.get(list, reference.light, &format!("{place}.extensions.KHR_lights_punctual"))?;
    let place = format!("extensions.KHR_lights_punctual.lights[{}]", reference.light.value());
    to_light(document, light, world, &place).map(Some)
}

fn to_light(document: &Document, light: &JsonLight, world: Mat4, place: &str) -> Result<Light, SceneError> {
    let strength = Vec3::from_array(light.color) * light.intensity;
    if !strength.is_finite() || strength.min_element() < 0.0 {
        return document.fail(place, "colour times intensity must be finite and not negative");
    }
    let position_mm = world.w_axis.truncate();
    let dir_travel = -world.z_axis.truncate().normalize_or(Vec3::Z);
    match (&light.type_, &light.spot) {
        (Checked::Valid(Type::Directional), _) => Ok(Light::Directional {
            dir_to_light: -dir_travel,
            irradiance_w_per_m2: strength,
            angular_radius_rad: 0.0,
        }),
        (Checked::Valid(Type::Point), _) => {
            Ok(Light::Point { position_mm, intensity_w_per_sr: strength, radius_mm: 0.0 })
        }
        (Checked::Valid(Type::Spot), Some(spot)) => {
            let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2) {
                let reason = format!("cone angles {inner} and {outer}; 0 ≤ inner < outer ≤ π/2 is needed");
                return document.fail(format!("{place}.spot"), reason);
            }
            Ok(Light::Spot {
                position_mm,
                dir_travel,
                intensity_w_per_sr: strength,
                inner_cone_rad: inner,
                outer_cone_rad: outer,
                radius_mm: 0.0,
            })
        }
        (Checked::Valid(Type::Spot), None) => document.fail(place, "is a spot without `spot`"),
        _ => document.fail(place, "has an unknown type; directional, point and spot are known"),
    }
}

/// The camera of a node, if it has a perspective one.
pub(super) fn camera_of_node(
    document: &Document,
    node: &Node,
    world: Mat4,
    place: &str,
) -> Result<Option<Camera>, SceneError> {
    let Some(index) = node.camera else { return Ok(None) };
    let camera = document.get(&document.root.cameras, index, &format!("{place}.camera"))?;
    let place = format!("cameras[{}]", index.value());
    if camera.type_ == Checked::Invalid {
        return document.fail(place, "has an unknown type");
    }
    if camera.type_ == Checked::Valid(CameraType::Orthographic) {
        return Ok(None);
    }
    let Some(perspective) = &camera.perspective else {
        return document.fail(place, "is perspective without `perspective`");
    };
    let vertical_fov_rad = perspective.yfov;
    if !(vertical_fov_rad > 0.0 && vertical_fov_rad < PI) {
        let reason = format!("{vertical_fov_rad} rad is not between 0 and π");
        return document.fail(format!("{place}.perspective.yfov"), reason);
    }
    let position_mm = world.w_axis.truncate();
    let forward = -world.z_axis.truncate().normalize_or(Vec3::Z);
    let up = world.y_axis.truncate().normalize_or(Vec3::Y);
    // A metre ahead for now: `finish` moves it to the depth of the scene.
    let look_at_mm = position_mm + forward * 1000.0;
    Ok(Some(Camera { position_mm, look_at_mm, up, vertical_fov_rad, exposure_ev: 0.0 }))
}
