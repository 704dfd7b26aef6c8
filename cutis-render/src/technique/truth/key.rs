//! A number that tells renderings apart whose samples must not be mixed.

use crate::settings::Settings;
use cutis_scene::Scene;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The number of a scene and of the settings that change its samples. Of textures
/// only their size counts.
pub fn of(scene: &Scene, settings: &Settings) -> u64 {
    let mut hasher = DefaultHasher::new();
    (settings.width, settings.height, settings.seed).hash(&mut hasher);
    let Scene { lights, camera, background, environment, .. } = scene;
    format!("{lights:?} {camera:?} {background:?}").hash(&mut hasher);
    if let Some(environment) = environment {
        let size = (environment.map.width(), environment.map.height());
        format!("{size:?} {} {}", environment.rotation_rad, environment.radiance_scale).hash(&mut hasher);
        let directions =
            [glam::Vec3::X, glam::Vec3::Y, glam::Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        directions.for_each(|dir| format!("{}", environment.radiance(dir)).hash(&mut hasher));
    }
    for object in &scene.objects {
        let material = &object.material;
        let numbers =
            (&material.scattering, material.albedo.factor, material.albedo_mix, material.largest_map());
        format!("{} {numbers:?} {} {}", object.name, material.roughness.offset, material.rho_s.offset)
            .hash(&mut hasher);
        object.mesh.triangles.hash(&mut hasher);
        object.mesh.positions_mm.iter().for_each(|p| p.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    hasher.finish()
}
