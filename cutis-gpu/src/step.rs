//! What a frame consists of: steps that were prepared once and are encoded every time.

use crate::map::View;
use crate::pipeline::{Binding, ComputePipeline, Pipeline};
use crate::timing::Stamps;

/// Most targets of a draw.
const MAX_TARGETS: usize = 4;

/// One step of a frame.
#[expect(clippy::large_enum_variant, reason = "nearly all steps are draws")]
#[derive(Debug)]
pub enum Step {
    /// Something is drawn.
    Draw(Draw),
    /// Something is computed.
    Compute(Dispatch),
}

/// A draw into some textures.
#[derive(Debug)]
pub struct Draw {
    /// How it is drawn.
    pub pipeline: Pipeline,
    /// What is read.
    pub bind_groups: Vec<Binding>,
    /// What is drawn into.
    pub targets: Vec<View>,
    /// The depth buffer, if there is one, and whether it is emptied before.
    pub depth: Option<(View, bool)>,
    /// What the targets hold before; none: what they held.
    pub clear: Option<wgpu::Color>,
    /// Numbers of the vertices, 32 bits each; none: they are counted.
    pub indices: Option<wgpu::Buffer>,
    /// Vertices of an instance.
    pub vertices: u32,
    /// Instances.
    pub instances: u32,
}

/// A computation.
#[derive(Debug)]
pub struct Dispatch {
    /// How it is computed.
    pub pipeline: ComputePipeline,
    /// What is read and written.
    pub bind_group: Binding,
    /// Groups of invocations.
    pub groups: u32,
}

impl Step {
    /// Name of the pass it belongs to.
    pub fn pass(&self) -> &'static str {
        match self {
            Step::Draw(draw) => draw.pipeline.name,
            Step::Compute(dispatch) => dispatch.pipeline.name,
        }
    }

    /// Writes the step into the commands of a frame; `stamps` are where its beginning and end are noted.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<Stamps>) {
        match self {
            Step::Draw(draw) => draw.encode(encoder, stamps),
            Step::Compute(dispatch) => dispatch.encode(encoder, stamps),
        }
    }
}

impl Draw {
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<Stamps>) {
        let load = self.clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        let attachment = |view| {
            Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
        };
        let mut targets = [const { None }; MAX_TARGETS];
        targets.iter_mut().zip(&self.targets).for_each(|(slot, view)| *slot = attachment(&view.raw));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.pipeline.name),
            color_attachments: &targets[..self.targets.len()],
            depth_stencil_attachment: self.depth.as_ref().map(|(view, clear)| {
                let load = if *clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
                let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
                wgpu::RenderPassDepthStencilAttachment { view: &view.raw, depth_ops, stencil_ops: None }
            }),
            timestamp_writes: stamps.map(|s| wgpu::RenderPassTimestampWrites {
                query_set: s.queries,
                beginning_of_pass_write_index: Some(s.first),
                end_of_pass_write_index: Some(s.first + 1),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline.raw);
        for (group, bound) in (0..).zip(&self.bind_groups) {
            pass.set_bind_group(group, &bound.raw, &[]);
        }
        match &self.indices {
            Some(indices) => {
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..self.vertices, 0, 0..self.instances);
            }
            None => pass.draw(0..self.vertices, 0..self.instances),
        }
    }
}

impl Dispatch {
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<Stamps>) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.pipeline.name),
            timestamp_writes: stamps.map(|s| wgpu::ComputePassTimestampWrites {
                query_set: s.queries,
                beginning_of_pass_write_index: Some(s.first),
                end_of_pass_write_index: Some(s.first + 1),
            }),
        });
        pass.set_pipeline(&self.pipeline.raw);
        pass.set_bind_group(0, &self.bind_group.raw, &[]);
        pass.dispatch_workgroups(self.groups, 1, 1);
    }
}
