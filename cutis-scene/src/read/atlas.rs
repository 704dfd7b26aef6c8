//! Maps of light need every place of a surface once and inside the unit square. Where a mesh's texture coordinates are not
//! like that, light gets others, while the material's maps keep theirs.

use super::{AtlasChoice, ReadOptions, Textured};
use crate::tiles::{MAX_TILES, Tiles};
use crate::topology::weld;
use crate::unwrap::unwrap;
use crate::{Charts, Mesh};
use glam::Vec2;

/// Said of a mesh without texture coordinates.
pub(super) const LACKS_UVS: &str = "the mesh has no texture coordinates";
/// Said of one with some.
pub(super) const LACKS_SOME_UVS: &str = "parts of the mesh have no texture coordinates";

/// Part of the texture that a surface should have: below it, maps of light have no texels for it.
const LEAST_USED_FRACTION: f64 = 0.02;

/// Grid on which overlap is counted: fine enough for half a percent of a used texture.
const OVERLAP_GRID: u32 = 512;

/// Overlap below this is the rounding of an atlas packer.
const MAX_OVERLAP_FRACTION: f32 = 0.005;

/// Sum of the triangles' boxes in the texture, in unit squares, up to which the overlap is counted. Honest atlases
/// stay near 3; far above it, counting would take forever and the answer is known.
const MAX_BOX_SUM: f32 = 64.0;

/// Part of the surface that may have next to no area in the texture: a mouth's inside, say, that nobody sees.
const MAX_BARE_FRACTION: f32 = 0.01;
/// Area in the texture, by that on the surface and the mean of both, that is next to none: texels are a thousand times as wide.
const BARE: f64 = 1e-6;

/// Gives a mesh an atlas for light if that was chosen, or if its texture coordinates, as far as it has them, cannot be one; tells what
/// was done that nobody asked for.
///
/// # Errors
/// In words, if no atlas can be made where one is asked for or there are no texture coordinates.
pub(super) fn give_atlas(
    mesh: &mut Mesh,
    textured: Textured,
    choice: AtlasChoice,
    options: &ReadOptions,
) -> Result<Option<String>, String> {
    let is_asked = choice == AtlasChoice::New;
    let lacks_uvs = textured == Textured::Not;
    let trouble = match textured {
        Textured::Not => Some(LACKS_UVS.to_owned()),
        Textured::Partly => Some(LACKS_SOME_UVS.to_owned()),
        Textured::Whole => trouble_of(mesh),
    };
    let Some(trouble) = trouble.or(is_asked.then(|| "a new atlas is asked for".to_owned())) else {
        return Ok(None);
    };
    if textured == Textured::Whole
        && !is_asked
        && let Some(words) = gather(mesh)
    {
        return Ok(Some(words));
    }
    match unwrap(mesh, options.cache_folder.as_deref(), options.tell) {
        Ok(unwrapped) => {
            unwrapped.lay(mesh);
            let charts = Charts::find(mesh, &weld(&mesh.positions_mm)).count;
            if lacks_uvs && let Some(uvs) = mesh.atlas_uvs.take() {
                mesh.uvs = uvs;
                // They follow the texture.
                mesh.tangents.clear();
                mesh.morph_targets.iter_mut().for_each(|target| target.tangent_offsets.clear());
            }
            Ok((!is_asked).then(|| format!("{trouble}; an atlas of {charts} charts was made for light")))
        }
        Err(why) if lacks_uvs || is_asked => Err(format!("{trouble}, and no atlas could be made: {why}")),
        Err(why) => Ok(Some(format!(
            "{trouble}, and no atlas could be made ({why}); diffusion in texture space will mix those places"
        ))),
    }
}

