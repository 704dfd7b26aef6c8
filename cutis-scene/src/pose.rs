//! How a scene is deformed: shapes, joints, and a wave that runs through everything.
//!
//! The wave displaces a point p along one direction by `amplitude sin(2π travel·p / wavelength + phase)`. d'Eon, Luebke &
//! Enderton 2007, section 6, deform a head by "a simple procedural wave" (figure 10) and give no formula; this one is ours.
//! Its derivative is the identity plus a dyad, so normals and tangents follow exactly.

use crate::{Mesh, Object};
use glam::{EulerRot, Mat4, Quat, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::TAU;

/// What differs from the scene at rest. Shapes and joints are known by their names in the mesh file; one that several meshes
/// share moves all of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pose {
    /// Weights of morph targets; the others keep the weight their file gives them.
    pub morph_weights: BTreeMap<String, f32>,
    /// Turns of joints in their own axes at rest, first about x, then about y, then about z, degrees.
    pub joint_degrees: BTreeMap<String, Vec3>,
    /// Goes through all meshes, after shapes and joints.
    pub wave: Option<Wave>,
}

/// A transverse wave, or one that is not steep enough to fold the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Largest displacement, mm.
    pub amplitude_mm: f32,
    /// Distance from crest to crest along `travel`, mm.
    pub wavelength_mm: f32,
    /// Phase at the origin, rad; one that falls in time moves the crests along `travel`.
    pub phase_rad: f32,
    /// Unit vector along which points are displaced.
    pub direction: Vec3,
    /// Unit vector along which crests follow each other.
    pub travel: Vec3,
}

/// A pose that the scene cannot take.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// Nothing in the scene has this name.
    #[error("there is no {what} `{name}`; {}", known_words(known))]
    Unknown {
        /// `morph target` or `joint`.
        what: &'static str,
        /// The name.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// A number is not one, or makes no sense.
    #[error("{what} must be {wanted}, got {value}")]
    Number {
        /// Which one.
        what: String,
        /// What would do.
        wanted: &'static str,
        /// What it is.
        value: f32,
    },
    /// The surface would pass through itself.
    #[error(
        "the wave folds the surface: where direction and travel are not perpendicular, 2 pi amplitude / wavelength \
         times their cosine must stay below 1, got {steepness}"
    )]
    Folds {
        /// The product that is too large.
        steepness: f32,
    },
}

/// A pose as one mesh takes it: by number instead of by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshPose {
    /// Weight of every morph target.
    pub morph_weights: Vec<f32>,
    /// Matrix of every joint at rest and in the pose ([`crate::Skeleton::matrices`]); empty if none is turned.
    pub joints: Vec<[Mat4; 2]>,
    /// The wave.
    pub wave: Option<Wave>,
}

impl Wave {
    /// Sideways, with crests above each other.
    pub fn sideways(amplitude_mm: f32, wavelength_mm: f32, phase_rad: f32) -> Self {
        Self { amplitude_mm, wavelength_mm, phase_rad, direction: Vec3::X, travel: Vec3::Y }
    }

    /// Displacement along [`Wave::direction`] of a point, mm, and how fast that changes along [`Wave::travel`], mm per mm.
    pub fn at(&self, point_mm: Vec3) -> (f32, f32) {
        let turns = self.travel.dot(point_mm) / self.wavelength_mm + self.phase_rad / TAU;
        // Sines of large numbers are worth little on graphics processors: whole turns are left out.
        let (sin, cos) = (TAU * (turns - (turns + 0.5).floor())).sin_cos();
        (self.amplitude_mm * sin, self.amplitude_mm * TAU / self.wavelength_mm * cos)
    }

    /// Above 1 the surface would fold.
    fn steepness(&self) -> f32 {
        (self.direction.dot(self.travel) * self.amplitude_mm * TAU / self.wavelength_mm).abs()
    }

    fn check(&self) -> Result<(), PoseError> {
        let number = |what: &str, wanted, value, fits: bool| match fits {
            true => Ok(()),
            false => Err(PoseError::Number { what: format!("the wave's {what}"), wanted, value }),
        };
        let finite = "finite, up to 1e6";
        number("amplitude_mm", finite, self.amplitude_mm, self.amplitude_mm.abs() <= 1e6)?;
        // Shorter ones turn by the rounding of a coordinate.
        let range = "0.01 to 1e6";
        number("wavelength_mm", range, self.wavelength_mm, (0.01..=1e6).contains(&self.wavelength_mm))?;
        number("phase_rad", finite, self.phase_rad, self.phase_rad.abs() <= 1e6)?;
        for (what, vector) in [("direction", self.direction), ("travel", self.travel)] {
            let length = vector.length();
            number(what, "a unit vector, of length 1", length, (length - 1.0).abs() < 1e-4)?;
        }
        let steepness = self.steepness();
        if steepness < 1.0 { Ok(()) } else { Err(PoseError::Folds { steepness }) }
    }
}

