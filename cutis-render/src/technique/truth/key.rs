//! A number that tells renderings apart whose samples must not be mixed.

use super::Start;
use crate::settings::Settings;
use cutis_scene::{Environment, Light, Material, Mesh, Scene, Texture};
use glam::Vec2;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Places along a side of a texture that are looked at: an edit that misses all of them is a dot.
const PLACES: u32 = 256;

/// The number of a scene and of the settings that change its samples.
pub fn of(scene: &Scene, settings: &Settings) -> u64 {
    let mut hasher = DefaultHasher::new();
    (settings.width, settings.height, settings.seed).hash(&mut hasher);
    let Scene { lights, camera, background, environment, .. } = scene;
    format!("{lights:?} {camera:?} {background:?}").hash(&mut hasher);
    for light in lights {
        if let Light::Projector(projector) = light {
            hash_texture(&projector.image, &mut hasher);
        }
    }
    if let Some(environment) = environment {
        let Environment { rotation_rad, radiance_scale, visible, .. } = environment;
        format!("{rotation_rad} {radiance_scale:?} {visible}").hash(&mut hasher);
        hash_texture(&environment.map, &mut hasher);
    }
    for object in &scene.objects {
        object.name.hash(&mut hasher);
        hash_material(&object.material, &mut hasher);
        object.mesh.triangles.hash(&mut hasher);
        let Mesh { positions_mm, normals, tangents, uvs, atlas_uvs, .. } = &object.mesh;
        positions_mm.iter().chain(normals).for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
        tangents.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
        uvs.iter()
            .chain(atlas_uvs.iter().flatten())
            .for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    hasher.finish()
}

/// The number of an exitance map of that scene.
pub fn of_map(scene: &Scene, settings: &Settings, start: Start) -> u64 {
    let mut hasher = DefaultHasher::new();
    (of(scene, settings), settings.irradiance_size, format!("{start:?}")).hash(&mut hasher);
    hasher.finish()
}

fn hash_material(material: &Material, hasher: &mut DefaultHasher) {
    let Material { scattering, albedo, albedo_mix, normal, rho_s, roughness, .. } = material;
    format!("{scattering:?} {:?} {albedo_mix}", albedo.factor).hash(hasher);
    albedo.texture.iter().for_each(|texture| hash_texture(texture, hasher));
    if let Some(map) = normal {
        format!("{:?} {}", map.space, map.strength).hash(hasher);
        hash_texture(&map.texture, hasher);
    }
    for map in [rho_s, roughness] {
        format!("{} {}", map.offset, map.gain).hash(hasher);
        map.texture.iter().for_each(|(texture, channel)| {
            channel.hash(hasher);
            hash_texture(texture, hasher);
        });
    }
}

fn hash_texture(texture: &Texture, hasher: &mut DefaultHasher) {
    (texture.width(), texture.height()).hash(hasher);
    for (x, y) in (0..PLACES).flat_map(|y| (0..PLACES).map(move |x| (x, y))) {
        let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / PLACES as f32;
        texture.sample(place).to_array().map(f32::to_bits).hash(hasher);
    }
}
