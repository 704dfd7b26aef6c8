//! One object: its mesh and textures, and the steps that fill them.

use super::SceneError;
use super::charts::{ChartPyramid, surface_texture};
use super::geometry::Geometry;
use super::material::MaterialMaps;
use super::one_blur;
use super::shared::Shared;
use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::depth_map::DepthMapInputs;
use crate::passes::diffusion::{like_level, shortened};
use crate::passes::heat_flow::GpuHeatFlow;
use crate::passes::inside::Inside;
use crate::passes::irradiance::IrradianceInputs;
use crate::passes::levels::{Level, Levels};
use crate::passes::resolve::ResolveInputs;
use crate::passes::shares::ShareGroup;
use crate::passes::transmission::TransmissionInputs;
use crate::passes::visibility::{Group, visibility_map};
use crate::passes::{LIGHTS_TOGETHER, Passes, heat_flow, openness};
use crate::step::Step;
use bytemuck::Zeroable;
use cutis_render::lit_scene::opaque_mm;
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::diffusion::{Action, median_texel_mm, plan};
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::seam_map::Seams;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_render::passes::transmission::smoothing_steps;
use cutis_render::prepare::rho_dt::{COSINES, ROUGHNESSES};
use cutis_render::prepare::{Kernel, RhoDt};
use cutis_render::{Settings, TechniqueName};
use cutis_scene::Object;
use glam::Vec4;
use std::sync::Arc;
use wgpu::TextureFormat as Format;

/// What is computed once for an object, by cutis-render.
#[derive(Debug)]
pub struct Prepared {
    /// The surface unrolled.
    pub atlas: Atlas,
    /// Texel size that half of the surface falls below, mm.
    pub texel_mm: f32,
    /// Diffusion kernel.
    pub kernel: Kernel,
    /// What the surface lets through.
    pub rho_dt: RhoDt,
    /// How heat flows over it, where light is spread like that.
    pub flow: Option<HeatFlow>,
}

impl Prepared {
    /// For an atlas of `size` texels.
    pub fn new(object: &Object, size: u32, kernel: Kernel, settings: &Settings) -> Self {
        let atlas = Atlas::new(object, size as usize);
        let stretch_mm = stretch_mm_per_texel(object, &atlas);
        let texel_mm = median_texel_mm(&atlas.charts, &stretch_mm);
        let flow = settings
            .lets_heat_flow()
            .then(|| HeatFlow::new(object, &atlas, &stretch_mm, &kernel.variances_mm2).for_all_poses());
        Self { atlas, texel_mm, kernel, rho_dt: RhoDt::new(object.material.f0), flow }
    }
}

/// An object's textures.
#[derive(Debug)]
pub struct ObjectMaps {
    /// Its mesh.
    pub geometry: Geometry,
    /// Its diffusion kernel.
    pub kernel: Kernel,
    /// Its unrolled surface.
    pub atlas: AtlasMaps,
    /// The light before and after every Gaussian.
    pub levels: Levels,
    /// Fraction of each light that is seen.
    pub visibility: Map,
    /// Sum of all Gaussians, in the first layer. Before, light on its way passes through here: distances, and what is blurred
    /// along u only.
    pub local: Map,
    /// Light that came through, at half the size.
    pub transmission: Map,
    /// Bent normal and openness.
    pub ambient: Map,
    /// Its charts in all sizes.
    pub charts: ChartPyramid,
    /// Where its charts meet.
    pub seams: Seams,
    /// How heat flows over it, where light is spread like that.
    pub flow: Option<GpuHeatFlow>,
    material: MaterialMaps,
    rho_dt: Map,
    technique: TechniqueName,
    /// What the technique knows of it.
    inside: Inside,
}

/// Steps of one object.
#[derive(Debug, Default)]
pub struct ObjectSteps {
    /// When the geometry has changed.
    pub surface: Vec<Step>,
    /// In every frame, after the lights' maps.
    pub light: Vec<Step>,
}