impl Pose {
    /// Whether nothing is asked for: shapes, joints and all as the files leave them.
    pub fn is_rest(&self) -> bool {
        *self == Self::default()
    }

    /// The rotation of a joint.
    pub fn turn(&self, joint: &str) -> Quat {
        let turn = |degrees: &Vec3| {
            let Vec3 { x, y, z } = degrees.map(f32::to_radians);
            Quat::from_euler(EulerRot::ZYX, z, y, x)
        };
        self.joint_degrees.get(joint).map_or(Quat::IDENTITY, turn)
    }

    /// What it means for a mesh at rest.
    pub fn on_mesh(&self, rest: &Mesh) -> MeshPose {
        let weight = |target: &crate::MorphTarget| {
            self.morph_weights.get(&target.name).copied().unwrap_or(target.weight)
        };
        let skeleton = rest.skeleton.as_ref();
        let turned = skeleton
            .filter(|skeleton| skeleton.joints.iter().any(|joint| self.turn(&joint.name) != Quat::IDENTITY));
        let matrices = |skeleton: &crate::Skeleton| {
            let posed = skeleton.matrices(|j| self.turn(&skeleton.joints[j].name));
            skeleton.rest_matrices().into_iter().zip(posed).map(|(rest, posed)| [rest, posed]).collect()
        };
        MeshPose {
            morph_weights: rest.morph_targets.iter().map(weight).collect(),
            joints: turned.map(matrices).unwrap_or_default(),
            wave: self.wave.filter(|wave| wave.amplitude_mm != 0.0),
        }
    }

    /// Refuses names that no object has, and numbers that deform into nothing.
    pub fn check(&self, objects: &[Object]) -> Result<(), PoseError> {
        let unknown = |what, names: BTreeSet<&str>, name: &str| {
            let known = names.into_iter().map(str::to_owned).collect();
            Err(PoseError::Unknown { what, name: name.to_owned(), known })
        };
        let number = |name: &str, value: f32, wanted| {
            Err(PoseError::Number { what: format!("`{name}`"), wanted, value })
        };
        for (name, &weight) in &self.morph_weights {
            match morph_names(objects) {
                names if !names.contains(name.as_str()) => return unknown("morph target", names, name),
                _ if !(-100.0..=100.0).contains(&weight) => return number(name, weight, "-100 to 100"),
                _ => {}
            }
        }
        for (name, degrees) in &self.joint_degrees {
            let largest = degrees.abs().max_element();
            match joint_names(objects) {
                names if !names.contains(name.as_str()) => return unknown("joint", names, name),
                // Also refuses NaN, which is in no range; the maximum of a vector may lose it.
                _ if !(degrees.is_finite() && largest <= 3600.0) => {
                    return number(name, largest, "-3600 to 3600 degrees");
                }
                _ => {}
            }
        }
        self.wave.as_ref().map_or(Ok(()), Wave::check)
    }
}

impl MeshPose {
    /// Whether the mesh stays as it rests.
    pub fn is_rest(&self) -> bool {
        self.joints.is_empty() && self.wave.is_none() && self.morph_weights.iter().all(|&w| w == 0.0)
    }
}

/// Names of all morph targets.
pub fn morph_names(objects: &[Object]) -> BTreeSet<&str> {
    objects.iter().flat_map(|object| &object.rest().morph_targets).map(|t| t.name.as_str()).collect()
}

/// Names of all joints.
pub fn joint_names(objects: &[Object]) -> BTreeSet<&str> {
    let skeletons = objects.iter().filter_map(|object| object.rest().skeleton.as_ref());
    skeletons.flat_map(|skeleton| &skeleton.joints).map(|joint| joint.name.as_str()).collect()
}

/// The names that would have done.
fn known_words(known: &[String]) -> String {
    /// More would hide the rest of the message.
    const SHOWN: usize = 40;
    match known.len() {
        0 => "the scene has none".to_owned(),
        n if n > SHOWN => format!("there are {n}, such as {}", known[..SHOWN].join(", ")),
        _ => format!("known here: {}", known.join(", ")),
    }
}
