//! Packets from the lights, counted where they leave.

use super::Estimator;
use crate::transport::exitance::Entrances;
use crate::transport::path::Transport;
use cutis_scene::Object;
use glam::{DVec3, Vec2};

/// Parts of a texel's side as which triangles are cut to measure how much surface a texel holds.
const PARTS: f32 = 4.0;

/// Packets from the lights, counted where they leave.
pub(super) struct FromLights<'a, 'b> {
    entrances: Entrances<'a, 'b>,
    size: usize,
    seed: u64,
    /// Surface that each texel holds, mm².
    areas_mm2: Vec<f64>,
    /// Whether a triangle has texels: caps, whose texture is one point, have none.
    has_texels: Vec<bool>,
    sums: Vec<DVec3>,
    squares: Vec<DVec3>,
    packets: u64,
}

impl<'a, 'b> FromLights<'a, 'b> {
    pub(super) fn new(transport: &'b Transport<'a>, size: usize, seed: u64) -> Self {
        let object = &transport.scene.objects[0];
        let triangles = 0..object.mesh.triangles.len();
        let nothing = vec![DVec3::ZERO; size * size];
        Self {
            entrances: Entrances::new(transport),
            size,
            seed,
            areas_mm2: areas_mm2(object, size),
            has_texels: triangles.map(|triangle| has_texels(object, triangle)).collect(),
            sums: nothing.clone(),
            squares: nothing,
            packets: 0,
        }
    }
}

impl Estimator for FromLights<'_, '_> {
    fn add(&mut self, first: u64, count: u64) -> u64 {
        let Self { entrances, size, seed, has_texels, sums, squares, .. } = self;
        let per_sample = (*size * *size) as u64;
        self.packets += count * per_sample;
        entrances.walk(*seed, first * per_sample, count * per_sample, |exit| {
            if exit.object == 0 && has_texels[exit.triangle as usize] {
                let texel = texel_of(exit.atlas_uv, *size);
                sums[texel] += exit.flux;
                squares[texel] += exit.flux * exit.flux;
            }
        })
    }

    fn texel(&self, texel: usize) -> (DVec3, DVec3) {
        let per = self.packets as f64 * self.areas_mm2[texel];
        if per <= 0.0 {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        // Exits are rare and independent: the variance of their sum is the sum of their squares.
        (self.sums[texel] / per, self.squares[texel].map(f64::sqrt) / per)
    }

    fn state(&self) -> Vec<u8> {
        [bytemuck::cast_slice(&self.sums), bytemuck::cast_slice(&self.squares)].concat()
    }

    fn restore(&mut self, samples: u64, state: &[u8]) {
        let (sums, squares) = state.split_at(state.len() / 2);
        bytemuck::cast_slice_mut(&mut self.sums).copy_from_slice(sums);
        bytemuck::cast_slice_mut(&mut self.squares).copy_from_slice(squares);
        self.packets = samples * (self.size * self.size) as u64;
    }
}

fn has_texels(object: &Object, triangle: usize) -> bool {
    let [a, b, c] = object.mesh.corner_atlas_uvs(triangle);
    (b - a).perp_dot(c - a) != 0.0
}

/// Area of the surface in each texel, mm²: triangles are cut into parts smaller than a texel.
pub(super) fn areas_mm2(object: &Object, size: usize) -> Vec<f64> {
    let mut areas = vec![0.0; size * size];
    for triangle in (0..object.mesh.triangles.len()).filter(|&triangle| has_texels(object, triangle)) {
        let [a, b, c] = object.mesh.corner_atlas_uvs(triangle);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let parts = ((longest * size as f32 * PARTS).ceil() as usize).clamp(1, 4 * size);
        let share = f64::from(object.mesh.area_mm2(triangle)) / (parts * parts) as f64;
        for i in 0..parts {
            // Along the side: small triangles that stand up, and between them those upside down.
            for j in 0..parts - i {
                let at = |third: f32| {
                    (a * (parts as f32 - (i + j) as f32 - 2.0 * third)
                        + b * (i as f32 + third)
                        + c * (j as f32 + third))
                        / parts as f32
                };
                areas[texel_of(at(1.0 / 3.0), size)] += share;
                if i + j + 1 < parts {
                    areas[texel_of(at(2.0 / 3.0), size)] += share;
                }
            }
        }
    }
    areas
}

/// The texel at a place of the atlas; beyond it, it repeats.
fn texel_of(uv: Vec2, size: usize) -> usize {
    let place = |share: f32| ((share.rem_euclid(1.0) * size as f32) as usize).min(size - 1);
    place(uv.y) * size + place(uv.x)
}
