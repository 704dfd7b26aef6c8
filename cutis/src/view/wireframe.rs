//! The triangles of the scene over a picture: edges that face the eye and are not hidden.

use cutis_scene::{Camera, Mesh, Pose, Scene};
use eframe::egui::{Color32, ColorImage};
use glam::{Vec2, Vec3};

/// Colour of an edge.
const EDGE: Color32 = Color32::from_rgb(90, 200, 255);
/// How far behind the surface an edge may lie and still be drawn, as a share of its depth: edges lie in it.
const SLACK: f32 = 2e-3;
/// Nearest depth, mm.
const NEAR_MM: f32 = 0.1;

/// Draws the edges of a scene in a pose.
pub fn draw_over(image: &mut ColorImage, scene: &Scene, pose: &Pose, camera: &Camera) {
    let moved =
        (scene.pose() != *pose).then(|| scene.objects.iter().map(|object| object.deformed(pose)).collect());
    let meshes: Vec<Mesh> = moved.unwrap_or_else(|| scene.objects.iter().map(|o| o.mesh.clone()).collect());
    let lens = Lens::new(camera, image.size);
    let mut depths_mm = vec![f32::INFINITY; image.pixels.len()];
    let seen: Vec<Vec<Option<Vec3>>> =
        meshes.iter().map(|mesh| mesh.positions_mm.iter().map(|&p| lens.place(p)).collect()).collect();
    let facing = |places: &[Option<Vec3>], triangle: &[u32; 3]| {
        let corners = triangle.map(|v| places[v as usize]);
        let [Some(a), Some(b), Some(c)] = corners else { return None };
        ((b - a).truncate().perp_dot((c - a).truncate()) < 0.0).then_some([a, b, c])
    };
    let triangles = || {
        let of_object = meshes.iter().zip(&seen);
        of_object.flat_map(|(mesh, places)| mesh.triangles.iter().filter_map(move |t| facing(places, t)))
    };
    triangles().for_each(|corners| fill(corners, image.size, &mut depths_mm));
    for [a, b, c] in triangles() {
        for ends in [[a, b], [b, c], [c, a]] {
            line(ends, image, &depths_mm);
        }
    }
}

/// From the scene to pixels.
struct Lens {
    eye_mm: Vec3,
    /// Unit vectors right, up and forward.
    axes: [Vec3; 3],
    /// Pixels per unit of the tangent of an angle.
    scale: f32,
    middle: Vec2,
}

impl Lens {
    fn new(camera: &Camera, size: [usize; 2]) -> Self {
        let middle = 0.5 * Vec2::new(size[0] as f32, size[1] as f32);
        let scale = middle.y / (0.5 * camera.vertical_fov_rad).tan();
        Self { eye_mm: camera.position_mm, axes: camera.axes(), scale, middle }
    }

    /// Pixel and depth of a point, mm; none behind the eye.
    fn place(&self, point_mm: Vec3) -> Option<Vec3> {
        let [x, y, depth_mm] = self.axes.map(|axis| axis.dot(point_mm - self.eye_mm));
        let place = self.middle + Vec2::new(x, -y) * (self.scale / depth_mm);
        (depth_mm > NEAR_MM).then_some(place.extend(depth_mm))
    }
}

/// Notes the depth of every pixel whose middle lies in a triangle.
fn fill([a, b, c]: [Vec3; 3], size: [usize; 2], depths_mm: &mut [f32]) {
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    let area = (b - a).truncate().perp_dot((c - a).truncate());
    let limit = |x: f32, side: usize| (x.max(0.0) as usize).min(side);
    for y in limit(lo.y, size[1])..limit(hi.y + 1.0, size[1]) {
        for x in limit(lo.x, size[0])..limit(hi.x + 1.0, size[0]) {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let weight =
                |from: Vec3, to: Vec3| (to.truncate() - from.truncate()).perp_dot(p - from.truncate()) / area;
            let (wa, wb, wc) = (weight(b, c), weight(c, a), weight(a, b));
            if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                let depth = &mut depths_mm[y * size[0] + x];
                *depth = depth.min(wa * a.z + wb * b.z + wc * c.z);
            }
        }
    }
}

/// Draws the part of an edge that is in the picture and not hidden.
fn line([a, b]: [Vec3; 2], image: &mut ColorImage, depths_mm: &[f32]) {
    let longest = (b - a).truncate().abs().max_element();
    // An edge much longer than the picture is hardly an edge of anything that is looked at.
    let steps = longest.ceil().clamp(1.0, 4.0 * (image.size[0] + image.size[1]) as f32) as usize;
    for i in 0..=steps {
        let p = a.lerp(b, i as f32 / steps as f32);
        if p.x < 0.0 || p.y < 0.0 || p.x >= image.size[0] as f32 || p.y >= image.size[1] as f32 {
            continue;
        }
        let pixel = p.y as usize * image.size[0] + p.x as usize;
        if p.z <= depths_mm[pixel] * (1.0 + SLACK) {
            image.pixels[pixel] = EDGE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Material, Object};

    /// A triangle in the plane z = `depth`, wound so that it faces +z.
    fn triangle(depth: f32, size: f32) -> Object {
        let mesh = Mesh {
            positions_mm: vec![
                Vec3::new(-size, -size, depth),
                Vec3::new(size, -size, depth),
                Vec3::new(0.0, size, depth),
            ],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        Object::new("triangle", mesh, Material::default())
    }

    fn edges(objects: Vec<Object>, dir_to_camera: Vec3) -> usize {
        let camera = Camera {
            position_mm: dir_to_camera * 100.0,
            look_at_mm: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_rad: 0.5,
            exposure_ev: 0.0,
        };
        let scene = Scene {
            objects,
            lights: Vec::new(),
            environment: None,
            camera,
            background: None,
            warnings: Vec::new(),
        };
        let mut image = ColorImage::filled([64, 64], Color32::BLACK);
        draw_over(&mut image, &scene, &Pose::default(), &camera);
        image.pixels.iter().filter(|&&p| p == EDGE).count()
    }

    #[test]
    fn edges_that_face_the_eye_are_drawn_and_hidden_ones_are_not() {
        let alone = edges(vec![triangle(0.0, 10.0)], Vec3::Z);
        assert!(alone > 60, "{alone}");
        assert_eq!(edges(vec![triangle(0.0, 10.0)], -Vec3::Z), 0, "seen from behind");
        let behind = edges(vec![triangle(0.0, 10.0), triangle(-5.0, 4.0)], Vec3::Z);
        assert_eq!(behind, alone, "a smaller one behind is hidden");
        let before = edges(vec![triangle(0.0, 10.0), triangle(5.0, 4.0)], Vec3::Z);
        assert!(before > alone, "a smaller one before is seen");
    }
}
