//! Closed bodies made by code, with texture coordinates that overlap nowhere, and a flat patch.

use crate::Mesh;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Part of the texture that separates the charts of a box.
const MARGIN: f32 = 0.02;

/// A box in six charts of equal size, three by two.
pub fn cuboid(centre_mm: Vec3, half_mm: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for (i, normal) in [Vec3::Z, Vec3::X, Vec3::Y, -Vec3::Z, -Vec3::X, -Vec3::Y].into_iter().enumerate() {
        let u = Vec3::new(normal.y.abs() + normal.z.abs(), 0.0, normal.x.abs());
        let v = normal.cross(u);
        let cell = Vec2::new((i % 3) as f32 / 3.0, (i / 3) as f32 / 2.0);
        let base = mesh.positions_mm.len() as u32;
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let across = u * (2.0 * s - 1.0) + v * (2.0 * t - 1.0);
            mesh.positions_mm.push(centre_mm + (normal + across) * half_mm);
            mesh.normals.push(normal);
            let within = Vec2::splat(MARGIN) + Vec2::new(s, t) * (Vec2::new(1.0 / 3.0, 0.5) - 2.0 * MARGIN);
            mesh.uvs.push(cell + within);
        }
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    mesh
}

/// A rectangle in the plane z = 0, cut into `cells`² quads, over the whole texture but for a margin, which is a share of it.
/// The axes say where a share of the texture lies, mm; both grow, v downwards.
pub fn patch(cells: u32, margin: f64, along_u: impl Fn(f64) -> f64, along_v: impl Fn(f64) -> f64) -> Mesh {
    let place = |i: u32| margin + (1.0 - 2.0 * margin) * f64::from(i) / f64::from(cells);
    let mut mesh = Mesh::default();
    for (j, i) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (j, i))) {
        let (u, v) = (place(i), place(j));
        mesh.positions_mm.push(Vec3::new(along_u(u) as f32, -along_v(v) as f32, 0.0));
        mesh.uvs.push(Vec2::new(u as f32, v as f32));
    }
    let row = cells + 1;
    for a in (0..cells).flat_map(|j| (0..cells).map(move |i| j * row + i)) {
        mesh.triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
    }
    mesh
}

/// A ball pulled along y by `half_length_mm` to both sides; 0 leaves it a ball. One chart, its seam towards -z and its
/// poles up and down.
pub fn capsule(centre_mm: Vec3, radius_mm: f32, half_length_mm: f32, segments: u32) -> Mesh {
    let outline = outline(radius_mm, half_length_mm, segments / 4);
    let length_mm = outline.last().map_or(1.0, |ring| ring.way_mm);
    let mut mesh = Mesh::default();
    for ring in &outline {
        for j in 0..=segments {
            let turn = j as f32 / segments as f32;
            // The last column stands where the first does, to the bit.
            let (sin, cos) = (TAU * (j % segments) as f32 / segments as f32).sin_cos();
            let around = Vec3::new(-sin, 0.0, -cos);
            mesh.positions_mm.push(centre_mm + around * ring.radius_mm + Vec3::Y * ring.height_mm);
            mesh.normals.push((around * ring.normal.x + Vec3::Y * ring.normal.y).normalize());
            mesh.uvs.push(Vec2::new(turn, ring.way_mm / length_mm));
        }
    }
    let row = segments + 1;
    let rings = outline.len() as u32 - 1;
    for (i, j) in (0..rings).flat_map(|i| (0..segments).map(move |j| (i, j))) {
        let a = i * row + j;
        // At the poles one of the two triangles has no area.
        if i > 0 {
            mesh.triangles.push([a, a + row, a + 1]);
        }
        if i + 1 < rings {
            mesh.triangles.push([a + 1, a + row, a + row + 1]);
        }
    }
    mesh
}

/// A circle of a capsule's surface.
struct Ring {
    radius_mm: f32,
    height_mm: f32,
    /// Outwards and upwards.
    normal: Vec2,
    /// Along the surface from the upper pole.
    way_mm: f32,
}

fn outline(radius_mm: f32, half_length_mm: f32, quarter: u32) -> Vec<Ring> {
    let cap = |i: u32, up: f32, way_mm: f32| {
        let polar = FRAC_PI_2 * i as f32 / quarter as f32;
        let radius = if i == 0 { 0.0 } else { polar.sin() };
        let normal = Vec2::new(radius, up * if i == quarter { 0.0 } else { polar.cos() });
        Ring {
            radius_mm: radius_mm * normal.x,
            height_mm: up * half_length_mm + radius_mm * normal.y,
            normal,
            way_mm,
        }
    };
    let arc_mm = radius_mm * FRAC_PI_2;
    let along = |i: u32| arc_mm * i as f32 / quarter as f32;
    let upper = (0..=quarter).map(|i| cap(i, 1.0, along(i)));
    // Of a ball the equator is there already.
    let from = if half_length_mm > 0.0 { quarter } else { quarter - 1 };
    let whole_mm = 2.0 * (arc_mm + half_length_mm);
    upper.chain((0..=from).rev().map(|i| cap(i, -1.0, whole_mm - along(i)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, Object};
    use std::f32::consts::PI;

    fn volume_mm3(mesh: &Mesh) -> f32 {
        let of = |t| {
            let [a, b, c] = mesh.corners_mm(t);
            a.dot(b.cross(c)) / 6.0
        };
        (0..mesh.triangles.len()).map(of).sum()
    }

    #[test]
    fn they_are_closed_and_as_large_as_they_say() {
        let ball = 4.0 / 3.0 * PI * 27.0;
        let cases = [
            (cuboid(Vec3::new(3.0, -5.0, 1.0), Vec3::new(1.0, 2.0, 3.0)), 48.0, 1e-5),
            // An inscribed polygon of 64 corners has 0.16 % less area than its circle, twice over here.
            (capsule(Vec3::ONE, 3.0, 0.0, 64), ball, 5e-3),
            (capsule(Vec3::ONE, 3.0, 4.0, 64), ball + 9.0 * PI * 8.0, 5e-3),
        ];
        for (mesh, expected, tolerance) in cases {
            let volume = volume_mm3(&mesh);
            assert!((volume / expected - 1.0).abs() < tolerance, "{volume} for {expected}");
            assert!(Object::new("body", mesh, Material::default()).closed);
        }
    }

    #[test]
    fn normals_point_out() {
        for mesh in [cuboid(Vec3::ZERO, Vec3::ONE), capsule(Vec3::ZERO, 1.0, 1.0, 16)] {
            let out = mesh.positions_mm.iter().zip(&mesh.normals).all(|(p, n)| p.dot(*n) > 0.0);
            assert!(out && mesh.normals.iter().all(|n| n.is_normalized()));
        }
    }
}
