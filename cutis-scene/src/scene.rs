//! The whole of what is there to be drawn.

use crate::pose::{joint_names, morph_names};
use crate::{Camera, Environment, Light, Object, Pose, PoseError};
use glam::Vec3;
use std::collections::BTreeSet;

/// Objects, lights and the camera; nothing about how they are drawn.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Meshes with their materials.
    pub objects: Vec<Object>,
    /// Lights with a direction.
    pub lights: Vec<Light>,
    /// Light from all around.
    pub environment: Option<Environment>,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Radiance behind everything where the environment is not seen, W/(m² sr); none leaves the picture transparent.
    pub background: Option<Vec3>,
    /// Things that were guessed or left out while reading, in words, for the person who runs the program.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Smallest box around all objects, mm. `None` for an empty scene.
    pub fn bounds_mm(&self) -> Option<[Vec3; 2]> {
        bounds_mm(&self.objects)
    }

    /// Puts all objects into a pose.
    ///
    /// # Errors
    /// If it names what no object has, or a number makes no sense; nothing moves then.
    pub fn set_pose(&mut self, pose: &Pose) -> Result<(), PoseError> {
        pose.check(&self.objects)?;
        self.objects.iter_mut().for_each(|object| object.set_pose(pose));
        Ok(())
    }

    /// The pose that all objects have.
    pub fn pose(&self) -> Pose {
        self.objects.first().map(|object| object.pose().clone()).unwrap_or_default()
    }

    /// Names of all morph targets.
    pub fn morph_names(&self) -> BTreeSet<&str> {
        morph_names(&self.objects)
    }

    /// Names of all joints.
    pub fn joint_names(&self) -> BTreeSet<&str> {
        joint_names(&self.objects)
    }
}

/// Smallest box around some objects, mm. `None` if there is nothing in them.
pub(crate) fn bounds_mm(objects: &[Object]) -> Option<[Vec3; 2]> {
    let boxes = objects.iter().filter_map(|object| object.mesh.bounds_mm());
    boxes.reduce(|[lo, hi], [l, h]| [lo.min(l), hi.max(h)])
}
