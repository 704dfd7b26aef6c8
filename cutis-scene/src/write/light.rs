//! `[[light]]`.

use super::files::Files;
use super::text::{degrees, number, quoted, shortest, vector};
use crate::source::TextureSource;
use crate::{Environment, Light, Projector, SceneError, Texture};
use glam::{Vec2, Vec3};

/// All lights of a scene; a scene that is meant to be dark says so.
pub(super) fn all(
    lights: &[Light],
    environment: Option<&Environment>,
    files: &mut Files,
) -> Result<String, SceneError> {
    let mut text = String::new();
    for light in lights {
        text += "\n[[light]]\n";
        text += &one(light, files)?;
    }
    if let Some(environment) = environment {
        text += "\n[[light]]\n";
        text += &sky(environment, files)?;
    }
    Ok(text)
}

fn one(light: &Light, files: &mut Files) -> Result<String, SceneError> {
    let mut text = String::new();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    match light {
        Light::Directional { dir_to_light, irradiance_w_per_m2, angular_radius_rad } => {
            put("kind", quoted("directional"));
            put("direction", vector(-*dir_to_light));
            strength(*irradiance_w_per_m2, &mut put);
            put("angular_radius_degrees", degrees(*angular_radius_rad));
        }
        Light::Point { position_mm, intensity_w_per_sr, radius_mm } => {
            put("kind", quoted("point"));
            put("position_mm", vector(*position_mm));
            strength(*intensity_w_per_sr, &mut put);
            put("radius_mm", number(*radius_mm));
        }
        Light::Spot {
            position_mm,
            dir_travel,
            intensity_w_per_sr,
            inner_cone_rad,
            outer_cone_rad,
            radius_mm,
        } => {
            put("kind", quoted("spot"));
            put("position_mm", vector(*position_mm));
            put("direction", vector(*dir_travel));
            strength(*intensity_w_per_sr, &mut put);
            put("inner_cone_degrees", degrees(*inner_cone_rad));
            put("outer_cone_degrees", degrees(*outer_cone_rad));
            put("radius_mm", number(*radius_mm));
        }
        Light::Projector(projector) => {
            let Projector {
                position_mm, axes, tan_half_height, image, intensity_w_per_sr, radius_mm, ..
            } = projector;
            put("kind", quoted("projector"));
            put("path", quoted(&picture(image, files)?));
            put("position_mm", vector(*position_mm));
            put("direction", vector(axes[2]));
            put("up", vector(axes[1]));
            put("vertical_fov_degrees", field_of_view(*tan_half_height));
            strength(*intensity_w_per_sr, &mut put);
            put("radius_mm", number(*radius_mm));
            put("shift", pair(projector.shift));
            put("drift_per_s", pair(projector.drift_per_s));
        }
    }
    Ok(text)
}

fn pair(v: Vec2) -> String {
    format!("[{}, {}]", number(v.x), number(v.y))
}

fn sky(environment: &Environment, files: &mut Files) -> Result<String, SceneError> {
    let Environment { map, rotation_rad, radiance_scale, visible } = environment;
    let mut text = String::new();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    put("kind", quoted("environment"));
    // Without a path it is the studio.
    if map.source() != Some(&TextureSource::Studio) {
        put("path", quoted(&picture(map, files)?));
    }
    put("rotation_degrees", degrees(*rotation_rad));
    strength(*radiance_scale, &mut put);
    put("visible", visible.to_string());
    Ok(text)
}

fn picture(texture: &Texture, files: &mut Files) -> Result<String, SceneError> {
    match texture.source() {
        Some(TextureSource::File(path)) => files.name(path),
        _ => files.draw(texture, true),
    }
}

/// One number for white light; else the strongest channel, and a colour, where their product is exact.
fn strength(strength: Vec3, put: &mut impl FnMut(&str, String)) {
    let largest = strength.max_element();
    if strength == Vec3::splat(largest) {
        put("intensity", number(largest));
        return;
    }
    let colour = strength / largest;
    if colour * largest == strength {
        put("colour", vector(colour));
        put("intensity", number(largest));
    } else {
        put("colour", vector(strength));
    }
}

fn field_of_view(tan_half_height: f32) -> String {
    let angle = 2.0 * f64::from(tan_half_height).atan();
    shortest(angle.to_degrees(), |degrees| (0.5 * degrees.to_radians()).tan() as f32 == tan_half_height)
}