/// Gathers charts that lie on other tiles of the plane in the unit square: on one another if that goes, else side by side.
fn gather(mesh: &mut Mesh) -> Option<String> {
    let tiles = Tiles::of(mesh)?;
    let side_by_side = (2..=MAX_TILES).contains(&tiles.count()).then(|| tiles.per_side());
    for per_side in std::iter::once(1).chain(side_by_side) {
        let mut gathered = mesh.clone();
        tiles.atlas(mesh, per_side).lay(&mut gathered);
        if trouble_of(&gathered).is_none() {
            *mesh = gathered;
            let how = match per_side {
                1 => "were moved back into it".to_owned(),
                _ => format!("lie on {} tiles, which were put side by side", tiles.count()),
            };
            return Some(format!("texture charts outside the unit square {how} for light"));
        }
    }
    None
}

/// Says in words why a mesh's atlas cannot carry a map of the surface one to one.
fn trouble_of(mesh: &Mesh) -> Option<String> {
    if !Charts::inside_unit_square(mesh) {
        let outside = "texture coordinates leave the unit square, so parts of the surface share texels";
        return Some(outside.to_owned());
    }
    let bare = bare_fraction(mesh);
    if bare > MAX_BARE_FRACTION {
        return Some(format!("{:.1} % of the surface has next to no area in the texture", 100.0 * bare));
    }
    let used = used_fraction(mesh);
    if used < LEAST_USED_FRACTION {
        return Some(format!("the surface has only {:.2} % of the texture", 100.0 * used));
    }
    if box_sum(mesh) > MAX_BOX_SUM {
        return Some("the texture is used many times over".to_owned());
    }
    let overlap = Charts::overlap_fraction(mesh, OVERLAP_GRID);
    (overlap > MAX_OVERLAP_FRACTION).then(|| {
        format!("{:.1} % of the used texture belongs to more than one place of the surface", 100.0 * overlap)
    })
}

/// Part of the surface, by area, whose triangles have next to none in the texture.
fn bare_fraction(mesh: &Mesh) -> f32 {
    let area_mm2 = |t: usize| f64::from(mesh.area_mm2(t));
    let all = 0..mesh.triangles.len();
    let whole_mm2: f64 = all.clone().map(area_mm2).sum();
    let least_per_mm2 = BARE * used_fraction(mesh) / whole_mm2;
    let bare = all.filter(|&t| area_in_texture(mesh, t) <= least_per_mm2 * area_mm2(t));
    (bare.map(area_mm2).sum::<f64>() / whole_mm2) as f32
}

/// Area of all triangles in the texture.
fn used_fraction(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| area_in_texture(mesh, t)).sum()
}