impl ObjectMaps {
    /// Makes the textures of object number `number` and the steps that fill them.
    ///
    /// # Errors
    /// If something is larger than the device takes.
    pub fn new(
        gpu: &Gpu,
        passes: &Passes,
        shared: &Shared,
        number: u32,
        object: &Object,
        prepared: Prepared,
        settings: &Settings,
    ) -> Result<(Self, ObjectSteps), SceneError> {
        let Prepared { atlas: unrolled, texel_mm, kernel, rho_dt, flow } = prepared;
        let size = unrolled.size as u32;
        let separable = || shortened(&plan(unrolled.size, texel_mm, &kernel.variances_mm2), texel_mm);
        let plan = flow.as_ref().map_or_else(separable, heat_flow::actions);
        tracing::debug!("plan of '{}' with texels of {texel_mm} mm: {plan:?}", object.name);
        let charts = ChartPyramid::new(gpu, &unrolled.charts, halvings(&plan));
        let seams = Seams::of(object, Arc::clone(&unrolled.charts));
        let geometry = Geometry::new(gpu, object)?;
        let inside = Inside::new(gpu, object, kernel.total(), settings)?;
        let material = MaterialMaps::new(gpu, &object.material)?;
        let atlas = AtlasMaps::new(gpu, object, &unrolled);
        let surface = surface_texture(gpu, &unrolled);
        let mut steps = ObjectSteps::default();
        steps.surface.push(passes.stretch.step(gpu, &geometry));
        let samplers = &passes.samplers;
        steps.surface.push(passes.atlas.step(
            gpu,
            samplers,
            (&geometry, &material),
            (&surface, &charts.sizes[0]),
            &atlas,
        ));
        let levels = if settings.light_inside() == TechniqueName::TextureBlur {
            Levels::of_one_blur(gpu, &charts.sizes, light_layers(shared))
        } else {
            Levels::new(gpu, &charts.sizes, light_layers(shared), &plan)
        };
        let mut maps = Self {
            visibility: visibility_map(gpu, size, shared.light_count),
            local: like_level(gpu, "local", size, &levels.all[0].light),
            transmission: Map::square(gpu, "transmission", size / 2, 1, Format::Rgba16Float),
            ambient: ambient_texture(gpu, size >> openness::HALVINGS, shared),
            rho_dt: rho_dt_texture(gpu, &rho_dt),
            levels,
            geometry,
            kernel,
            atlas,
            seams,
            charts,
            flow: flow.map(|flow| GpuHeatFlow::new(gpu, flow)),
            material,
            technique: settings.light_inside(),
            inside,
        };
        let light = Lighting { gpu, passes, shared, number, maps: &maps };
        let shares = light.steps(&plan, &mut steps);
        if maps.technique == TechniqueName::TextureSpace {
            maps.add_spread(gpu, passes, shared, (number, texel_mm), shares.as_ref(), &mut steps);
        }
        if maps.technique == TechniqueName::TextureBlur {
            let subject =
                one_blur::Subject { object, number, atlas: &unrolled, texel_mm, shares: shares.as_ref() };
            steps.light.extend(one_blur::steps(gpu, passes, shared, &maps, &subject, settings)?);
        }
        Ok((maps, steps))
    }

    /// Adds up the Gaussians, and finds what comes through.
    fn add_spread(
        &mut self,
        gpu: &Gpu,
        passes: &Passes,
        shared: &Shared,
        (number, texel_mm): (u32, f32),
        shares: Option<&Map>,
        steps: &mut ObjectSteps,
    ) {
        let gather = passes.gather.step(gpu, &self.kernel, &self.levels, &self.charts, self.local.view());
        steps.light.push(gather);
        let inputs = TransmissionInputs {
            object: number,
            lights: &shared.lights,
            kernel: &self.kernel,
            atlas: &self.atlas,
            charts: &self.charts,
            shadows: &shared.shadows,
            shares,
            levels: &self.levels,
        };
        let spare = Map::square(gpu, "transmission", self.transmission.width(), 1, Format::Rgba16Float);
        let both = [self.transmission.clone(), spare];
        let (more, result) = passes.transmission.steps(gpu, &inputs, &smoothing_steps(2.0 * texel_mm), both);
        steps.light.extend(more);
        self.transmission = result;
    }

    /// What the final pass reads of this object; `gathered` is what was gathered for the picture, for techniques that do.
    pub fn resolve_inputs<'a>(
        &'a self,
        passes: &'a Passes,
        shared: &'a Shared,
        gathered: Option<&'a Map>,
    ) -> ResolveInputs<'a> {
        ResolveInputs {
            samplers: &passes.samplers,
            camera: &shared.camera,
            lights: &shared.lights,
            slides: &shared.slides.texels,
            environment: &shared.environment,
            geometry: &self.geometry,
            material: &self.material,
            charts: [0, openness::HALVINGS].map(|halvings| &self.charts.sizes[halvings]),
            technique: self.technique,
            inside: self.inside.bound(self, shared, gathered),
            visibility: &self.visibility,
            ambient: &self.ambient,
            rho_dt: &self.rho_dt,
        }
    }

    /// What the depth maps read of this object, which is number `object`.
    pub fn depth_map_inputs<'a>(
        &'a self,
        passes: &'a Passes,
        shared: &'a Shared,
        object: u32,
    ) -> DepthMapInputs<'a> {
        DepthMapInputs {
            samplers: &passes.samplers,
            lights: &shared.lights,
            object,
            geometry: &self.geometry,
            material: &self.material,
            rho_dt: &self.rho_dt,
        }
    }

    /// The stretch in the form of a level.
    pub fn stretch_level(&self) -> Level {
        Level { charts: self.charts.sizes[0].clone(), light: self.atlas.stretch.clone() }
    }
}

