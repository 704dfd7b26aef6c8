//! The final pass: from blurred irradiance to radiance, and what lies behind everything. The twin of cutis-render's
//! `resolve`.

use crate::Gpu;
use crate::map::Map;
use crate::passes::levels::Level;
use crate::passes::{SLIDES, Samplers};
use crate::pipeline::{Binding, Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::scene::environment::EnvironmentMaps;
use crate::scene::geometry::Geometry;
use crate::scene::material::MaterialMaps;
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::TechniqueName;
use std::sync::OnceLock;
use wgpu::TextureFormat as Format;

/// What the picture's samples are kept as.
pub const PICTURE: Format = Format::Rgba16Float;
/// What a layer's samples are kept as.
pub const LAYER: Format = Format::Rgba32Float;

/// A layer beside the picture; the twin of `Wanted` in `layer.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Wanted {
    /// [`LayerKind`] as a number.
    pub layer: u32,
    /// Samples of a pixel.
    pub samples: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// What a layer shows; the numbers are those of the constants in `layer.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LayerKind {
    /// Irradiance, blurred or not.
    Level = 0,
    /// Distances towards four lights.
    Distances = 1,
    /// Distance towards the only light.
    DistanceOfOne = 2,
    /// Shading normal.
    Normal = 3,
    /// Diffuse colour.
    Albedo = 4,
    /// Radiance reflected by the surface.
    Specular = 5,
    /// Radiance that came through the body.
    Transmission = 6,
    /// Radiance of light that has been inside.
    Diffuse = 7,
    /// Light that leaves, W/m².
    Exitance = 8,
    /// Number of the chart.
    Charts = 9,
    /// Two numbers of a texel, as they are.
    Texel = 10,
    /// Samples of the pixel, of which each adds as many: the mean counts those that met the surface.
    Samples = 11,
    /// Distances through bodies that the technique takes itself.
    Ways = 12,
}

