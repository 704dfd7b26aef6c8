//! Wavefront OBJ: `v`, `vt`, `vn`, `f` and `usemtl`; everything else is passed over.
//!
//! Conventions: a file's v grows upwards and is turned to the rows of the image (`1 - v`); `flip_v` leaves it as it
//! is. A polygon becomes a fan around its first corner, which is exact for convex ones. Each name after `usemtl`
//! becomes one object; the `.mtl` file is not opened, since its colours are not those of skin.
//! The format has no unit. Without `millimetres_per_unit` the mesh is taken for a head.

use super::checks::MAX_COUNT;
use super::{Parts, Piece, ReadOptions, Textured};
use crate::{Material, Mesh, SceneError};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::path::Path;

/// Largest extent that a mesh of unknown size is given, mm: a human head from chin to crown.
const ASSUMED_EXTENT_MM: f32 = 250.0;

/// Reads the bytes of an OBJ file.
pub(crate) fn read(bytes: &[u8], file: &Path, options: &ReadOptions) -> Result<Parts, SceneError> {
    let mut parser = Parser::new(file, !options.flip_v);
    for (number, line) in lines(bytes) {
        parser.line = number;
        parser.statement(&line)?;
    }
    let mut warnings = parser.warnings();
    let mm = match options.millimetres_per_unit {
        Some(mm) => mm,
        None => assumed_size(&parser.positions, &mut warnings),
    };
    let mut pieces = parser.pieces()?;
    for position in pieces.iter_mut().flat_map(|piece| &mut piece.mesh.positions_mm) {
        *position *= mm;
    }
    Ok(Parts { pieces, warnings, ..Parts::default() })
}

/// Millimetres per unit that make the largest extent that of a head, and a warning that says so.
fn assumed_size(positions: &[Vec3], warnings: &mut Vec<String>) -> f32 {
    let lo = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let hi = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
    let extent = (hi - lo).max_element();
    let mm = if extent > 0.0 && extent.is_finite() { ASSUMED_EXTENT_MM / extent } else { 1.0 };
    warnings.push(format!(
        "the file does not say how large it is: assumed {ASSUMED_EXTENT_MM} mm at its largest extent \
         ({mm:.4} mm per unit); state millimetres_per_unit to be sure, for light spreads by millimetres"
    ));
    mm
}

/// The statements of a file with the number of their first line; a backslash at the end joins two lines.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Vec<u8>)> {
    let mut source = bytes.split(|&b| b == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (index, first) = source.next()?;
        let mut line = first.trim_ascii_end().to_vec();
        while line.last() == Some(&b'\\') {
            line.pop();
            let Some((_, next)) = source.next() else { break };
            line.push(b' ');
            line.extend_from_slice(next.trim_ascii_end());
        }
        Some((index + 1, line))
    })
}

/// One corner of a face: position, texture coordinate and normal, each an index from 0.
type Corner = (u32, Option<u32>, Option<u32>);

/// The triangles of one material while they are gathered.
#[derive(Default)]
struct Group {
    name: String,
    mesh: Mesh,
    vertex_of_corner: HashMap<Corner, u32>,
    /// Whether a corner has a texture coordinate; those that have none lie at the corner of the texture.
    has_uvs: bool,
    /// Whether one has none.
    lacks_uvs: bool,
}

struct Parser<'a> {
    file: &'a Path,
    turn_v: bool,
    line: usize,
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// For each `vt` the first one with the same value, so that files which repeat them share vertices.
    first_uv: Vec<u32>,
    uv_of_bits: HashMap<[u32; 2], u32>,
    normals: Vec<Vec3>,
    groups: Vec<Group>,
    group_of_name: HashMap<String, usize>,
    current: usize,
    corners: usize,
    corners_without_normal: usize,
}

impl<'a> Parser<'a> {
    fn new(file: &'a Path, turn_v: bool) -> Self {
        Self {
            file,
            turn_v,
            line: 0,
            positions: Vec::new(),
            uvs: Vec::new(),
            first_uv: Vec::new(),
            uv_of_bits: HashMap::new(),
            normals: Vec::new(),
            groups: vec![Group::default()],
            group_of_name: HashMap::from([(String::new(), 0)]),
            current: 0,
            corners: 0,
            corners_without_normal: 0,
        }
    }

    fn fail<T>(&self, reason: impl Into<String>) -> Result<T, SceneError> {
        Err(SceneError::new(self.file, format!("line {}", self.line), reason))
    }

    /// Reads one statement.
    fn statement(&mut self, line: &[u8]) -> Result<(), SceneError> {
        let line = line.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(end);
        match keyword {
            b"usemtl" => {
                self.use_material(String::from_utf8_lossy(rest.trim_ascii()).into_owned());
                Ok(())
            }
            b"v" | b"vt" | b"vn" | b"f" => match std::str::from_utf8(rest) {
                // A `#` ends the statement.
                Ok(text) => self.data(keyword, text.split('#').next().unwrap_or_default()),
                Err(_) => self.fail("is not text in UTF-8"),
            },
            _ => Ok(()),
        }
    }

    fn data(&mut self, keyword: &[u8], text: &str) -> Result<(), SceneError> {
        match keyword {
            b"v" => {
                let [x, y, z] = self.numbers(text, 3)?;
                self.positions.push(Vec3::new(x, y, z));
            }
            b"vt" => {
                let [u, v, _] = self.numbers(text, 1)?;
                self.add_uv(Vec2::new(u, if self.turn_v { 1.0 - v } else { v }));
            }
            b"vn" => {
                let [x, y, z] = self.numbers(text, 3)?;
                self.normals.push(Vec3::new(x, y, z).normalize_or_zero());
            }
            _ => return self.face(text),
        }
        if self.positions.len().max(self.uvs.len()).max(self.normals.len()) > 4 * MAX_COUNT {
            return self.fail(format!("more than {} points", 4 * MAX_COUNT));
        }
        Ok(())
    }

