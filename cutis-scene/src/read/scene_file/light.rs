//! `[[light]]`: directional, point and spot lights, projectors, and the environment.

use super::Context;
use super::keys::Keys;
use crate::read::image::ColourSpace;
use crate::studio::studio_environment;
use crate::{Environment, Light, Projector, SceneError, Texture};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_PI_4;
use std::sync::Arc;

/// Most lights of a scene.
const MAX_LIGHTS: usize = 1000;

/// Strongest light, W/sr or W/m²: farther from one than any real lamp.
const MAX_INTENSITY: f32 = 1e9;

/// All lights of a scene file.
#[derive(Default)]
pub(super) struct Lights {
    /// Whether the file speaks of any, so that those of the mesh file stay dark.
    pub(super) any: bool,
    pub(super) lights: Vec<Light>,
    pub(super) environment: Option<Environment>,
}

/// Reads every `[[light]]`.
pub(super) fn read_all(root: &Keys, context: &mut Context) -> Result<Lights, SceneError> {
    let tables = root.tables("light")?;
    if tables.len() > MAX_LIGHTS {
        return Err(root.error("light", format!("{} lights; at most {MAX_LIGHTS}", tables.len())));
    }
    let mut all = Lights { any: root.has("light"), ..Lights::default() };
    for keys in &tables {
        match keys.required("kind", keys.string("kind")?)? {
            "directional" => all.lights.push(directional(keys)?),
            "point" => all.lights.push(point(keys)?),
            "spot" => all.lights.push(spot(keys)?),
            "projector" => all.lights.push(projector(keys, context)?),
            "environment" if all.environment.is_some() => {
                return Err(keys.error("kind", "is a second environment; a scene has one"));
            }
            "environment" => all.environment = Some(environment(keys, context)?),
            other => {
                let reason = format!(
                    "`{other}` is not known; directional, point, spot, projector and environment are"
                );
                return Err(keys.error("kind", reason));
            }
        }
    }
    Ok(all)
}

/// Linear colour times intensity.
fn strength(keys: &Keys) -> Result<Vec3, SceneError> {
    let colour = keys.vector_in("colour", 0.0..=MAX_INTENSITY)?.unwrap_or(Vec3::ONE);
    let intensity = keys.number_in("intensity", 0.0..=MAX_INTENSITY)?.unwrap_or(1.0);
    Ok(colour * intensity)
}

fn position(keys: &Keys) -> Result<Vec3, SceneError> {
    keys.required("position_mm", keys.vector_in("position_mm", -1e7..=1e7)?)
}

fn radius(keys: &Keys) -> Result<f32, SceneError> {
    Ok(keys.number_in("radius_mm", 0.0..=1e6)?.unwrap_or(0.0))
}

/// `direction` is the way the light travels; `intensity` its irradiance in W/m².
fn directional(keys: &Keys) -> Result<Light, SceneError> {
    keys.only(&["kind", "direction", "colour", "intensity", "angular_radius_degrees"])?;
    let angular_radius = keys.radians("angular_radius_degrees", 0.0..=45.0)?.unwrap_or(0.0);
    Ok(Light::Directional {
        dir_to_light: -keys.required("direction", keys.direction("direction")?)?,
        irradiance_w_per_m2: strength(keys)?,
        angular_radius_rad: angular_radius,
    })
}

/// `intensity` in W/sr.
fn point(keys: &Keys) -> Result<Light, SceneError> {
    keys.only(&["kind", "position_mm", "colour", "intensity", "radius_mm"])?;
    Ok(Light::Point {
        position_mm: position(keys)?,
        intensity_w_per_sr: strength(keys)?,
        radius_mm: radius(keys)?,
    })
}

/// `direction` is the way the light travels along its axis; `intensity` in W/sr on the axis.
fn spot(keys: &Keys) -> Result<Light, SceneError> {
    keys.only(&[
        "kind",
        "position_mm",
        "direction",
        "colour",
        "intensity",
        "radius_mm",
        "inner_cone_degrees",
        "outer_cone_degrees",
    ])?;
    let outer = keys.radians("outer_cone_degrees", f32::MIN_POSITIVE..=90.0)?.unwrap_or(FRAC_PI_4);
    let inner = keys.radians("inner_cone_degrees", 0.0..=90.0)?.unwrap_or(0.0);
    if inner >= outer {
        let [outer, inner] = [outer, inner].map(f32::to_degrees);
        let reason = format!("must be below outer_cone_degrees ({outer}), got {inner}");
        return Err(keys.error("inner_cone_degrees", reason));
    }
    Ok(Light::Spot {
        position_mm: position(keys)?,
        dir_travel: keys.required("direction", keys.direction("direction")?)?,
        intensity_w_per_sr: strength(keys)?,
        inner_cone_rad: inner,
        outer_cone_rad: outer,
        radius_mm: radius(keys)?,
    })
}

/// The image at `path`.
fn image(keys: &Keys, context: &mut Context) -> Result<Arc<Texture>, SceneError> {
    let text = keys.required("path", keys.string("path")?)?;
    let path = context.folder.resolve(text).map_err(|reason| keys.error("path", reason))?;
    context.textures.file(&path, ColourSpace::Colour, &mut context.warnings)
}

/// `direction` is the way the light travels along its axis; `intensity` in W/sr where the image is white.
fn projector(keys: &Keys, context: &mut Context) -> Result<Light, SceneError> {
    keys.only(&[
        "kind",
        "path",
        "position_mm",
        "direction",
        "up",
        "vertical_fov_degrees",
        "colour",
        "intensity",
        "radius_mm",
        "shift",
        "drift_per_s",
    ])?;
    let dir_travel = keys.required("direction", keys.direction("direction")?)?;
    let up = keys.direction("up")?.unwrap_or(Vec3::Y);
    keys.number_in("vertical_fov_degrees", 0.1..=170.0)?;
    let angle = keys.double("vertical_fov_degrees")?.unwrap_or(30.0);
    let shift = keys.pair_in("shift", -1.0..=1.0)?.unwrap_or(Vec2::ZERO);
    let drift_per_s = keys.pair_in("drift_per_s", -100.0..=100.0)?.unwrap_or(Vec2::ZERO);
    Ok(Light::Projector(Projector {
        position_mm: position(keys)?,
        axes: Projector::axes(dir_travel, up),
        tan_half_height: (0.5 * angle.to_radians()).tan() as f32,
        image: image(keys, context)?,
        intensity_w_per_sr: strength(keys)?,
        radius_mm: radius(keys)?,
        shift,
        drift_per_s,
    }))
}

/// A latitude-longitude image, or the studio where no `path` is given. Colour times intensity scales its radiance.
fn environment(keys: &Keys, context: &mut Context) -> Result<Environment, SceneError> {
    keys.only(&["kind", "path", "rotation_degrees", "colour", "intensity", "visible"])?;
    let rotation = keys.radians("rotation_degrees", -360.0..=360.0)?.unwrap_or(0.0);
    let map = match keys.has("path") {
        false => studio_environment().map,
        true => image(keys, context)?,
    };
    Ok(Environment {
        map,
        rotation_rad: rotation,
        radiance_scale: strength(keys)?,
        visible: keys.boolean("visible")?.unwrap_or(false),
    })
}
