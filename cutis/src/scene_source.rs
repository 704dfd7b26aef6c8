//! Where the scene comes from: a file, or the head that ships inside.

use crate::talk;
use cutis_scene::head::{self, HeadDetail};
use cutis_scene::studio::{STUDIO_BACKGROUND, studio_environment, studio_lights};
use cutis_scene::{
    Camera, ColourMap, ColourSpace, Environment, NormalMap, NormalSpace, ReadOptions, ScalarMap, Scattering,
    Scene, SceneError, Texture, read_image, read_scene,
};
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Angle between the upper and the lower edge of a picture of the built-in head, rad: 25°, a portrait lens.
const HEAD_FOV_RAD: f32 = 0.436_332_3;

/// Where the built-in head is seen from: a three-quarter view from the side of the rim light.
const THREE_QUARTER: Vec3 = Vec3::new(0.52, 0.05, 0.85);

/// What is to be read or made.
#[derive(Debug, Clone)]
pub struct SceneSource {
    /// The scene file; none for the built-in head.
    pub file: Option<PathBuf>,
    /// What the command line knows better than the file.
    pub options: ReadOptions,
    /// Map that takes the place of the scene's environment.
    pub environment: Option<PathBuf>,
    /// How fine the built-in head is.
    pub detail: HeadDetail,
    /// Preset that takes the place of every material's own scattering.
    pub material: Option<String>,
    /// Longest side of the box around the scene, mm, to which all of it is scaled.
    pub longest_side_mm: Option<f32>,
    /// How long moving light has moved, s.
    pub time_s: f32,
}

/// Variable that names the folder where atlases that were made are kept; empty: none are.
const CACHE_VARIABLE: &str = "CUTIS_CACHE";

/// Where they are kept: the folder of the variable, or the usual one of the user.
fn cache_folder() -> Option<PathBuf> {
    let given = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if std::env::var_os(CACHE_VARIABLE).is_some() {
        return given(CACHE_VARIABLE);
    }
    let usual = given("XDG_CACHE_HOME").or_else(|| given("LOCALAPPDATA"));
    Some(usual.or_else(|| Some(given("HOME")?.join(".cache")))?.join("cutis"))
}

impl SceneSource {
    /// Reads or makes the scene.
    pub fn load(&self) -> Result<Scene, SceneError> {
        let mut scene = match &self.file {
            Some(path) => {
                let (cache_folder, tell) = (cache_folder(), Some(talk::tell as fn(&str)));
                read_scene(path, &ReadOptions { cache_folder, tell, ..self.options.clone() })?
            }
            None => self.built_in_head()?,
        };
        if let Some(path) = &self.environment {
            scene.environment = Some(Environment {
                map: read(path, ColourSpace::Colour, &mut scene.warnings)?,
                rotation_rad: 0.0,
                radiance_scale: Vec3::ONE,
                visible: true,
            });
        }
        if let Some(material) = &self.material {
            let scattering = Scattering::Preset(material.clone());
            scene.objects.iter_mut().for_each(|object| object.material.replace_tissue(scattering.clone()));
        }
        // A scene of one point has no size that could be scaled.
        if let Some((wanted_mm, now_mm)) = self.longest_side_mm.zip(scene.longest_side_mm())
            && now_mm > 0.0
        {
            scene.scale(wanted_mm / now_mm);
        }
        scene.lights.iter_mut().for_each(|light| *light = light.after(self.time_s));
        Ok(scene)
    }

    /// The built-in head in the studio.
    fn built_in_head(&self) -> Result<Scene, SceneError> {
        let object = head::built_in(self.detail);
        let bounds_mm = object.mesh.bounds_mm().unwrap_or_default();
        let mut scene = Scene {
            objects: vec![object],
            lights: studio_lights(bounds_mm),
            environment: Some(studio_environment()),
            camera: Camera::framing(bounds_mm, THREE_QUARTER, HEAD_FOV_RAD),
            background: Some(STUDIO_BACKGROUND),
            warnings: Vec::new(),
        };
        self.put_on_textures(&mut scene)?;
        Ok(scene)
    }

    /// Textures of the command line on the built-in head; for files the reader does it.
    fn put_on_textures(&self, scene: &mut Scene) -> Result<(), SceneError> {
        let Scene { objects, warnings, .. } = scene;
        let ReadOptions { albedo, normal, specular, .. } = &self.options;
        for material in objects.iter_mut().map(|object| &mut object.material) {
            if let Some(path) = albedo {
                let texture = Some(read(path, ColourSpace::Colour, warnings)?);
                material.albedo = ColourMap { factor: Vec3::ONE, texture };
            }
            if let Some(path) = normal {
                let texture = read(path, ColourSpace::Data, warnings)?;
                material.normal = Some(NormalMap { texture, space: NormalSpace::Tangent, strength: 1.0 });
            }
            if let Some(path) = specular {
                material.rho_s = ScalarMap::measured_rho_s(read(path, ColourSpace::Data, warnings)?);
            }
        }
        Ok(())
    }
}

fn read(path: &Path, space: ColourSpace, warnings: &mut Vec<String>) -> Result<Arc<Texture>, SceneError> {
    read_image(path, space, warnings).map(Arc::new)
}
