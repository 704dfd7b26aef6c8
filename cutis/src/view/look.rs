//! Everything that can be changed while looking: plain numbers, relative to the scene as it was read.

use super::painter::Developing;
use super::shown::Shown;
use crate::backend::Backend;
use crate::techniques::take_own;
use cutis_render::film::Film;
use cutis_render::prepare::kernel::stretched;
use cutis_render::settings::{Quality, TechniqueSettings};
use cutis_render::{Diffusion, RenderError, Settings, TechniqueName};
use cutis_scene::{Camera, Environment, Light, Material, Pose, PoseError, ScalarMap, Scattering, Scene};
use glam::{Quat, Vec3};

/// How a scene is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// From where; its exposure is part of the film.
    pub camera: Camera,
    /// In which light.
    pub lights: Vec<LightLook>,
    /// How long the lights have moved, s.
    pub time_s: f32,
    /// In which surroundings.
    pub surroundings: Surroundings,
    /// In which pose.
    pub pose: Pose,
    /// Of which material.
    pub skin: SkinLook,
    /// By which method.
    pub drawing: Drawing,
    /// On which film.
    pub film: Film,
}

/// One light, relative to the scene's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightLook {
    /// Whether it shines.
    pub on: bool,
    /// Factor on its power.
    pub strength: f32,
    /// Turn about the vertical axis through the middle of the scene, degrees.
    pub turn_degrees: f32,
    /// Turn upwards, degrees.
    pub lift_degrees: f32,
    /// Factor on its extent.
    pub extent: f32,
}

/// Light from all around, relative to the scene's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Factor on its radiance.
    pub strength: f32,
    /// Turn about the vertical axis, degrees.
    pub turn_degrees: f32,
    /// Whether it is seen behind the scene.
    pub visible: bool,
}

/// The material of all objects, relative to their own.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinLook {
    /// A preset in place of the scene's own scattering.
    pub preset: Option<String>,
    /// Factor on the mean free path of red, green and blue.
    pub free_path: [f32; 3],
    /// Factor on the roughness.
    pub roughness: f32,
    /// Factor on the specular intensity rho_s.
    pub oiliness: f32,
    /// Share of the albedo that filters light on its way in.
    pub albedo_mix: f32,
    /// Factor on the relief of the normal map.
    pub relief: f32,
    /// Factor on distances through the body.
    pub thickness: f32,
}

/// How it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Method.
    pub technique: TechniqueName,
    /// Numbers of each technique of its own; they stay while another one draws.
    pub techniques: TechniqueSettings,
    /// How light spreads.
    pub diffusion: Diffusion,
    /// Where it is computed.
    pub backend: Backend,
    /// How much work it is worth.
    pub quality: Quality,
    /// Width and height of the irradiance texture, texels.
    pub irradiance_size: u32,
    /// Gaussians of a material that is given by its coefficients.
    pub gaussians: usize,
    /// Numbers of the Gaussians that are left out.
    pub muted_gaussians: Vec<usize>,
}

impl Drawing {
    /// Whether the same is drawn: numbers of techniques that do not draw are no matter.
    fn is_like(&self, other: &Self) -> bool {
        let mut techniques = self.techniques.clone();
        take_own(&mut techniques, &other.techniques, self.technique);
        let others = Self { techniques: other.techniques.clone(), ..self.clone() };
        techniques == self.techniques && others == *other
    }

    /// Chooses a quality, with the texture that belongs to it; `auto` is what the window begins with.
    pub fn set_quality(&mut self, quality: Quality) {
        self.quality = quality;
        self.irradiance_size = match quality {
            Quality::Auto => Self::default().irradiance_size,
            _ => Settings::default().with_quality(quality).irradiance_size,
        };
    }
}

/// Factors that change nothing.
impl Default for LightLook {
    fn default() -> Self {
        Self { on: true, strength: 1.0, turn_degrees: 0.0, lift_degrees: 0.0, extent: 1.0 }
    }
}

impl Look {
    /// The scene as it was read.
    pub fn of(scene: &Scene, drawing: Drawing) -> Self {
        let exposure_ev = scene.camera.exposure_ev;
        Self {
            camera: scene.camera,
            lights: vec![LightLook::default(); scene.lights.len()],
            time_s: 0.0,
            surroundings: Surroundings {
                strength: 1.0,
                turn_degrees: 0.0,
                visible: scene.environment.as_ref().is_some_and(|e| e.visible),
            },
            pose: scene.pose(),
            skin: SkinLook::of(scene.objects.first().map(|o| &o.material)),
            drawing,
            film: Film { exposure_ev, ..Film::default() },
        }
    }

    /// The scene as it is looked at.
    ///
    /// # Errors
    /// If it cannot take the pose.
    pub fn applied_to(&self, scene: &Scene) -> Result<Scene, RenderError> {
        let mut scene = scene.clone();
        let (lights, environment) = (self.lights_of(&scene), self.environment_of(&scene));
        if scene.pose() != self.pose {
            scene.set_pose(&self.pose).map_err(|error| bad_pose(&error))?;
        }
        scene.camera = self.camera;
        (scene.lights, scene.environment) = (lights, environment);
        scene.objects.iter_mut().for_each(|object| self.skin.apply_to(&mut object.material));
        Ok(scene)
    }

