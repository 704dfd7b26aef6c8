//! An atlas for meshes whose texture coordinates cannot carry light: charts, flattened and packed, so that every place has
//! texels of its own.
//!
//! Least-squares conformal maps (Lévy, Petitjean, Ray & Maillot 2002) by the crate `uvunwrap`. What was made can be kept in a
//! folder, by a number that follows from positions and triangles.

use crate::Mesh;
use crate::topology::weld;
use glam::Vec2;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use uvunwrap::{Density, MeshInput, Options, Progress};

/// Marks a kept atlas: one by version 0.2 of uvunwrap, stretched by a quarter at most. It changes when atlases are made otherwise.
const MAGIC: [u8; 8] = *b"uvwrap2q";

/// Texels may be so many times as wide along one axis as along the other.
const MOST_STRETCHED: f32 = 1.25;

/// Widths, in texels, of pages that are tried one after the other until all charts fit one: each has two texels around it.
const PAGE_SIZES: &[u32] = &[1024, 4096, 16384];

/// Time that passes between two words about the work.
const BETWEEN_WORDS: Duration = Duration::from_secs(1);

/// An atlas that was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Unwrapped {
    /// The vertex of the mesh before that each vertex is.
    pub vertices: Vec<u32>,
    /// Texture coordinates of each vertex.
    pub uvs: Vec<Vec2>,
    /// Triangles over these vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// An atlas of a mesh in which nothing overlaps. Atlases are looked for and kept in `folder`; `tell` is told how far the work
/// is, in words, if it takes long enough to wonder.
///
/// # Errors
/// In words, if the mesh cannot be cut into charts.
pub fn unwrap(mesh: &Mesh, folder: Option<&Path>, tell: Option<fn(&str)>) -> Result<Unwrapped, String> {
    let kept = folder.map(|folder| folder.join(format!("{:016x}.atlas", number_of(mesh))));
    let read = kept.as_deref().and_then(|path| read(path, mesh));
    if let Some(unwrapped) = read {
        return Ok(unwrapped);
    }
    let made = Unwrapped::of(mesh, PAGE_SIZES, tell)?;
    // A folder that cannot be written costs time, not the picture.
    if let Some(Err(error)) = kept.as_deref().map(|path| write(path, &made)) {
        tracing::debug!("the atlas is not kept: {error}");
    }
    Ok(made)
}

impl Unwrapped {
    /// On the first of some pages that has room for all charts.
    fn of(mesh: &Mesh, page_sizes: &[u32], tell: Option<fn(&str)>) -> Result<Self, String> {
        // Vertices that were split for normals or an old texture are one point of the surface.
        let points = weld(&mesh.positions_mm);
        let mut first: Vec<u32> = Vec::new();
        for (v, &point) in points.iter().enumerate() {
            if point as usize == first.len() {
                first.push(v as u32);
            }
        }
        let positions: Vec<[f32; 3]> =
            first.iter().map(|&v| mesh.positions_mm[v as usize].to_array()).collect();
        let indices: Vec<u32> = mesh.triangles.iter().flatten().map(|&v| points[v as usize]).collect();
        let told = Mutex::new(Instant::now());
        let on_the_way = |p: Progress| {
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(tell) = tell.filter(|_| told.elapsed() > BETWEEN_WORDS) {
                *told = Instant::now();
                let of = p.total.map_or(String::new(), |total| format!(" of {total}"));
                tell(&format!("making an atlas: {:?}, {}{of}", p.stage, p.done).to_lowercase());
            }
            true
        };
        let made_on = |page_size: u32| {
            let options = Options { density: Density::Auto { page_size }, ..Options::default() };
            uvunwrap::generate_with_progress(&[MeshInput::new(&positions, &indices)], &options, on_the_way)
                .map_err(|error| error.to_string())
        };
        let mut pages = page_sizes.iter();
        let atlas = loop {
            let Some(&page_size) = pages.next() else {
                return Err("its charts are too many for one texture".to_owned());
            };
            let atlas = made_on(page_size)?;
            if atlas.page_count == 1 {
                break atlas;
            }
        };
        let made = &atlas.meshes[0];
        // Pages are cut off below the last chart; what is left is stretched over the texture, but for long strips.
        let height = atlas.height as f32 / atlas.width as f32;
        let stretched = Vec2::new(1.0, height * height.recip().clamp(1.0, MOST_STRETCHED));
        // Every corner keeps what its own vertex had, so that a vertex is a pair of both.
        let mut unwrapped = Self { vertices: Vec::new(), uvs: Vec::new(), triangles: Vec::new() };
        let mut known = HashMap::new();
        for (triangle, corners) in mesh.triangles.iter().zip(made.indices.chunks_exact(3)) {
            let vertices = [0, 1, 2].map(|k| {
                let (own, at) = (triangle[k], corners[k]);
                *known.entry((own, at)).or_insert_with(|| {
                    unwrapped.vertices.push(own);
                    unwrapped.uvs.push(Vec2::from_array(made.vertices[at as usize].uv) * stretched);
                    unwrapped.vertices.len() as u32 - 1
                })
            });
            unwrapped.triangles.push(vertices);
        }
        Ok(unwrapped)
    }

