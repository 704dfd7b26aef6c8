//! How long each pass takes: measured by the device where it can, else by waiting for every pass.

use crate::step::Step;
use crate::{Gpu, GpuError};
use cutis_render::PassTime;
use std::time::{Duration, Instant};

/// Where the beginning and the end of a step are noted.
#[derive(Debug, Clone, Copy)]
pub struct Stamps<'a> {
    /// Notes of the device.
    pub queries: &'a wgpu::QuerySet,
    /// Number of the first of two notes.
    pub first: u32,
}

/// Measures the steps of a frame.
#[derive(Debug)]
pub struct Timing {
    queries: Option<wgpu::QuerySet>,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    steps: u32,
}

/// Most steps that one set of queries can time: the limit of WebGPU, two for each.
const MAX_STEPS: usize = 2048;

impl Timing {
    /// For so many steps.
    pub fn new(gpu: &Gpu, steps: usize) -> Self {
        let steps = steps.min(MAX_STEPS) as u32;
        let queries = gpu.has_timestamps().then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * steps.max(1),
            })
        });
        let buffer = |usage| {
            let size = 16 * u64::from(steps.max(1));
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("times"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let readable = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        Self { queries, resolved, readable, steps }
    }

    /// Runs the steps and tells how long each pass took.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn run<'a>(
        &self,
        gpu: &Gpu,
        steps: impl Iterator<Item = &'a Step>,
    ) -> Result<Vec<PassTime>, GpuError> {
        let steps: Vec<_> = steps.collect();
        match &self.queries {
            Some(queries) if steps.len() <= self.steps as usize => self.run_stamped(gpu, &steps, queries),
            _ => run_one_by_one(gpu, &steps),
        }
    }

    fn run_stamped(
        &self,
        gpu: &Gpu,
        steps: &[&Step],
        queries: &wgpu::QuerySet,
    ) -> Result<Vec<PassTime>, GpuError> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (i, step) in (0..).zip(steps) {
            step.encode(&mut encoder, Some(Stamps { queries, first: 2 * i }));
        }
        encoder.resolve_query_set(queries, 0..2 * steps.len() as u32, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
        gpu.queue.submit([encoder.finish()]);
        let nanoseconds_per_tick = f64::from(gpu.queue.get_timestamp_period());
        let bytes = crate::readback::mapped(gpu, &self.readable)?;
        let ticks: &[u64] = bytemuck::cast_slice(&bytes);
        let mut times = Vec::new();
        for (step, ends) in steps.iter().zip(ticks.chunks_exact(2)) {
            let nanoseconds = ends[1].saturating_sub(ends[0]) as f64 * nanoseconds_per_tick;
            add(&mut times, step.pass(), Duration::from_secs_f64(nanoseconds * 1e-9));
        }
        Ok(times)
    }
}

fn run_one_by_one(gpu: &Gpu, steps: &[&Step]) -> Result<Vec<PassTime>, GpuError> {
    let mut times = Vec::new();
    for step in steps {
        let start = Instant::now();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        step.encode(&mut encoder, None);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        add(&mut times, step.pass(), start.elapsed());
    }
    Ok(times)
}

fn add(times: &mut Vec<PassTime>, name: &str, time: Duration) {
    match times.iter_mut().find(|pass| pass.name == name) {
        Some(pass) => pass.time += time,
        None => times.push(PassTime { name: name.to_owned(), time }),
    }
}
