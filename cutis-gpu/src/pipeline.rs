//! Pipelines: shader, targets and how to bind what the shader reads.

use crate::Gpu;
use crate::cost::taps_of;
use crate::map::View;

/// What a pipeline is made from.
#[derive(Debug, Clone, Copy)]
pub struct Blueprint<'a> {
    /// Name of the pass.
    pub name: &'static str,
    /// WGSL.
    pub source: &'a str,
    /// Entry points of the vertex and the fragment shader; the latter is not run where there are no targets.
    pub entries: [&'static str; 2],
    /// Formats that are drawn into.
    pub targets: &'a [wgpu::TextureFormat],
    /// Whether what is drawn is added to what is there.
    pub additive: bool,
    /// Whether the nearest surface wins.
    pub depth: bool,
}

/// A render pipeline; its bind group layouts are those of its shader.
#[derive(Debug, Clone)]
pub struct Pipeline {
    /// Name of the pass.
    pub name: &'static str,
    /// The pipeline itself.
    pub raw: wgpu::RenderPipeline,
    /// Reads of textures of one invocation: see [`crate::cost`].
    pub taps: u64,
    /// Whether what is drawn is added to what is there.
    pub additive: bool,
}

/// Format of all depth buffers.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

const ADD: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

impl Pipeline {
    /// Compiles a pipeline.
    pub fn new(gpu: &Gpu, blueprint: &Blueprint) -> Self {
        Self::compiled(gpu, blueprint, wgpu::PrimitiveTopology::TriangleList)
    }

    /// Compiles one that draws a texel for every vertex.
    pub fn of_points(gpu: &Gpu, blueprint: &Blueprint) -> Self {
        Self::compiled(gpu, blueprint, wgpu::PrimitiveTopology::PointList)
    }

    fn compiled(gpu: &Gpu, blueprint: &Blueprint, topology: wgpu::PrimitiveTopology) -> Self {
        let Blueprint { name, source, entries, targets, additive, depth } = *blueprint;
        let module = shader(gpu, name, source);
        let blend = additive.then_some(wgpu::BlendState { color: ADD, alpha: ADD });
        let targets: Vec<_> = targets
            .iter()
            .map(|&format| Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL }))
            .collect();
        let depth_stencil = depth.then(|| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        });
        let raw = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(entries[0]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState { topology, ..wgpu::PrimitiveState::default() },
            depth_stencil,
            multisample: wgpu::MultisampleState::default(),
            fragment: (!targets.is_empty()).then_some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(entries[1]),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        let shades = if targets.is_empty() { entries[0] } else { entries[1] };
        Self { name, raw, taps: taps_of(shades), additive }
    }

    /// Binds what the shader reads, by the numbers it uses.
    pub fn bind(&self, gpu: &Gpu, group: u32, bound: &[(u32, Bound)]) -> Binding {
        bind(gpu, self.name, &self.raw.get_bind_group_layout(group), bound)
    }
}

/// A compute pipeline.
#[derive(Debug, Clone)]
pub struct ComputePipeline {
    /// Name of the pass.
    pub name: &'static str,
    /// The pipeline itself.
    pub raw: wgpu::ComputePipeline,
}

impl ComputePipeline {
    /// Compiles a pipeline.
    pub fn new(gpu: &Gpu, name: &'static str, source: &str, entry: &str) -> Self {
        let raw = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &shader(gpu, name, source),
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { name, raw }
    }

    /// Binds what the shader reads and writes, by the numbers it uses.
    pub fn bind(&self, gpu: &Gpu, bound: &[(u32, Bound)]) -> Binding {
        bind(gpu, self.name, &self.raw.get_bind_group_layout(0), bound)
    }
}

/// Something a shader reads.
#[derive(Debug, Clone, Copy)]
pub enum Bound<'a> {
    /// A uniform struct or an array.
    Buffer(&'a wgpu::Buffer),
    /// A texture.
    Texture(&'a View),
    /// A texture of which only so many texels are read or written.
    Texels(&'a View, u64),
    /// How textures are read.
    Sampler(&'a wgpu::Sampler),
}

/// Things that are bound together.
#[derive(Debug, Clone)]
pub struct Binding {
    /// The group itself.
    pub raw: wgpu::BindGroup,
    /// Bytes of all that is in it.
    pub bytes: u64,
}

impl Bound<'_> {
    fn bytes(&self) -> u64 {
        match self {
            Bound::Buffer(buffer) => buffer.size(),
            Bound::Texture(view) => view.bytes(),
            Bound::Texels(view, count) => (*count).min(view.texels) * view.texel_bytes,
            Bound::Sampler(_) => 0,
        }
    }
}

fn bind(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, bound: &[(u32, Bound)]) -> Binding {
    let entries: Vec<_> = bound
        .iter()
        .map(|&(binding, bound)| {
            let resource = match bound {
                Bound::Buffer(buffer) => buffer.as_entire_binding(),
                Bound::Texture(view) | Bound::Texels(view, _) => {
                    wgpu::BindingResource::TextureView(&view.raw)
                }
                Bound::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
            };
            wgpu::BindGroupEntry { binding, resource }
        })
        .collect();
    let descriptor = wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries };
    let bytes = bound.iter().map(|(_, bound)| bound.bytes()).sum();
    Binding { raw: gpu.device.create_bind_group(&descriptor), bytes }
}

fn shader(gpu: &Gpu, label: &str, source: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(source.into());
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
}