/// Everything the pass reads.
#[derive(Debug, Clone)]
pub struct ResolveInputs<'a> {
    /// How textures are read.
    pub samplers: &'a Samplers,
    /// Where the picture is taken from.
    pub camera: &'a wgpu::Buffer,
    /// All lights.
    pub lights: &'a wgpu::Buffer,
    /// What projectors among them throw.
    pub slides: &'a wgpu::Buffer,
    /// The filtered environment.
    pub environment: &'a EnvironmentMaps,
    /// The object's mesh.
    pub geometry: &'a Geometry,
    /// What it is made of.
    pub material: &'a MaterialMaps,
    /// Its charts, and those of the map of openness.
    pub charts: [&'a ChartTexture; 2],
    /// Which technique draws.
    pub technique: TechniqueName,
    /// What that technique's part reads.
    pub inside: Vec<(u32, Bound<'a>)>,
    /// Fraction of each light that is seen.
    pub visibility: &'a Map,
    /// Openness.
    pub ambient: &'a Map,
    /// Table of what the surface lets through.
    pub rho_dt: &'a Map,
}

impl<'a> ResolveInputs<'a> {
    /// What is read to light a place of the surface, whoever looks at it.
    pub fn lit_surface(&self) -> Vec<(u32, Bound<'a>)> {
        let Self { samplers, environment, geometry, material, charts, .. } = *self;
        vec![
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (3, Bound::Buffer(self.lights)),
            (4, Bound::Buffer(&material.numbers)),
            (5, Bound::Buffer(&environment.numbers)),
            (6, Bound::Texture(charts[0].map.view())),
            (10, Bound::Texture(&self.visibility.array)),
            (11, Bound::Texture(self.ambient.view())),
            (12, Bound::Texture(charts[1].map.view())),
            (14, Bound::Texture(self.rho_dt.view())),
            (15, Bound::Texture(material.albedo.view())),
            (16, Bound::Texture(material.relief.view())),
            (17, Bound::Texture(material.rho_s.view())),
            (18, Bound::Texture(material.roughness.view())),
            (19, Bound::Sampler(&samplers.linear)),
            (20, Bound::Sampler(&samplers.repeating)),
            (21, Bound::Sampler(&samplers.around_sky)),
            (SLIDES, Bound::Buffer(self.slides)),
        ]
    }
}

/// What is drawn into.
#[derive(Debug, Clone, Copy)]
pub struct Canvas<'a> {
    /// Samples of the picture or of a layer.
    pub samples: &'a Map,
    /// Depths of them.
    pub depth: &'a Map,
    /// What is there before the first object: a colour; none if the sky has been drawn.
    pub clear: Option<wgpu::Color>,
    /// Whether nothing was drawn there before.
    pub first: bool,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct ResolvePass {
    nearest: Pipeline,
    sky: Pipeline,
    /// Of every technique, in the order of `TechniqueName::ALL`.
    techniques: [OnceLock<Shading>; TechniqueName::ALL.len()],
}

/// What shades by one technique.
#[derive(Debug)]
struct Shading {
    shade: Pipeline,
    show: Pipeline,
}

impl ResolvePass {
    /// Compiles what all techniques need; what shades by one of them is compiled when it is used first.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            nearest: pipeline(gpu, shaders::RESOLVE, ["see", "shade"], &[], true),
            sky: pipeline(gpu, shaders::SKY, ["cover_picture", "see_sky"], &[PICTURE], false),
            techniques: [const { OnceLock::new() }; TechniqueName::ALL.len()],
        }
    }

    fn shading(&self, gpu: &Gpu, technique: TechniqueName) -> &Shading {
        let number = TechniqueName::ALL.iter().position(|one| *one == technique).unwrap_or_default();
        self.techniques[number].get_or_init(|| {
            let source = shaders::resolve(technique);
            Shading {
                shade: pipeline(gpu, source, ["see", "shade"], &[PICTURE], true),
                show: pipeline(gpu, source, ["see", "show"], &[LAYER], true),
            }
        })
    }

    /// Finds out where an object is nearest, so that nothing is shaded that will be hidden.
    pub fn nearest_step(
        &self,
        gpu: &Gpu,
        camera: &wgpu::Buffer,
        geometry: &Geometry,
        depth: &Map,
        first: bool,
    ) -> Step {
        let bound = [
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (2, Bound::Buffer(camera)),
        ];
        Step::Draw(Draw {
            pipeline: self.nearest.clone(),
            bind_groups: vec![self.nearest.bind(gpu, 0, &bound)],
            targets: Vec::new(),
            depth: Some((depth.view().clone(), first)),
            clear: None,
            indices: None,
            vertices: 3 * geometry.triangle_count,
            instances: 1,
        })
    }

    /// Shades an object where it is nearest.
    pub fn step(&self, gpu: &Gpu, inputs: &ResolveInputs, canvas: &Canvas) -> Step {
        let shade = &self.shading(gpu, inputs.technique).shade;
        draw(shade, vec![bind(gpu, shade, inputs)], inputs, canvas, false)
    }

    /// Draws a layer of an object, `samples` in a pixel; `level` is what layers of textures are read from.
    pub fn layer_step(
        &self,
        gpu: &Gpu,
        inputs: &ResolveInputs,
        (kind, samples): (LayerKind, u32),
        level: &Level,
        canvas: &Canvas,
    ) -> Step {
        let wanted = Wanted { layer: kind as u32, samples, ..Wanted::zeroed() };
        let wanted = gpu.uniform("wanted", &wanted);
        let more = [
            (0, Bound::Buffer(&wanted)),
            (1, Bound::Texture(&level.light.array)),
            (2, Bound::Texture(level.charts.map.view())),
        ];
        let show = &self.shading(gpu, inputs.technique).show;
        let bind_groups = vec![bind(gpu, show, inputs), show.bind(gpu, 1, &more)];
        draw(show, bind_groups, inputs, canvas, canvas.first)
    }

    /// Draws the environment behind everything.
    pub fn sky_step(
        &self,
        gpu: &Gpu,
        samplers: &Samplers,
        camera: &wgpu::Buffer,
        environment: &EnvironmentMaps,
        sky: &Map,
        samples: &Map,
    ) -> Step {
        let bound = [
            (0, Bound::Buffer(camera)),
            (1, Bound::Buffer(&environment.numbers)),
            (2, Bound::Texture(sky.view())),
            (3, Bound::Sampler(&samplers.around_sky)),
        ];
        Step::Draw(Draw {
            pipeline: self.sky.clone(),
            bind_groups: vec![self.sky.bind(gpu, 0, &bound)],
            targets: vec![samples.view().clone()],
            depth: None,
            clear: None,
            indices: None,
            vertices: 3,
            instances: 1,
        })
    }
}

fn pipeline(
    gpu: &Gpu,
    source: &str,
    entries: [&'static str; 2],
    targets: &[Format],
    depth: bool,
) -> Pipeline {
    let name = "resolve";
    Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth })
}

fn bind(gpu: &Gpu, pipeline: &Pipeline, inputs: &ResolveInputs) -> Binding {
    let mut bound = inputs.lit_surface();
    bound.extend([
        (2, Bound::Buffer(inputs.camera)),
        (13, Bound::Texture(&inputs.environment.reflections.array)),
    ]);
    bound.extend_from_slice(&inputs.inside);
    pipeline.bind(gpu, 0, &bound)
}

fn draw(
    pipeline: &Pipeline,
    bind_groups: Vec<Binding>,
    inputs: &ResolveInputs,
    canvas: &Canvas,
    clear_depth: bool,
) -> Step {
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups,
        targets: vec![canvas.samples.view().clone()],
        depth: Some((canvas.depth.view().clone(), clear_depth)),
        clear: canvas.clear.filter(|_| canvas.first),
        indices: None,
        vertices: 3 * inputs.geometry.triangle_count,
        instances: 1,
    })
}