    /// The lights of a scene, as it was read, as they are looked at. They turn about its middle and do not follow a pose.
    pub fn lights_of(&self, scene: &Scene) -> Vec<Light> {
        let middle_mm = scene.bounds_mm().map_or(Vec3::ZERO, |[lo, hi]| 0.5 * (lo + hi));
        let pairs = scene.lights.iter().zip(&self.lights);
        pairs
            .filter(|(_, look)| look.on && look.strength > 0.0)
            .map(|(light, look)| look.applied_to(&light.after(self.time_s), middle_mm))
            .collect()
    }

    /// The environment of a scene as it is looked at; none if it does not shine, so that nobody asks what is open to it.
    pub fn environment_of(&self, scene: &Scene) -> Option<Environment> {
        let mut environment = scene.environment.clone().filter(|_| self.surroundings.strength > 0.0)?;
        environment.radiance_scale *= self.surroundings.strength;
        environment.rotation_rad += self.surroundings.turn_degrees.to_radians();
        environment.visible = self.surroundings.visible;
        Some(environment)
    }

    /// Whether everything but the film is the same, so that the frame need not be drawn anew.
    pub fn is_drawn_like(&self, other: &Self) -> bool {
        self.camera == other.camera && self.is_lit_like(other)
    }

    /// How an image is made of a frame.
    pub fn developing(&self, shown: Shown) -> Developing {
        Developing { film: self.film, shown, pose: self.pose.clone() }
    }

    /// Whether everything but camera and film is the same, so that light need not be gathered anew.
    pub fn is_lit_like(&self, other: &Self) -> bool {
        self.lights == other.lights
            && self.time_s == other.time_s
            && self.surroundings == other.surroundings
            && self.pose == other.pose
            && self.skin == other.skin
            && self.drawing.is_like(&other.drawing)
    }
}

/// A pose that a scene cannot take.
pub fn bad_pose(error: &PoseError) -> RenderError {
    RenderError::BadBody { object: "the whole scene".to_owned(), reason: error.to_string() }
}

impl LightLook {
    fn applied_to(&self, light: &Light, middle_mm: Vec3) -> Light {
        let mut light = light.clone();
        let turned = |dir: Vec3| self.turned(dir);
        let moved = |position_mm: &mut Vec3| *position_mm = middle_mm + turned(*position_mm - middle_mm);
        match &mut light {
            Light::Directional { dir_to_light, irradiance_w_per_m2, angular_radius_rad } => {
                *dir_to_light = turned(*dir_to_light);
                *irradiance_w_per_m2 *= self.strength;
                *angular_radius_rad *= self.extent;
            }
            Light::Point { position_mm, intensity_w_per_sr, radius_mm } => {
                moved(position_mm);
                *intensity_w_per_sr *= self.strength;
                *radius_mm *= self.extent;
            }
            Light::Spot { position_mm, dir_travel, intensity_w_per_sr, radius_mm, .. } => {
                moved(position_mm);
                *dir_travel = turned(*dir_travel);
                *intensity_w_per_sr *= self.strength;
                *radius_mm *= self.extent;
            }
            Light::Projector(projector) => {
                moved(&mut projector.position_mm);
                projector.intensity_w_per_sr *= self.strength;
                projector.radius_mm *= self.extent;
                projector.axes = projector.axes.map(turned);
            }
        }
        light
    }

    /// A direction from the middle of the scene, turned about the vertical axis and lifted.
    fn turned(&self, dir: Vec3) -> Vec3 {
        let around = Quat::from_rotation_y(self.turn_degrees.to_radians()) * dir;
        let aside = around.cross(Vec3::Y).normalize_or(Vec3::X);
        Quat::from_axis_angle(aside, self.lift_degrees.to_radians()) * around
    }
}

impl SkinLook {
    fn of(material: Option<&Material>) -> Self {
        Self {
            preset: None,
            free_path: [1.0; 3],
            roughness: 1.0,
            oiliness: 1.0,
            albedo_mix: material.map_or(0.5, |m| m.albedo_mix),
            relief: 1.0,
            thickness: 1.0,
        }
    }

    /// Changes a material.
    pub fn apply_to(&self, material: &mut Material) {
        if let Some(preset) = &self.preset {
            material.replace_tissue(Scattering::Preset(preset.clone()));
        }
        if self.free_path != [1.0; 3] {
            let second = material.mixed_with.as_mut().map(|second| &mut second.scattering);
            for scattering in std::iter::once(&mut material.scattering).chain(second) {
                *scattering = stretched(scattering, self.free_path.map(f64::from));
            }
        }
        scale(&mut material.roughness, self.roughness);
        scale(&mut material.rho_s, self.oiliness);
        material.albedo_mix = self.albedo_mix;
        material.thickness_scale *= self.thickness;
        if let Some(normal) = &mut material.normal {
            normal.strength *= self.relief;
        }
    }
}

fn scale(map: &mut ScalarMap, factor: f32) {
    map.offset *= factor;
    map.gain *= factor;
}
