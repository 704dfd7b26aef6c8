//! Planes of any layout on the texture, cut or not, tubes, and light that has flowed over them.
#![allow(dead_code, reason = "every test binary uses its own part")]

use cutis_render::Silent;
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::DiffusionOperator;
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::{Material, Mesh, Object};
use glam::{Mat2, Vec2, Vec2Swizzles, Vec3, Vec4};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// Half the side of the plane, mm.
pub const HALF_MM: f32 = 20.0;
/// Quads along its side.
pub const QUADS: usize = 32;

/// A plane of quads; `layout` tells the place on the texture of a place on it, -1 to 1, in a quadrant.
pub fn plane(layout: impl Fn(Vec2, [usize; 2]) -> Vec2) -> Object {
    let mut mesh = Mesh::default();
    let corner = |i: usize| 2.0 * i as f32 / QUADS as f32 - 1.0;
    for y in 0..QUADS {
        for x in 0..QUADS {
            let quadrant = [usize::from(x >= QUADS / 2), usize::from(y >= QUADS / 2)];
            let base = mesh.positions_mm.len() as u32;
            for [i, j] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let place = Vec2::new(corner(x + i), corner(y + j));
                mesh.positions_mm.push((place * HALF_MM).extend(0.0));
                mesh.uvs.push(layout(place, quadrant));
            }
            mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
    }
    Object::new("plane", mesh, Material::default())
}

/// In one piece.
pub fn whole(place: Vec2, _: [usize; 2]) -> Vec2 {
    0.5 + 0.47 * place
}

/// Slanted and stretched.
pub fn slanted(place: Vec2, _: [usize; 2]) -> Vec2 {
    0.5 + Vec2::new(0.3 * place.x + 0.15 * place.y, 0.42 * place.y)
}

/// Four pieces, each turned by another angle.
pub fn in_four(place: Vec2, [i, j]: [usize; 2]) -> Vec2 {
    let middle = Vec2::new(i as f32 - 0.5, j as f32 - 0.5);
    let turn = Mat2::from_angle([0.0, FRAC_PI_2, 0.4, 2.6][i + 2 * j]);
    0.5 + 0.5 * middle + turn * (place - middle) * 0.33
}

/// Four pieces, upright, each three quarters of a texel from its neighbours.
pub fn upright(place: Vec2, [i, j]: [usize; 2]) -> Vec2 {
    let middle = Vec2::new(i as f32 - 0.5, j as f32 - 0.5);
    0.5 + 0.5 * middle + (place - middle) * 0.33
}

/// Bent: stretched more and more to the right, and turned towards the top.
pub fn bent(place: Vec2, _: [usize; 2]) -> Vec2 {
    let x = place.x + 0.15 * place.x * place.x + 0.1 * place.x * place.y;
    0.5 + Vec2::new(0.36 * x, 0.42 * (place.y + 0.1 * place.y * place.x * place.x) + 0.03 * x)
}

/// A strip of 2.5 mm in the middle with a third of the texture: texels there are a seventh as wide as beside it.
pub fn squeezed(place: Vec2, _: [usize; 2]) -> Vec2 {
    const STRIP: f32 = 1.0 / 16.0;
    let beside = (place.x.abs() - STRIP).max(0.0) / (1.0 - STRIP);
    let x = 0.3 * place.x.clamp(-STRIP, STRIP) / STRIP + 0.64 * beside.copysign(place.x);
    0.5 + 0.5 * Vec2::new(x, 0.94 * place.y)
}

/// The same, turned on the texture and slanted, so that slivers lie along no axis.
pub fn squeezed_and_turned(place: Vec2, quadrant: [usize; 2]) -> Vec2 {
    let p = squeezed(place, quadrant) - 0.5;
    0.5 + Mat2::from_angle(0.4) * Vec2::new(p.x, p.y + 0.4 * p.x) * 0.62
}

/// The other way round: squeezed along v, with corners off by half a texel of 512 at random, so that no two quads have slivers of quite
/// one direction.
pub fn squeezed_along_v(place: Vec2, quadrant: [usize; 2]) -> Vec2 {
    let number = ((place.x * 64.0).round() as i32 * 7919 + (place.y * 64.0).round() as i32) as usize;
    squeezed(place.yx(), quadrant).yx() + (Vec2::new(noise(number, 1), noise(number, 2)) - 0.5) / 512.0
}

