//! The built-in head: a human head made by code, so that the program has something to show without any file.

mod ear;
mod face;
mod grid;
mod mesher;
mod neck;
mod sculpture;
mod sdf;
mod skull;

use crate::{Material, Mesh, Object};

/// temporary
pub fn built_in(_triangles: usize) -> Object {
    let sculpture = sculpture::Sculpture::new();
    let surface = mesher::surface_nets(&sculpture, 1.2);
    use rayon::prelude::*;
    let normals = surface.points_mm.par_iter().map(|&p| sculpture.normal(p)).collect();
    let uvs = surface.points_mm.iter().map(|p| glam::Vec2::new(p.x, p.y) / 500.0 + 0.5).collect();
    let mesh = Mesh { positions_mm: surface.points_mm, normals, triangles: surface.triangles, uvs, tangents: vec![], ..Mesh::default() };
    Object::new("head", mesh, Material::default())
}
