//! Irradiance under the surface, in texture space, with the distance through the body beside it
//! (d'Eon, Luebke & Enderton 2007, section 5.4, "Render irradiance texture").
//!
//! rgb = (Σ lights E cos visible rho_dt(cos, m) + environment) · albedo^mix, in W/m².
//! The distance to the light-facing surface rides in alpha for the first light; for more lights, in further layers.

use crate::lit_scene::Lit;
use crate::passes::ambient::Ambient;
use crate::passes::atlas::Atlas;
use crate::passes::half_size::{HalfSize, Rays};
use crate::passes::visibility::{faces, places_tried};
use crate::prepare::{FilteredEnvironment, RhoDt};
use crate::progress::Progress;
use crate::sampling::random2;
use cutis_scene::{Object, SurfacePoint};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Stream of random numbers this pass draws from; one per light from here on.
const STREAM: u32 = 0x100;

/// Everything the pass reads.
pub struct IrradianceInputs<'a> {
    /// The scene and rays against it.
    pub rays: Rays<'a>,
    /// The object whose texture is filled.
    pub object: &'a Object,
    /// Its unrolled surface.
    pub atlas: &'a Atlas,
    /// What its lights see, at half the size.
    pub half_size: &'a HalfSize<'a>,
    /// Its openness.
    pub ambient: &'a Ambient,
    /// The environment, if there is one.
    pub environment: Option<&'a FilteredEnvironment>,
    /// What its surface lets through.
    pub rho_dt: &'a RhoDt,
}

/// The filled texture.
pub struct Irradiance {
    /// Layer 0: irradiance, and distance for light 0; then distances of the other lights, four to a layer.
    pub layers: Vec<Vec<Vec4>>,
    /// For every light, the fraction of it that is seen.
    pub visibility: Vec<Vec<f32>>,
    /// For every light, its share of the irradiance that comes from lights. Empty for a single light, whose share is 1.
    pub shares: Vec<Vec<f32>>,
    /// Places of all lights that rays of the texel itself were sent to; 0 where its neighbours at half the size agree.
    pub tried: Vec<u32>,
}

/// Layer and component that hold a light's distance.
pub fn distance_slot(light: usize) -> (usize, usize) {
    if light == 0 { (0, 3) } else { (1 + (light - 1) / 4, (light - 1) % 4) }
}

/// One row of everything that is filled.
struct Row<'a> {
    layers: Vec<&'a mut [Vec4]>,
    visibility: Vec<&'a mut [f32]>,
    shares: Vec<&'a mut [f32]>,
    tried: &'a mut [u32],
}

/// Fills the texture.
pub fn irradiance(inputs: &IrradianceInputs, progress: &dyn Progress) -> Irradiance {
    let size = inputs.atlas.size;
    let lights = inputs.rays.scene.lights.len();
    let mut filled = Irradiance {
        layers: vec![vec![Vec4::ZERO; size * size]; 1 + lights.saturating_sub(1).div_ceil(4)],
        visibility: vec![vec![0.0; size * size]; lights],
        shares: vec![vec![0.0; size * size]; if lights > 1 { lights } else { 0 }],
        tried: vec![0; size * size],
    };
    progress.begin("irradiance", size as u64);
    rows(&mut filled, size).into_par_iter().enumerate().for_each(|(y, mut row)| {
        for x in 0..size {
            light_texel(inputs, x, y, &mut row);
        }
        progress.advance(1);
    });
    filled
}

fn rows(filled: &mut Irradiance, size: usize) -> Vec<Row<'_>> {
    let row = |tried| Row { layers: Vec::new(), visibility: Vec::new(), shares: Vec::new(), tried };
    let mut rows: Vec<Row> = filled.tried.chunks_mut(size).map(row).collect();
    for layer in &mut filled.layers {
        rows.iter_mut().zip(layer.chunks_mut(size)).for_each(|(row, slice)| row.layers.push(slice));
    }
    for plane in &mut filled.visibility {
        rows.iter_mut().zip(plane.chunks_mut(size)).for_each(|(row, slice)| row.visibility.push(slice));
    }
    for plane in &mut filled.shares {
        rows.iter_mut().zip(plane.chunks_mut(size)).for_each(|(row, slice)| row.shares.push(slice));
    }
    rows
}