/// Cut at random into pieces, each turned by a random angle and placed on a square of its own.
pub fn in_pieces(count: usize, seed: u32) -> Object {
    let seeds: Vec<Vec2> =
        (0..count).map(|i| 2.0 * Vec2::new(noise(i, seed), noise(i, seed + 1)) - 1.0).collect();
    let across = (count as f32).sqrt().ceil() as usize;
    let mut mesh = plane(whole).mesh;
    // A piece has the quads nearest to its middle; it is as wide as the widest.
    let piece_of = |quad: usize| {
        let middle =
            Vec2::new((quad % QUADS) as f32 + 0.5, (quad / QUADS) as f32 + 0.5) * 2.0 / QUADS as f32 - 1.0;
        let apart = |i: &usize| (seeds[*i] - middle).length();
        (0..count).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap()
    };
    let pieces: Vec<usize> = (0..QUADS * QUADS).map(piece_of).collect();
    let place = |v: usize| mesh.positions_mm[v].truncate() / HALF_MM;
    let reach = |piece: usize| {
        let own = (0..4 * pieces.len()).filter(|v| pieces[v / 4] == piece);
        own.map(|v| (place(v) - seeds[piece]).length()).fold(0.0, f32::max)
    };
    let widest = (0..count).map(reach).fold(0.0, f32::max);
    let uvs = (0..4 * pieces.len()).map(|v| {
        let piece = pieces[v / 4];
        let square = Vec2::new((piece % across) as f32 + 0.5, (piece / across) as f32 + 0.5);
        let turn = Mat2::from_angle(std::f32::consts::TAU * noise(piece, seed + 2));
        (square + turn * (place(v) - seeds[piece]) * 0.47 / widest) / across as f32
    });
    mesh.uvs = uvs.collect();
    Object::new("pieces", mesh, Material::default())
}

/// A tube along z, cut along the line where y is 0 and x > 0.
pub fn tube(radius_mm: f32, length_mm: f32, around: usize) -> Object {
    let mut mesh = Mesh::default();
    let along = 16;
    for j in 0..=along {
        for i in 0..=around {
            let (s, t) = (i as f32 / around as f32, j as f32 / along as f32);
            // The same numbers at both ends, so that they are one line.
            let angle = std::f32::consts::TAU * (i % around) as f32 / around as f32;
            mesh.positions_mm.push(Vec3::new(
                angle.cos() * radius_mm,
                angle.sin() * radius_mm,
                t * length_mm,
            ));
            mesh.uvs.push(Vec2::new(0.02 + 0.93 * s, 0.1 + 0.37 * t));
        }
    }
    let at = |i: usize, j: usize| (j * (around + 1) + i) as u32;
    for j in 0..along {
        for i in 0..around {
            mesh.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Object::new("tube", mesh, Material::default())
}

/// A place of the surface with its light.
pub struct Lit {
    /// Where it is, mm.
    pub place_mm: Vec3,
    /// Area that it stands for, mm².
    pub area_mm2: f32,
    /// Its light.
    pub after: f32,
}

/// Light, as it is read at a few places of every triangle, after heat has flowed for a Gaussian of that variance.
pub fn flown(object: &Object, size: usize, variance_mm2: f32, light: impl Fn(Vec3) -> f32) -> Vec<Lit> {
    flown_in_pose(object, None, size, variance_mm2, light)
}

/// The same on an object that has another pose when the flow is made.
pub fn flown_in_pose(
    object: &Object,
    first_pose: Option<&Object>,
    size: usize,
    variance_mm2: f32,
    light: impl Fn(Vec3) -> f32,
) -> Vec<Lit> {
    let atlas = Atlas::new(object, size);
    let stretch_mm = stretch_mm_per_texel(object, &atlas);
    let at =
        |i: usize| atlas.surface_point(object, i).map_or(Vec4::ZERO, |p| Vec4::splat(light(p.position_mm)));
    let before = (0..size * size).map(at).collect();
    let variances_mm2 = [0.5 * variance_mm2, variance_mm2];
    let first = first_pose.unwrap_or(object);
    let mut flow = HeatFlow::new(first, &atlas, &stretch_mm_per_texel(first, &atlas), &variances_mm2);
    if first_pose.is_some() {
        flow = flow.for_all_poses();
        flow.set_pose(object);
    }
    let fields = Fields::new(vec![before], stretch_mm);
    let diffused = flow.diffuse(Arc::clone(&atlas.charts), fields, &variances_mm2, &Silent);
    let weights = [[0.6, 0.2], [0.2, 0.2], [0.2, 0.6], [1.0 / 3.0, 1.0 / 3.0]];
    let read = |triangle: usize, [b1, b2]: [f32; 2]| {
        let [a, b, c] = object.mesh.corner_atlas_uvs(triangle);
        let uv = a + (b - a) * b1 + (c - a) * b2;
        let after = diffused.sample(2, 0, uv, object.charts.of_triangle[triangle]).x;
        let place_mm = object.surface_point(triangle as u32, b1, b2).position_mm;
        Lit { place_mm, area_mm2: 0.25 * object.mesh.area_mm2(triangle), after }
    };
    (0..object.mesh.triangles.len()).flat_map(|t| weights.map(|w| read(t, w))).collect()
}

/// Any numbers, as a hash makes them: from 0 to 1.
pub fn noise(i: usize, seed: u32) -> f32 {
    let mut x = (i as u32).wrapping_mul(0x9E37_79B9) ^ seed.wrapping_mul(0x85EB_CA6B);
    for factor in [0x7FEB_352D, 0x846C_A68B] {
        x = (x ^ (x >> 15)).wrapping_mul(factor);
    }
    (x >> 8) as f32 / 16_777_216.0
}