fn area_in_texture(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.corner_atlas_uvs(triangle).map(|uv| uv.as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}

/// Sum of the areas of the triangles' boxes inside the unit square.
fn box_sum(mesh: &Mesh) -> f32 {
    let area = |t: usize| {
        let uvs = mesh.corner_atlas_uvs(t).map(|uv| uv.clamp(Vec2::ZERO, Vec2::ONE));
        let size = uvs[0].max(uvs[1]).max(uvs[2]) - uvs[0].min(uvs[1]).min(uvs[2]);
        size.x * size.y
    };
    (0..mesh.triangles.len()).map(area).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Triangles of their own, each somewhere in the texture.
    fn triangles(shifts: &[[f32; 2]]) -> Mesh {
        let mut mesh = Mesh::default();
        for (i, shift) in shifts.iter().enumerate() {
            let base = 3 * i as u32;
            let up = Vec3::Z * 10.0 * i as f32;
            mesh.positions_mm.extend([Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + up));
            let corners = [Vec2::ZERO, Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.5)];
            mesh.uvs.extend(corners.map(|uv| uv + Vec2::from_array(*shift)));
            mesh.triangles.push([base, base + 1, base + 2]);
        }
        mesh
    }

    fn given(shifts: &[[f32; 2]]) -> (Mesh, Option<String>) {
        let mut mesh = triangles(shifts);
        let words = give_atlas(&mut mesh, Textured::Whole, AtlasChoice::Own, &ReadOptions::default())
            .expect("it has coordinates");
        (mesh, words)
    }

    #[test]
    fn what_can_carry_light_stays_as_it_is() {
        let (mesh, words) = given(&[[0.0, 0.0], [0.5, 0.5]]);
        assert_eq!((mesh.atlas_uvs, words), (None, None));
    }

    #[test]
    fn a_chart_in_another_tile_comes_back_for_light() {
        let (mesh, words) = given(&[[3.0, -2.0], [0.5, 0.5]]);
        assert_eq!(mesh.in_atlas(), triangles(&[[0.0, 0.0], [0.5, 0.5]]).uvs);
        assert_eq!(mesh.uvs, triangles(&[[3.0, -2.0], [0.5, 0.5]]).uvs, "maps lie where they lay");
        assert!(words.expect("told").contains("moved back"));
    }

    #[test]
    fn charts_on_several_tiles_lie_side_by_side() {
        let (mesh, words) = given(&[[0.0, 0.0], [1.0, 0.0], [4.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
        assert!(words.expect("told").contains("5 tiles, which were put side by side"));
        assert!(Charts::inside_unit_square(&mesh));
        assert_eq!(Charts::overlap_fraction(&mesh, 512), 0.0);
        // All of one scale: nine squares hold the five tiles.
        for t in 0..5 {
            let [a, b, c] = mesh.corner_atlas_uvs(t);
            assert!(((b - a) - Vec2::X / 6.0).length() < 1e-6 && ((c - a) - Vec2::Y / 6.0).length() < 1e-6);
        }
    }

    #[test]
    fn a_place_of_the_texture_that_is_used_twice_is_an_overlap() {
        let (mesh, words) = given(&[[0.0, 0.0], [0.0, 0.0]]);
        assert!(words.expect("told").starts_with("100.0 % of the used texture"));
        assert_eq!(trouble_of(&mesh), None);
        assert_eq!(mesh.uvs, triangles(&[[0.0, 0.0], [0.0, 0.0]]).uvs, "maps lie where they lay");
    }

    #[test]
    fn a_surface_without_a_place_in_the_texture_is_told() {
        let mut mesh = triangles(&[[0.0, 0.0], [0.5, 0.5]]);
        mesh.uvs[3..].fill(Vec2::ONE);
        let words = give_atlas(&mut mesh, Textured::Whole, AtlasChoice::Own, &ReadOptions::default())
            .expect("it has coordinates");
        assert!(
            words
                .expect("told")
                .starts_with("50.0 % of the surface has next to no area in the texture; an atlas")
        );
        assert_eq!(trouble_of(&mesh), None);
    }

    /// An island of a ten-thousandth of the size that it should have is as good as none.
    #[test]
    fn a_surface_with_next_to_no_place_in_the_texture_is_told() {
        let mut mesh = triangles(&[[0.0, 0.0], [0.5, 0.5]]);
        mesh.uvs[3..].iter_mut().for_each(|uv| *uv = 0.9 + 1e-4 * *uv);
        let words = give_atlas(&mut mesh, Textured::Whole, AtlasChoice::Own, &ReadOptions::default());
        assert!(words.expect("it has coordinates").expect("told").starts_with("50.0 % of the surface"));
        assert_eq!(trouble_of(&mesh), None);
    }

    #[test]
    fn a_surface_with_hardly_any_of_the_texture_is_told() {
        let mut mesh = triangles(&[[0.0, 0.0], [0.5, 0.5]]);
        mesh.uvs.iter_mut().for_each(|uv| *uv = *uv * 0.05 + 0.2);
        let words = give_atlas(&mut mesh, Textured::Whole, AtlasChoice::Own, &ReadOptions::default());
        let words = words.expect("it has coordinates").expect("told");
        assert!(words.starts_with("the surface has only 0.06 % of the texture; an atlas"), "{words}");
        assert_eq!(trouble_of(&mesh), None);
    }

    #[test]
    fn a_texture_used_a_thousand_times_is_not_counted_out() {
        let mesh = triangles(&[[0.0, 0.0]; 1000]);
        assert!(trouble_of(&mesh).expect("trouble").contains("many times over"));
    }
}
