//! A scene made larger or smaller as a whole.
//!
//! Angles, textures and colours stay, and so does the irradiance of every place: intensities grow with the square of the
//! lengths. Materials stay, too: how far light spreads is theirs, so a smaller body is a more translucent one.

use crate::{Light, Mesh, Object, Pose, Scene, Wave};
use glam::Mat4;
use std::sync::Arc;

impl Scene {
    /// Multiplies all lengths of meshes, poses, lights and camera by a factor. The scene cannot be saved any more: its file
    /// has other lengths.
    ///
    /// # Panics
    /// If the factor is not above 0 and finite.
    pub fn scale(&mut self, factor: f32) {
        assert!(factor > 0.0 && factor.is_finite(), "a scene is scaled by a factor above 0, not {factor}");
        self.objects.iter_mut().for_each(|object| scale_object(object, factor));
        self.lights.iter_mut().for_each(|light| scale_light(light, factor));
        self.camera.position_mm *= factor;
        self.camera.look_at_mm *= factor;
    }

    /// Longest side of the box around all objects, mm. `None` for an empty scene.
    pub fn longest_side_mm(&self) -> Option<f32> {
        self.bounds_mm().map(|[lo, hi]| (hi - lo).max_element())
    }
}

fn scale_object(object: &mut Object, factor: f32) {
    object.source = None;
    scale_mesh(&mut object.mesh, factor);
    if let Some(rest) = &mut object.rest {
        scale_mesh(Arc::make_mut(rest), factor);
    }
    let wave = |wave: Wave| Wave {
        amplitude_mm: wave.amplitude_mm * factor,
        wavelength_mm: wave.wavelength_mm * factor,
        ..wave
    };
    object.pose = Pose { wave: object.pose.wave.map(wave), ..object.pose.clone() };
}

fn scale_mesh(mesh: &mut Mesh, factor: f32) {
    mesh.positions_mm.iter_mut().for_each(|p| *p *= factor);
    let offsets = mesh.morph_targets.iter_mut().flat_map(|target| &mut target.position_offsets_mm);
    offsets.for_each(|offset| *offset *= factor);
    // Axes of joints keep their lengths, which are factors; what moves is where they stand.
    let scale = |matrix: &mut Mat4| {
        let place = matrix.w_axis.truncate() * factor;
        matrix.w_axis = place.extend(matrix.w_axis.w);
    };
    for joint in mesh.skeleton.iter_mut().flat_map(|skeleton| &mut skeleton.joints) {
        scale(&mut joint.parent_from_joint);
        scale(&mut joint.joint_from_bind);
    }
}

fn scale_light(light: &mut Light, factor: f32) {
    match light {
        Light::Directional { .. } => {}
        Light::Point { position_mm, intensity_w_per_sr, radius_mm }
        | Light::Spot { position_mm, intensity_w_per_sr, radius_mm, .. } => {
            *position_mm *= factor;
            *intensity_w_per_sr *= factor * factor;
            *radius_mm *= factor;
        }
        Light::Projector(projector) => {
            projector.position_mm *= factor;
            projector.intensity_w_per_sr *= factor * factor;
            projector.radius_mm *= factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::HeadDetail;
    use crate::studio::head_in_the_studio;
    use glam::Vec3;

    fn head() -> Scene {
        let mut scene = head_in_the_studio(HeadDetail { triangles: 1000, map_size: 0 });
        scene.lights.push(Light::Spot {
            position_mm: Vec3::new(100.0, 300.0, 400.0),
            dir_travel: Vec3::NEG_Z,
            intensity_w_per_sr: Vec3::splat(2.0),
            inner_cone_rad: 1.0,
            outer_cone_rad: 1.2,
            radius_mm: 5.0,
        });
        scene
    }

    #[test]
    fn lengths_are_multiplied_and_light_is_as_strong_as_before() {
        let (before, mut after) = (head(), head());
        let factor = 100.0 / before.longest_side_mm().expect("a head");
        after.scale(factor);
        // A few roundings of a number of 100.
        assert!((after.longest_side_mm().expect("a head") - 100.0).abs() < 1e-4);
        let point_mm = Vec3::new(10.0, 20.0, 70.0);
        for (a, b) in before.lights.iter().zip(&after.lights) {
            let (a, b) = (a.sample(point_mm), b.sample(point_mm * factor));
            let off = (a.irradiance_w_per_m2 - b.irradiance_w_per_m2).abs().max_element();
            assert!(off < 1e-5 * a.irradiance_w_per_m2.max_element(), "{a:?} {b:?}");
            assert!(a.dir_to_light.dot(b.dir_to_light) > 1.0 - 1e-6);
        }
        let seen = |scene: &Scene, point_mm: Vec3| {
            let [right, up, forward] = scene.camera.axes();
            let from_pinhole = point_mm - scene.camera.position_mm;
            Vec3::new(right.dot(from_pinhole), up.dot(from_pinhole), 0.0) / forward.dot(from_pinhole)
        };
        assert!((seen(&before, point_mm) - seen(&after, point_mm * factor)).abs().max_element() < 1e-5);
    }

    #[test]
    fn a_pose_after_scaling_is_the_pose_before_it_scaled() {
        let wave = |factor: f32| Some(Wave::sideways(8.0 * factor, 120.0 * factor, 0.5));
        let pose = |factor| Pose { wave: wave(factor), ..Pose::default() };
        let (mut first, mut second) = (head(), head());
        first.set_pose(&pose(1.0)).expect("a sound pose");
        first.scale(0.25);
        second.scale(0.25);
        second.set_pose(&pose(0.25)).expect("a sound pose");
        assert_eq!(first.pose(), second.pose());
        let pairs = first.objects[0].mesh.positions_mm.iter().zip(&second.objects[0].mesh.positions_mm);
        // 0.25 is exact; sums of mm below 100 round at 8e-6.
        assert!(pairs.clone().all(|(a, b)| (*a - *b).abs().max_element() < 3e-5));
        first.set_pose(&Pose::default()).expect("rest");
        second.set_pose(&Pose::default()).expect("rest");
        assert_eq!(first.objects[0].mesh.positions_mm, second.objects[0].mesh.positions_mm);
    }
}