    /// Lays light as this atlas has it. Vertices are split where it is cut and keep what they had, among it their places in
    /// the material's maps.
    pub fn lay(self, mesh: &mut Mesh) {
        fn taken<T: Copy>(values: &mut Vec<T>, vertices: &[u32]) {
            if !values.is_empty() {
                *values = vertices.iter().map(|&v| values[v as usize]).collect();
            }
        }
        let vertices = &self.vertices;
        taken(&mut mesh.positions_mm, vertices);
        taken(&mut mesh.normals, vertices);
        taken(&mut mesh.tangents, vertices);
        taken(&mut mesh.uvs, vertices);
        for target in &mut mesh.morph_targets {
            taken(&mut target.position_offsets_mm, vertices);
            taken(&mut target.normal_offsets, vertices);
            taken(&mut target.tangent_offsets, vertices);
        }
        if let Some(skeleton) = &mut mesh.skeleton {
            taken(&mut skeleton.influences, vertices);
        }
        mesh.atlas_uvs = Some(self.uvs);
        mesh.triangles = self.triangles;
    }
}

/// A number that follows from positions and triangles (Fowler, Noll & Vo).
fn number_of(mesh: &Mesh) -> u64 {
    let positions = mesh.positions_mm.iter().flat_map(|p| p.to_array().map(f32::to_bits));
    let words = positions.chain(mesh.triangles.iter().flatten().copied());
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| {
        (hash ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

fn write(path: &Path, unwrapped: &Unwrapped) -> std::io::Result<()> {
    let mut bytes = MAGIC.to_vec();
    let mut word = |word: u32| bytes.extend(word.to_le_bytes());
    word(unwrapped.vertices.len() as u32);
    word(unwrapped.triangles.len() as u32);
    unwrapped.vertices.iter().for_each(|&v| word(v));
    unwrapped.uvs.iter().flat_map(|uv| uv.to_array()).for_each(|x| word(x.to_bits()));
    unwrapped.triangles.iter().flatten().for_each(|&v| word(v));
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    // Another process may be at it, too: a file is there as a whole or not at all.
    let part = path.with_extension(format!("part{}", std::process::id()));
    std::fs::write(&part, bytes)?;
    std::fs::rename(part, path)
}

/// A kept atlas, if it is one and fits the mesh.
fn read(path: &Path, mesh: &Mesh) -> Option<Unwrapped> {
    let bytes = std::fs::read(path).ok()?;
    let rest = bytes.strip_prefix(&MAGIC)?;
    let mut words = rest.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    let (vertices, triangles) = (words.next()? as usize, words.next()? as usize);
    if triangles != mesh.triangles.len()
        || rest.len() as u64 != 4 * (2 + 3 * vertices as u64 + 3 * triangles as u64)
    {
        return None;
    }
    let own: Vec<u32> = words.by_ref().take(vertices).collect();
    let numbers: Vec<f32> = words.by_ref().take(2 * vertices).map(f32::from_bits).collect();
    let uvs: Vec<Vec2> = numbers.chunks_exact(2).map(Vec2::from_slice).collect();
    let corners: Vec<u32> = words.collect();
    let triangles: Vec<[u32; 3]> = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let fits = own.iter().all(|&v| (v as usize) < mesh.positions_mm.len())
        && corners.iter().all(|&v| (v as usize) < vertices)
        && uvs.iter().all(|uv| uv.is_finite());
    fits.then_some(Unwrapped { vertices: own, uvs, triangles })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::charts::Charts;
    use crate::validation::shapes;
    use crate::{Influence, MorphTarget, Skeleton};
    use glam::Vec3;

    fn bare() -> Mesh {
        let mut mesh = shapes::capsule(Vec3::ZERO, 10.0, 5.0, 24);
        mesh.uvs.clear();
        mesh
    }

    #[test]
    fn a_body_without_an_atlas_gets_one() {
        let before = bare();
        let mut mesh = before.clone();
        Unwrapped::of(&before, PAGE_SIZES, None).unwrap().lay(&mut mesh);
        assert_eq!(mesh.triangles.len(), before.triangles.len());
        for t in 0..mesh.triangles.len() {
            assert_eq!(mesh.corners_mm(t), before.corners_mm(t), "triangle {t} is where it was");
        }
        assert!(Charts::inside_unit_square(&mesh));
        assert!(Charts::overlap_fraction(&mesh, 512) < 1e-3);
        let used: f32 = (0..mesh.triangles.len())
            .map(|t| {
                let [a, b, c] = mesh.corner_atlas_uvs(t);
                0.5 * (b - a).perp_dot(c - a).abs()
            })
            .sum();
        assert!(used > 0.4, "{used} of the texture is used");
    }

    /// Texels of a body that fills a small part of its page are about as wide along u as along v.
    #[test]
    fn texels_of_a_long_strip_are_nearly_square() {
        let corners = [Vec3::ZERO, Vec3::X * 100.0, Vec3::new(100.0, 5.0, 0.0), Vec3::Y * 5.0];
        let mut mesh =
            Mesh { positions_mm: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        Unwrapped::of(&mesh.clone(), PAGE_SIZES, None).unwrap().lay(&mut mesh);
        for t in 0..2 {
            let ([a, b, c], [p, q, r]) = (mesh.corner_atlas_uvs(t), mesh.corners_mm(t));
            let [along, across] = [(b - a).length() / (q - p).length(), (c - b).length() / (r - q).length()];
            assert!(
                (0.98 / MOST_STRETCHED..1.02 * MOST_STRETCHED).contains(&(along / across)),
                "{along} {across}"
            );
        }
    }

    /// More charts than fit the first page, however small they were made there, lie on the next; or on none.
    #[test]
    fn charts_without_number_do_not_overlap() {
        let mut mesh = Mesh::default();
        for i in 0..400 {
            let at = Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0) * 3.0;
            mesh.positions_mm.extend([at, at + Vec3::X, at + Vec3::Y]);
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let why = Unwrapped::of(&mesh, &[32, 64], None).unwrap_err();
        assert!(why.contains("too many"), "{why}");
        Unwrapped::of(&mesh.clone(), &[32, 64, 256], None).unwrap().lay(&mut mesh);
        assert!(Charts::inside_unit_square(&mesh));
        assert_eq!(Charts::overlap_fraction(&mesh, 2048), 0.0);
    }

    /// Where the atlas is cut a vertex becomes two, and both have all that the one had.
    #[test]
    fn split_vertices_keep_what_they_had() {
        let mut mesh = bare();
        let places = mesh.positions_mm.clone();
        mesh.uvs = places.iter().map(|p| p.truncate()).collect();
        mesh.normals = places.iter().map(|&p| p * 2.0).collect();
        mesh.tangents = places.iter().map(|&p| p.extend(1.0)).collect();
        mesh.morph_targets.push(MorphTarget {
            position_offsets_mm: places.iter().map(|&p| p * 3.0).collect(),
            normal_offsets: places.iter().map(|&p| p * 4.0).collect(),
            tangent_offsets: places.iter().map(|&p| p * 5.0).collect(),
            ..MorphTarget::default()
        });
        let influences =
            places.iter().map(|p| Influence { weights: p.extend(0.0).to_array(), ..Influence::default() });
        mesh.skeleton = Some(Skeleton { influences: influences.collect(), ..Skeleton::default() });
        Unwrapped::of(&mesh, PAGE_SIZES, None).unwrap().lay(&mut mesh);
        assert!(mesh.positions_mm.len() > places.len(), "somewhere it is cut");
        let (target, skeleton) = (&mesh.morph_targets[0], mesh.skeleton.as_ref().unwrap());
        for (v, &p) in mesh.positions_mm.iter().enumerate() {
            assert_eq!(
                (mesh.uvs[v], mesh.normals[v], mesh.tangents[v]),
                (p.truncate(), p * 2.0, p.extend(1.0))
            );
            assert_eq!(target.position_offsets_mm[v], p * 3.0);
            assert_eq!((target.normal_offsets[v], target.tangent_offsets[v]), (p * 4.0, p * 5.0));
            assert_eq!(skeleton.influences[v].weights, p.extend(0.0).to_array());
        }
    }

    #[test]
    fn what_was_kept_is_what_was_made_and_nothing_else_is_believed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept").join("one.atlas");
        let mesh = bare();
        let made = Unwrapped::of(&mesh, PAGE_SIZES, None).unwrap();
        write(&path, &made).unwrap();
        assert_eq!(read(&path, &mesh), Some(made));
        let bytes = std::fs::read(&path).unwrap();
        for cut in [0, 7, 12, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            assert_eq!(read(&path, &mesh), None, "{cut} bytes");
        }
        let mut wrong = bytes.clone();
        // A vertex that does not exist.
        wrong[16..20].copy_from_slice(&u32::MAX.to_le_bytes());
        std::fs::write(&path, &wrong).unwrap();
        assert_eq!(read(&path, &mesh), None);
    }
}