/// From lights to blurred irradiance.
struct Lighting<'a> {
    gpu: &'a Gpu,
    passes: &'a Passes,
    shared: &'a Shared,
    number: u32,
    maps: &'a ObjectMaps,
}

impl Lighting<'_> {
    /// Adds its steps by a plan. Gives each light's share, where there are several.
    fn steps(&self, plan: &[Action], all: &mut ObjectSteps) -> Option<Map> {
        let steps = &mut all.light;
        let Self { gpu, passes, shared, maps, .. } = *self;
        let size = maps.charts.sizes[0].size;
        let groups = shared.light_count.div_ceil(LIGHTS_TOGETHER) as u32;
        let many = shared.light_count > 1;
        let light = &maps.levels.all[0].light;
        // With several lights all distances live in further layers of the light, and this stays empty. One light's are read
        // before anything is blurred.
        let empty = || Map::square(gpu, "no distance", 1, 1, Format::Rgba16Float);
        let distances = if many { empty() } else { maps.local.clone() };
        for group in 0..groups {
            let target = if many { &light.layers[1 + group as usize] } else { distances.view() };
            steps.push(self.visibility(group, target));
        }
        let inputs = IrradianceInputs {
            samplers: &passes.samplers,
            lights: &shared.lights,
            slides: &shared.slides.texels,
            material: &maps.material,
            environment: &shared.environment,
            atlas: &maps.atlas,
            charts: &maps.charts.sizes[0],
            visibility: &maps.visibility,
            distances_mm: &distances,
            ambient: (&maps.ambient, &maps.charts.sizes[openness::HALVINGS]),
            rho_dt: &maps.rho_dt,
        };
        steps.push(passes.irradiance.step(gpu, &inputs, &light.layers[0]));
        let shares = many.then(|| {
            let shares = Map::square(gpu, "shares", size, groups, Format::Rgba16Float);
            steps.extend((0..groups).map(|group| {
                let first_light = group * LIGHTS_TOGETHER as u32;
                let numbers = ShareGroup { first_light, ..ShareGroup::zeroed() };
                passes.shares.step(gpu, numbers, &inputs, &shares.layers[group as usize])
            }));
            shares
        });
        if let Some(flow) = &maps.flow {
            steps.extend(passes.heat_flow.steps(gpu, &maps.charts.sizes, &maps.levels, flow));
            return shares;
        }
        let (charts, maps_between) = (&maps.charts.sizes, (&maps.atlas.stretch, &maps.local));
        let diffusion = passes.diffusion.steps(gpu, charts, &maps.levels, maps_between, plan);
        steps.extend(diffusion.blurs);
        all.surface.extend(diffusion.taps);
        shares
    }

    fn visibility(&self, group: u32, distances: &View) -> Step {
        let Self { gpu, passes, shared, maps, .. } = *self;
        let first = group as usize * LIGHTS_TOGETHER;
        let numbers = Group {
            first_light: first as u32,
            light_count: (shared.light_count - first).min(LIGHTS_TOGETHER) as u32,
            object: self.number,
            samples: shared.shadow_samples,
            opaque_mm: opaque_mm(&maps.kernel),
            thickness_scale: maps.material.thickness_scale,
            ..Group::zeroed()
        };
        let targets = [&maps.visibility.layers[group as usize], distances];
        passes.visibility.step(
            gpu,
            (numbers, shared.any_extent),
            (&shared.lights, &shared.shadows),
            &maps.atlas,
            &maps.charts.sizes[0],
            targets,
        )
    }
}

/// Layers of the light: with several lights, their distances ride in further ones.
fn light_layers(shared: &Shared) -> u32 {
    let many = shared.light_count > 1;
    if many { 1 + shared.light_count.div_ceil(LIGHTS_TOGETHER) as u32 } else { 1 }
}

/// How often charts are halved: for the plan and once more for its stretch, and for the map of occlusion.
fn halvings(plan: &[Action]) -> usize {
    let of_light = plan.iter().filter(|action| **action == Action::Halve).count();
    (of_light + 1).max(openness::HALVINGS)
}

/// Where openness goes; open to all sides where nobody asks for it.
fn ambient_texture(gpu: &Gpu, size: u32, shared: &Shared) -> Map {
    let map = Map::square(gpu, "openness", size, 1, openness::FORMAT);
    if shared.surroundings.is_none() {
        map.write(gpu, 0, bytemuck::cast_slice(&vec![Vec4::W; (size * size) as usize]));
    }
    map
}

/// The table of rho_dt: the means over the hemisphere are one more column.
fn rho_dt_texture(gpu: &Gpu, rho_dt: &RhoDt) -> Map {
    let rows = rho_dt.albedos().chunks_exact(COSINES).zip(rho_dt.mean_albedos());
    let texels = rows.flat_map(|(row, &mean)| row.iter().copied().chain([mean]).map(Vec4::splat));
    Map::of_values(gpu, "rho_dt", [COSINES as u32 + 1, ROUGHNESSES as u32], texels)
}
