//! The pose of a scene on the device, and what depends on where things are then: the lights' maps, the camera's depths.

use super::camera::GpuCamera;
use super::deformable::Deformable;
use super::lights::{GpuLight, grown};
use super::reach::Reach;
use super::relight::are_alike;
use super::shared::{Shared, gpu_lights};
use super::slides::first_texels;
use crate::{Gpu, GpuError};
use cutis_render::prepare::light_view::bounds_mm;
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
    /// The pose that was set last.
    pose: Mutex<Pose>,
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
    /// Uploads the meshes at rest, and the pose they have; the lights' maps have room for what is grown.
    ///
    /// # Errors
    /// If one is larger than the device takes.
    pub fn new(gpu: &Gpu, scene: &Scene, growth_mm: f32) -> Result<Self, GpuError> {
        let mut objects = Vec::new();
        for object in &scene.objects {
            let deformable = Deformable::new(gpu, object.rest())?;
            deformable.write(gpu, &object.pose().on_mesh(object.rest()));
            objects.push(Deforming { deformable, reach: Reach::new(object.rest()) });
        }
        let bounds_mm = scene.bounds_mm().unwrap_or_default();
        Ok(Self {
            objects,
            first: First { pose: scene.pose(), lights: gpu_lights(scene, growth_mm), bounds_mm },
            seen: Mutex::new(Seen { camera: scene.camera, bounds_mm }),
            pose: Mutex::new(scene.pose()),
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
        for (deforming, object) in self.objects.iter().zip(&scene.objects) {
            deforming.deformable.write(gpu, &pose.on_mesh(object.rest()));
        }
        self.pose.lock().unwrap_or_else(PoisonError::into_inner).clone_from(pose);
        let corners = self.corners_mm(scene, pose);
        write_lights(gpu, shared, &laid(scene, shared, &self.first.lights, &corners));
        if let Some(surroundings) = &shared.surroundings {
            surroundings.show(gpu, if corners.is_empty() { &self.first.bounds_mm } else { &corners });
        }
        let around = bounds_mm(corners.iter().copied());
        let seen = {
            let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
            seen.bounds_mm = around.unwrap_or(self.first.bounds_mm);
            *seen
        };
        write_camera(gpu, shared, seen, aspect);
    }

    /// Corners of what the objects may fill in a pose, mm; none in that of the upload, where their vertices are known.
    fn corners_mm(&self, scene: &Scene, pose: &Pose) -> Vec<Vec3> {
        if *pose == self.first.pose {
            return Vec::new();
        }
        let pairs = self.objects.iter().zip(&scene.objects);
        pairs.flat_map(|(own, object)| own.reach.corners_mm(&pose.on_mesh(object.rest()))).collect()
    }

    /// Whether other lights are drawn by the steps of those that were uploaded.
    pub fn is_lit_like(&self, lights: &[GpuLight]) -> bool {
        are_alike(&self.first.lights, lights)
    }

    /// Writes other lights, which are laid over the scene as it was uploaded; over the pose that was set last where that
    /// is another. Tells whether all keep their maps there; nothing has changed where not.
    pub fn set_lights(&mut self, gpu: &Gpu, shared: &Shared, scene: &Scene, lights: Vec<GpuLight>) -> bool {
        let pose = self.pose.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let laid = laid(scene, shared, &lights, &self.corners_mm(scene, &pose));
        if !are_alike(&lights, &laid) {
            return false;
        }
        write_lights(gpu, shared, &laid);
        self.first.lights = lights;
        true
    }

    /// Draws on a picture of other proportions.
    pub fn set_aspect(&self, gpu: &Gpu, shared: &Shared, aspect: f32) {
        write_camera(gpu, shared, *self.seen.lock().unwrap_or_else(PoisonError::into_inner), aspect);
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

/// Lights with their maps laid over some corners; as they are, if there are none.
fn laid(scene: &Scene, shared: &Shared, lights: &[GpuLight], corners_mm: &[Vec3]) -> Vec<GpuLight> {
    if corners_mm.is_empty() {
        return lights.to_vec();
    }
    let shown = || grown(corners_mm.iter().copied(), shared.growth_mm());
    let over = |((light, &layer), slide_first)| GpuLight {
        slide_first,
        ..GpuLight::over_points(light, shown(), layer)
    };
    scene.lights.iter().zip(&shared.layers).zip(first_texels(&scene.lights)).map(over).collect()
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