fn light_texel(inputs: &IrradianceInputs, x: usize, y: usize, row: &mut Row) {
    let texel = y * inputs.atlas.size + x;
    let Some(point) = inputs.atlas.surface_point(inputs.object, texel) else { return };
    let material = &inputs.object.material;
    let normal = shading_normal(inputs.object, &point);
    let (rho_s, roughness) = (material.rho_s.at(point.map_uv), material.roughness.at(point.map_uv));
    let chart = inputs.atlas.charts.chart[texel];
    let mut from_lights = Vec3::ZERO;
    for (l, light) in inputs.rays.scene.lights.iter().enumerate() {
        let towards = light.sample(point.position_mm);
        let Seen { visible, tried } = visibility(inputs, l, &point, chart, [x, y]);
        // Relief may turn a normal away from a light that the smooth surface faces.
        let cos = normal.dot(towards.dir_to_light).max(0.0);
        let entered = towards.irradiance_w_per_m2 * (cos * visible * inputs.rho_dt.at(cos, roughness, rho_s));
        from_lights += entered;
        row.visibility[l][x] = visible;
        row.tried[x] += tried;
        let (layer, component) = distance_slot(l);
        if !faces(&point, light) {
            let near = inputs.half_size.distance_mm(l, point.atlas_uv, chart);
            row.layers[layer][x][component] = near.unwrap_or_else(|| inputs.rays.distance_mm(light, &point));
        }
        if let Some(share) = row.shares.get_mut(l) {
            share[x] = entered.element_sum();
        }
    }
    let whole = from_lights.element_sum().max(f32::MIN_POSITIVE);
    row.shares.iter_mut().for_each(|share| share[x] /= whole);
    let from_environment = from_environment(inputs.environment, inputs.ambient, &point, normal, chart)
        * inputs.rho_dt.mean(roughness, rho_s);
    let film = material.film_inwards(point.map_uv);
    row.layers[0][x] = ((from_lights + from_environment) * film).extend(row.layers[0][x].w);
}

/// How a light is seen.
struct Seen {
    /// Fraction of it.
    visible: f32,
    /// Places of it that were tried for that.
    tried: u32,
}

/// What the place sees of a light; nothing where the smooth surface faces away from it.
fn visibility(
    inputs: &IrradianceInputs,
    l: usize,
    point: &SurfacePoint,
    chart: u32,
    [x, y]: [usize; 2],
) -> Seen {
    let IrradianceInputs { rays, half_size, .. } = inputs;
    let light = &rays.scene.lights[l];
    if !faces(point, light) {
        return Seen { visible: 0.0, tried: 0 };
    }
    if let Some(visible) = half_size.visible(l, point.atlas_uv, chart, light.has_extent()) {
        return Seen { visible, tried: 0 };
    }
    let shift = random2(x as u32, y as u32, STREAM + l as u32, rays.settings.seed);
    let visible = rays.visible(light, point, shift).unwrap_or(0.0);
    Seen { visible, tried: places_tried(light, rays.settings.shadow_samples) }
}

/// What falls on a place from all around, W/m².
pub fn from_environment(
    environment: Option<&FilteredEnvironment>,
    ambient: &Ambient,
    point: &SurfacePoint,
    normal: Vec3,
    chart: u32,
) -> Vec3 {
    let Some(environment) = environment else { return Vec3::ZERO };
    let (bent, open) = ambient.at(point.atlas_uv, chart, point.normal, normal);
    environment.irradiance(bent) * open
}

/// Irradiance under the surface of object number `object` at any place of it, W/m²: what the texture holds for its texels, by
/// the same shadows and the same openness.
pub fn irradiance_at(lit: Lit, object: usize, point: &SurfacePoint, chart: u32) -> Vec3 {
    let (maps, object) = (&lit.maps[object], &lit.scene.objects[object]);
    let material = &object.material;
    let normal = shading_normal(object, point);
    let (rho_s, roughness) = (material.rho_s.at(point.map_uv), material.roughness.at(point.map_uv));
    let around = from_environment(lit.environment, &maps.ambient, point, normal, chart);
    let mut sum = around * maps.rho_dt.mean(roughness, rho_s);
    for (light, visibility) in lit.scene.lights.iter().zip(&maps.visibility) {
        let towards = light.sample(point.position_mm);
        let cos = normal.dot(towards.dir_to_light).max(0.0);
        let visible = maps.atlas.charts.sample(visibility, point.atlas_uv, chart).unwrap_or(0.0);
        sum += towards.irradiance_w_per_m2 * (cos * visible * maps.rho_dt.at(cos, roughness, rho_s));
    }
    sum * material.film_inwards(point.map_uv)
}

/// The normal with the material's relief.
pub fn shading_normal(object: &Object, point: &SurfacePoint) -> Vec3 {
    match &object.material.normal {
        Some(map) => map.at(point.map_uv, point.normal, point.tangent),
        None => point.normal,
    }
}
