//! What every mesh must fulfil before it is believed, whatever file it came from, and what is said about it.

use crate::charts::Charts;
use crate::topology::weld;
use crate::{Mesh, SceneError};
use glam::Vec2;
use std::path::Path;

/// Most vertices, and most triangles, that a scene may have: about 4 GB of tables in memory.
pub(crate) const MAX_COUNT: usize = 10_000_000;

/// Farthest coordinate, mm: beyond it squared areas overflow single precision.
const MAX_COORDINATE_MM: f32 = 1e9;

/// Farthest texture coordinate: beyond it single precision cannot tell the texels of a large texture apart.
const MAX_UV: f32 = 1e4;

/// Grid on which overlap is counted: fine enough for half a percent of a used texture.
const OVERLAP_GRID: u32 = 512;

/// Overlap below this is the rounding of an atlas packer.
const MAX_OVERLAP_FRACTION: f32 = 0.005;

/// Sum of the triangles' boxes in the texture, in unit squares, up to which the overlap is counted. Honest atlases
/// stay near 3; far above it, counting would take forever and the answer is known.
const MAX_BOX_SUM: f32 = 64.0;

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

/// Moves charts that lie in another tile of the plane back into the unit square. Textures repeat, so nothing changes
/// in the picture; but maps that are drawn in texture space only have the one square.
pub(crate) fn wrap_charts(mesh: &mut Mesh, place: &str, warnings: &mut Vec<String>) {
    if Charts::inside_unit_square(mesh) {
        return;
    }
    let charts = Charts::find(mesh, &weld(&mesh.positions_mm));
    let mut least = vec![Vec2::splat(f32::INFINITY); charts.count as usize];
    for (t, &chart) in charts.of_triangle.iter().enumerate() {
        let corner = mesh.corner_uvs(t).into_iter().reduce(Vec2::min).unwrap_or_default();
        least[chart as usize] = least[chart as usize].min(corner);
    }
    let mut shift: Vec<Option<Vec2>> = vec![None; mesh.uvs.len()];
    for (triangle, &chart) in mesh.triangles.iter().zip(&charts.of_triangle) {
        // The slack of `inside_unit_square`: a chart that begins a hair below its tile belongs to the tile.
        let tile = (least[chart as usize] + 1e-4).floor();
        for &v in triangle {
            if *shift[v as usize].get_or_insert(tile) != tile {
                return; // two charts share a vertex and want different tiles: leave the mesh as it is
            }
        }
    }
    for (uv, tile) in mesh.uvs.iter_mut().zip(shift) {
        *uv -= tile.unwrap_or_default();
    }
    if Charts::inside_unit_square(mesh) {
        warnings.push(format!("{place}: texture charts outside the unit square were moved back into it"));
    }
}

/// Says in words where the texture cannot carry a map of the surface one to one.
pub(crate) fn troubles_of_charts(mesh: &Mesh) -> Vec<String> {
    let mut troubles = Vec::new();
    if !Charts::inside_unit_square(mesh) {
        troubles.push(
            "texture coordinates leave the unit square, so parts of the surface share texels".to_owned(),
        );
    }
    if box_sum(mesh) > MAX_BOX_SUM {
        troubles.push("the texture is used many times over".to_owned());
        return troubles;
    }
    let overlap = Charts::overlap_fraction(mesh, OVERLAP_GRID);
    if overlap > MAX_OVERLAP_FRACTION {
        troubles.push(format!(
            "{:.1} % of the used texture belongs to more than one place of the surface",
            100.0 * overlap
        ));
    }
    troubles
}

/// Sum of the areas of the triangles' boxes inside the unit square.
fn box_sum(mesh: &Mesh) -> f32 {
    let area = |t: usize| {
        let uvs = mesh.corner_uvs(t).map(|uv| uv.clamp(Vec2::ZERO, Vec2::ONE));
        let size = uvs[0].max(uvs[1]).max(uvs[2]) - uvs[0].min(uvs[1]).min(uvs[2]);
        size.x * size.y
    };
    (0..mesh.triangles.len()).map(area).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn triangle(shift: Vec2) -> Mesh {
        Mesh {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: [Vec2::ZERO, Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.5)].map(|uv| uv + shift).to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        }
    }

    #[test]
    fn triangles_without_area_are_dropped_and_counted() {
        let mut mesh = triangle(Vec2::ZERO);
        mesh.triangles.push([0, 1, 1]);
        let mut warnings = Vec::new();
        check_mesh(&mut mesh, Path::new("m"), "mesh", &mut warnings).expect("one triangle is left");
        assert_eq!(mesh.triangles.len(), 1);
        assert!(warnings[0].contains("1 of 2 triangles"), "{warnings:?}");
    }

    #[test]
    fn a_chart_in_another_tile_comes_back() {
        let mut mesh = triangle(Vec2::new(3.0, -2.0));
        let mut warnings = Vec::new();
        wrap_charts(&mut mesh, "mesh", &mut warnings);
        assert_eq!(mesh.uvs, triangle(Vec2::ZERO).uvs);
        assert_eq!(warnings.len(), 1);
    }

    #[test]
    fn a_triangle_used_twice_is_an_overlap() {
        let mut mesh = triangle(Vec2::ZERO);
        let mut warnings = Vec::new();
        warnings.extend(troubles_of_charts(&mesh));
        assert!(warnings.is_empty(), "{warnings:?}");
        mesh.triangles.push([0, 1, 2]);
        warnings.extend(troubles_of_charts(&mesh));
        assert!(warnings[0].contains("100.0 %"), "{warnings:?}");
    }

    #[test]
    fn a_texture_used_a_thousand_times_is_not_counted_out() {
        let mut mesh = triangle(Vec2::ZERO);
        mesh.triangles = vec![[0, 1, 2]; 1000];
        let mut warnings = Vec::new();
        warnings.extend(troubles_of_charts(&mesh));
        assert!(warnings[0].contains("many times over"), "{warnings:?}");
    }
}
