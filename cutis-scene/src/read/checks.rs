//! What every mesh must fulfil before it is believed, whatever file it came from.

use crate::{Mesh, SceneError};
use std::path::Path;

/// Most vertices, and most triangles, that a scene may have: about 4 GB of tables in memory.
pub(crate) const MAX_COUNT: usize = 10_000_000;

/// Farthest coordinate, mm: beyond it squared areas overflow single precision.
const MAX_COORDINATE_MM: f32 = 1e9;

/// Farthest texture coordinate: beyond it single precision cannot tell the texels of a large texture apart.
const MAX_UV: f32 = 1e4;

/// Refuses a mesh that breaks the invariants of [`Mesh`]; drops triangles without area and says how many.
pub(crate) fn check_mesh(
    mesh: &mut Mesh,
    file: &Path,
    place: &str,
    warnings: &mut Vec<String>,
) -> Result<(), SceneError> {
    let fail = |reason: String| Err(SceneError::new(file, place, reason));
    if mesh.positions_mm.is_empty() || mesh.triangles.is_empty() {
        return fail("the mesh has no triangles".to_owned());
    }
    let (vertices, triangles) = (mesh.positions_mm.len(), mesh.triangles.len());
    if vertices > MAX_COUNT || triangles > MAX_COUNT {
        return fail(format!("{vertices} vertices and {triangles} triangles; at most {MAX_COUNT} of each"));
    }
    if mesh.uvs.len() != vertices {
        return fail(format!("{vertices} vertices but {} texture coordinates", mesh.uvs.len()));
    }
    if let Some(bad) = mesh.triangles.iter().flatten().find(|&&v| v as usize >= vertices) {
        return fail(format!("a triangle names vertex {bad}, but there are {vertices}"));
    }
    if let Some(v) =
        mesh.positions_mm.iter().position(|p| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE_MM)
    {
        let p = mesh.positions_mm[v];
        return fail(format!("vertex {v} lies at {p} mm; coordinates must be finite and below 1e9 mm"));
    }
    if let Some(v) = mesh.uvs.iter().position(|uv| !uv.is_finite() || uv.abs().max_element() > MAX_UV) {
        let uv = mesh.uvs[v];
        return fail(format!(
            "vertex {v} has texture coordinates {uv}; they must be finite and below {MAX_UV}"
        ));
    }
    drop_degenerate(mesh, place, warnings);
    if mesh.triangles.is_empty() {
        return fail("no triangle of the mesh has an area".to_owned());
    }
    drop_bad_frames(mesh, place, warnings);
    Ok(())
}

/// Takes out triangles without area: they have no normal, and a ray never meets them.
fn drop_degenerate(mesh: &mut Mesh, place: &str, warnings: &mut Vec<String>) {
    let before = mesh.triangles.len();
    let kept = (0..before).filter(|&t| mesh.area_mm2(t) > 0.0).map(|t| mesh.triangles[t]).collect();
    mesh.triangles = kept;
    let dropped = before - mesh.triangles.len();
    if dropped > 0 {
        warnings.push(format!("{place}: {dropped} of {before} triangles have no area and were left out"));
    }
}

/// Forgets normals or tangents of which some are not directions; they are computed instead.
fn drop_bad_frames(mesh: &mut Mesh, place: &str, warnings: &mut Vec<String>) {
    // Files store directions in few digits: a length within a tenth of one is meant as one.
    let unit = |length: f32| (length - 1.0).abs() < 0.1;
    if mesh.normals.iter().any(|n| !unit(n.length())) {
        mesh.normals.clear();
        mesh.tangents.clear();
        warnings
            .push(format!("{place}: some normals are not unit vectors; all were computed from the shape"));
    }
    if mesh.tangents.iter().any(|t| !unit(t.truncate().length())) {
        mesh.tangents.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    fn triangle() -> Mesh {
        Mesh {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: [Vec2::ZERO, Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.5)].to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        }
    }

    #[test]
    fn triangles_without_area_are_dropped_and_counted() {
        let mut mesh = triangle();
        mesh.triangles.push([0, 1, 1]);
        let mut warnings = Vec::new();
        check_mesh(&mut mesh, Path::new("m"), "mesh", &mut warnings).expect("one triangle is left");
        assert_eq!(mesh.triangles.len(), 1);
        assert!(warnings[0].contains("1 of 2 triangles"), "{warnings:?}");
    }
}
