//! The built-in head: a human head made by code, so that the program has something to show without any file.
//!
//! A sculpture of distance functions is meshed by surface nets, thinned, unwrapped into a few charts and refined to
//! the wanted number of triangles; its colour, relief and shine are computed per texel from positions in space.

mod areas;
mod decimate;
mod detail;
mod ear;
mod ear_plate;
mod eyes;
mod face;
mod flatten;
mod grid;
mod mesher;
mod mouth;
mod neck;
mod noise;
mod nose;
mod polish;
mod refine;
mod regions;
mod relief;
mod sculpture;
mod sdf;
mod skin_maps;
mod skull;
#[cfg(test)]
mod tests;
mod texels;
mod unwrap;

use crate::{Material, Mesh, MeshOrigin, Object, ObjectSource};
use glam::Vec3;
use rayon::prelude::*;
use sculpture::Sculpture;
use std::sync::Arc;
use unwrap::Unwrapped;

/// How fine the built-in head is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeadDetail {
    /// Number of triangles, met to within one.
    pub triangles: usize,
    /// Width and height of the maps in texels; 0 for no maps.
    pub map_size: u32,
}

impl Default for HeadDetail {
    /// 100 thousand triangles: 0.7 mm at the lids, 1 mm at the ears, 3 mm on the cranium. Maps of 2048².
    fn default() -> Self {
        Self { triangles: 100_000, map_size: 2048 }
    }
}

/// Cells of the first net, mm: their diagonal fits into the ear's plate (2.6 mm), which therefore has no gaps.
const CELL_MM: f32 = 1.5;
/// Triangles of the mesh that is unwrapped; finer ones inherit its texture coordinates.
const UNWRAPPED_TRIANGLES: usize = 24_000;

/// The head, ready to be drawn.
pub fn built_in(detail: HeadDetail) -> Object {
    let sculpture = Sculpture::new();
    let surface = surface(&sculpture, detail.triangles);
    let mut head = Object::new("head", mesh(&surface, &sculpture), Material::default());
    head.material = skin_maps::material(&head, &sculpture, detail.map_size);
    let origin = Arc::new(MeshOrigin::BuiltInHead(detail));
    head.source = Some(ObjectSource { origin, number: 0, count: 1, own_material: head.material.clone() });
    head
}

fn surface(sculpture: &Sculpture, triangles: usize) -> Unwrapped {
    let edge_length_mm = |p: Vec3| detail::edge_length_mm(sculpture, p);
    let net = mesher::surface_nets(sculpture, CELL_MM);
    let thin = decimate::decimate(net, triangles.min(UNWRAPPED_TRIANGLES), &edge_length_mm);
    let round = polish::polish(thin, sculpture, 3);
    let unwrapped = unwrap::unwrap(round, sculpture);
    refine::refine(unwrapped, sculpture, triangles, &edge_length_mm)
}

/// One vertex for each texture coordinate.
fn mesh(surface: &Unwrapped, sculpture: &Sculpture) -> Mesh {
    let mut point_of = vec![0u32; surface.uvs.len()];
    for (points, uvs) in surface.surface.triangles.iter().zip(&surface.triangle_uvs) {
        uvs.iter().zip(points).for_each(|(&uv, &p)| point_of[uv as usize] = p);
    }
    let normals: Vec<Vec3> = surface.surface.points_mm.par_iter().map(|&p| sculpture.normal(p)).collect();
    Mesh {
        positions_mm: point_of.iter().map(|&p| surface.surface.points_mm[p as usize]).collect(),
        normals: point_of.iter().map(|&p| normals[p as usize]).collect(),
        uvs: surface.uvs.clone(),
        triangles: surface.triangle_uvs.clone(),
        ..Mesh::default()
    }
}
