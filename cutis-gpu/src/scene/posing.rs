//! The pose of a scene on the device, and what depends on where things are then: the lights' maps, the camera's depths.

use super::camera::GpuCamera;
use super::deformable::Deformable;
use super::lights::{GpuLight, bounds_mm};
use super::reach::Reach;
use super::shared::{Shared, gpu_lights};
use crate::{Gpu, GpuError};
use cutis_scene::{Camera, Pose, Scene};
use glam::Vec3;
use std::sync::{Mutex, PoisonError};

/// What deforms the objects of a scene.
#[derive(Debug)]
pub struct Posing {
    objects: Vec<Deforming>,
    /// How the scene was uploaded.
    first: First,
    seen: Mutex<Seen>,
}

#[derive(Debug)]
struct Deforming {
    deformable: Deformable,
    reach: Reach,
}

/// The scene as it was uploaded: its lights are laid over its vertices themselves, which is tighter than any box.
#[derive(Debug)]
struct First {
    pose: Pose,
    lights: Vec<GpuLight>,
    bounds_mm: [Vec3; 2],
}

/// What the camera's depths follow from.
#[derive(Debug, Clone, Copy)]
struct Seen {
    camera: Camera,
    bounds_mm: [Vec3; 2],
}

impl Posing {
    /// Uploads the meshes at rest, and the pose they have.
    ///
    /// # Errors
    /// If one is larger than the device takes.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let mut objects = Vec::new();
        for object in &scene.objects {
            let deformable = Deformable::new(gpu, object.rest())?;
            deformable.write(gpu, &object.pose().on_mesh(object.rest()));
            objects.push(Deforming { deformable, reach: Reach::new(object.rest()) });
        }
        let bounds_mm = scene.bounds_mm().unwrap_or_default();
        Ok(Self {
            objects,
            first: First { pose: scene.pose(), lights: gpu_lights(scene), bounds_mm },
            seen: Mutex::new(Seen { camera: scene.camera, bounds_mm }),
        })
    }

    /// What deforms object number `number`.
    pub fn deformable(&self, number: u32) -> &Deformable {
        &self.objects[number as usize].deformable
    }

    /// Writes a pose that was checked, and what follows from it.
    ///
    /// # Panics
    /// If the scene is another one.
    pub fn set_pose(&self, gpu: &Gpu, shared: &Shared, scene: &Scene, pose: &Pose, aspect: f32) {
        assert_eq!(scene.objects.len(), self.objects.len(), "the scene is the one that was uploaded");
        let mut corners = Vec::new();
        for (deforming, object) in self.objects.iter().zip(&scene.objects) {
            let on_mesh = pose.on_mesh(object.rest());
            deforming.deformable.write(gpu, &on_mesh);
            corners.extend(deforming.reach.corners_mm(&on_mesh));
        }
        let as_uploaded = *pose == self.first.pose;
        if as_uploaded {
            write_lights(gpu, shared, &self.first.lights);
        } else {
            let pairs = scene.lights.iter().zip(&shared.layers);
            let lights: Vec<_> = pairs
                .map(|(light, &layer)| GpuLight::over_points(light, corners.iter().copied(), layer))
                .collect();
            write_lights(gpu, shared, &lights);
        }
        if let Some(surroundings) = &shared.surroundings {
            surroundings.show(gpu, if as_uploaded { &self.first.bounds_mm } else { &corners });
        }
        let around = if as_uploaded { None } else { bounds_mm(corners.iter().copied()) };
        let seen = {
            let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
            seen.bounds_mm = around.unwrap_or(self.first.bounds_mm);
            *seen
        };
        write_camera(gpu, shared, seen, aspect);
    }

    /// Moves the camera.
    pub fn set_camera(&self, gpu: &Gpu, shared: &Shared, camera: &Camera, aspect: f32) {
        let seen = {
            let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
            seen.camera = *camera;
            *seen
        };
        write_camera(gpu, shared, seen, aspect);
    }
}

fn write_lights(gpu: &Gpu, shared: &Shared, lights: &[GpuLight]) {
    if !lights.is_empty() {
        gpu.queue.write_buffer(&shared.lights, 0, bytemuck::cast_slice(lights));
    }
}

fn write_camera(gpu: &Gpu, shared: &Shared, seen: Seen, aspect: f32) {
    let numbers = GpuCamera::new(&seen.camera, seen.bounds_mm, aspect);
    gpu.queue.write_buffer(&shared.camera, 0, bytemuck::bytes_of(&numbers));
}