    fn add_uv(&mut self, uv: Vec2) {
        let index = self.uvs.len() as u32;
        let bits = (uv + Vec2::ZERO).to_array().map(f32::to_bits); // + 0 turns -0 into 0
        self.first_uv.push(*self.uv_of_bits.entry(bits).or_insert(index));
        self.uvs.push(uv);
    }

    /// Up to three finite numbers, of which `needed` must be there; the rest are 0. Further words, such as a weight
    /// or colours, are passed over.
    fn numbers(&self, text: &str, needed: usize) -> Result<[f32; 3], SceneError> {
        let mut numbers = [0.0; 3];
        let mut count = 0;
        for (slot, word) in numbers.iter_mut().zip(text.split_ascii_whitespace()) {
            match word.parse::<f32>() {
                Ok(number) if number.is_finite() => *slot = number,
                _ => return self.fail(format!("`{word}` is not a finite number")),
            }
            count += 1;
        }
        if count < needed {
            return self.fail(format!("{needed} numbers are needed, found {count}"));
        }
        Ok(numbers)
    }

    fn use_material(&mut self, name: String) {
        let next = self.groups.len();
        self.current = *self.group_of_name.entry(name.clone()).or_insert(next);
        if self.current == next {
            self.groups.push(Group { name, ..Group::default() });
        }
    }

    fn face(&mut self, text: &str) -> Result<(), SceneError> {
        let mut vertices = Vec::with_capacity(4);
        for word in text.split_ascii_whitespace() {
            let corner = self.corner(word)?;
            vertices.push(self.vertex(corner));
        }
        if vertices.len() < 3 {
            return self.fail(format!("a face has at least 3 corners, this one has {}", vertices.len()));
        }
        self.corners += vertices.len();
        if self.corners > 3 * MAX_COUNT {
            return self.fail(format!("more than {MAX_COUNT} triangles"));
        }
        let fan = vertices.windows(2).skip(1).map(|pair| [vertices[0], pair[0], pair[1]]);
        self.groups[self.current].mesh.triangles.extend(fan);
        Ok(())
    }

    /// One corner as `v/vt` or `v/vt/vn`.
    fn corner(&mut self, word: &str) -> Result<Corner, SceneError> {
        let mut fields = word.split('/');
        let position = self.index(fields.next().unwrap_or_default(), self.positions.len(), "v")?;
        let uv = match fields.next() {
            Some(field) if !field.is_empty() => {
                Some(self.first_uv[self.index(field, self.uvs.len(), "vt")? as usize])
            }
            _ => None,
        };
        let normal = match fields.next() {
            Some(field) if !field.is_empty() => Some(self.index(field, self.normals.len(), "vn")?),
            _ => None,
        };
        self.corners_without_normal += usize::from(normal.is_none());
        Ok((position, uv, normal))
    }

    /// An index into what was read so far: from 1, or negative from the end.
    fn index(&self, field: &str, count: usize, keyword: &str) -> Result<u32, SceneError> {
        let Ok(number) = field.parse::<i64>() else {
            return self.fail(format!("`{field}` is not the number of a `{keyword}`"));
        };
        let index = if number < 0 { count as i64 + number } else { number - 1 };
        if number == 0 || index < 0 || index >= count as i64 {
            return self.fail(format!("`{keyword}` {number} does not exist: {count} are defined above"));
        }
        u32::try_from(index).or_else(|_| self.fail("too many points"))
    }

    fn vertex(&mut self, corner: Corner) -> u32 {
        let Group { mesh, vertex_of_corner, has_uvs, lacks_uvs, .. } = &mut self.groups[self.current];
        *has_uvs |= corner.1.is_some();
        *lacks_uvs |= corner.1.is_none();
        *vertex_of_corner.entry(corner).or_insert_with(|| {
            let (position, uv, normal) = corner;
            mesh.positions_mm.push(self.positions[position as usize]);
            mesh.uvs.push(uv.map_or(Vec2::ZERO, |uv| self.uvs[uv as usize]));
            mesh.normals.push(normal.map_or(Vec3::ZERO, |n| self.normals[n as usize]));
            mesh.positions_mm.len() as u32 - 1
        })
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if 0 < self.corners_without_normal && self.corners_without_normal < self.corners {
            warnings.push("some corners have no normal: all normals were computed from the shape".to_owned());
        }
        warnings
    }

    /// One piece for each material that has triangles.
    fn pieces(self) -> Result<Vec<Piece>, SceneError> {
        if self.corners == 0 {
            return Err(SceneError::new(self.file, "whole file", "holds no faces; is it a Wavefront OBJ?"));
        }
        let stem = self.file.file_stem().map_or("mesh".into(), |stem| stem.to_string_lossy().into_owned());
        let complete = self.corners_without_normal == 0;
        let used = self.groups.into_iter().filter(|group| !group.mesh.triangles.is_empty());
        Ok(used
            .map(|Group { name, mut mesh, has_uvs, lacks_uvs, .. }| {
                if !complete {
                    mesh.normals.clear();
                }
                let name = if name.is_empty() { stem.clone() } else { name };
                Piece {
                    place: format!("object `{name}`"),
                    name,
                    mesh,
                    textured: Textured::new(has_uvs, lacks_uvs),
                    material: Material::default(),
                    own_material: Material::default(),
                }
            })
            .collect())
    }
}
