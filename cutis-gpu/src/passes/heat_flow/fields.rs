//! What a level needs on the device: links, their sparse rows, and maps for polynomials and sums.

use super::{AT_ONCE, LIGHT};
use crate::Gpu;
use crate::map::{Map, View, half_bytes};
use crate::pipeline::{Bound, Pipeline};
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::heat_flow::Level;
use cutis_render::passes::heat_flow::exchange::Exchange;
use cutis_render::passes::heat_flow::rows::Rows;
use glam::Vec4;
use half::f16;
use wgpu::TextureFormat as Format;

/// Largest pace: 16 bits hold no more.
const FASTEST_PACE: f32 = 6e4;

/// A link of a row; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Link {
    /// Texel at the other end.
    pub texel: u32,
    /// Its strength.
    pub strength: f32,
}

/// A sparse matrix on the device.
#[derive(Debug)]
pub struct GpuRows {
    /// Each row's texel, and where its links begin; the last one says where they end.
    pub rows: wgpu::Buffer,
    /// All links.
    pub links: wgpu::Buffer,
    /// Number of rows.
    pub count: u32,
    /// Number of links.
    pub link_count: u32,
}

/// What a level needs on the device.
#[derive(Debug)]
pub struct Fields {
    /// Coefficients of every time.
    pub times: Vec<Vec<f32>>,
    /// What of each neighbour's difference a texel takes at once: from the east on, and from the west on.
    pub taken: [Map; 2],
    /// How much of what flows a texel takes: the inverse of its area.
    pub paces: Map,
    /// What texels at the edges of charts take from further away.
    pub edges: GpuRows,
    /// What they take of the map of twice the size.
    pub halved: Option<GpuRows>,
    /// What the padding reads.
    pub padding: GpuRows,
    /// Where that is kept.
    pub kept: wgpu::Buffer,
    /// Polynomials, in turn.
    pub turns: [Map; AT_ONCE + 1],
    /// Where sums are in turn with their level.
    pub spare: Map,
}

impl Fields {
    /// Of a level.
    pub fn new(gpu: &Gpu, level: &Level) -> Self {
        let size = level.exchange.size as u32;
        let padding = level.layout.padding.iter();
        let entries = padding.flat_map(|(texel, read)| read.iter().map(move |&(t, w)| (*texel, t, w)));
        let padding = GpuRows::new(gpu, &Rows::new(entries.collect()));
        let fields = Self {
            times: level.times.clone(),
            taken: std::array::from_fn(|_| Map::square(gpu, "taken", size, 1, LIGHT)),
            paces: Map::square(gpu, "paces", size, 1, Format::R16Float),
            edges: GpuRows::new(gpu, &taken_further(level)),
            halved: level.halving.as_ref().map(|halving| GpuRows::new(gpu, &halving.rows())),
            kept: gpu.storage("padding", &vec![Vec4::ZERO; padding.count as usize]),
            padding,
            turns: std::array::from_fn(|_| Map::computed(gpu, "polynomial", size, LIGHT)),
            spare: Map::square(gpu, "sums", size, level.times.len().max(1) as u32, LIGHT),
        };
        fields.write_bulk(gpu, level);
        fields
    }

    /// Writes what a pose changes.
    pub fn write(&self, gpu: &Gpu, level: &Level) {
        self.write_bulk(gpu, level);
        self.edges.write(gpu, &taken_further(level));
        if let (Some(rows), Some(halving)) = (&self.halved, &level.halving) {
            rows.write(gpu, &halving.rows());
        }
    }

    fn write_bulk(&self, gpu: &Gpu, level: &Level) {
        let taken = taken(level);
        for (side, map) in self.taken.iter().enumerate() {
            map.write(gpu, 0, &half_bytes(taken.iter().map(|t| t[side])));
        }
        let Exchange { inverse_areas_per_mm2, fastest_rate_per_mm2, .. } = &level.exchange;
        let speed = 2.0 / fastest_rate_per_mm2;
        let paces =
            inverse_areas_per_mm2.iter().map(|per_area| f16::from_f32((per_area * speed).min(FASTEST_PACE)));
        let bytes: Vec<u8> = paces.flat_map(|pace| pace.to_bits().to_le_bytes()).collect();
        self.paces.write(gpu, 0, &bytes);
    }
}

/// What of the differences of its eight neighbours every texel takes at once, counter-clockwise: from the east, and from the west
/// on.
fn taken(level: &Level) -> Vec<[Vec4; 2]> {
    let exchange = &level.exchange;
    let size = exchange.size;
    let speed = 2.0 / exchange.fastest_rate_per_mm2;
    // Inner squares link no texel along the edges of the map.
    let of = |i: usize| {
        if i <= size || i + size + 1 >= exchange.links.len() {
            return [Vec4::ZERO; 2];
        }
        let links = |i: usize| exchange.links[i];
        let [e, n, ne, nw] = links(i);
        let east = Vec4::new(e, ne, n, nw);
        let west =
            Vec4::new(links(i - 1)[0], links(i - size - 1)[2], links(i - size)[1], links(i - size + 1)[3]);
        [east, west].map(|links| links * exchange.inverse_areas_per_mm2[i] * speed)
    };
    (0..exchange.links.len()).map(of).collect()
}

/// The same from further away.
fn taken_further(level: &Level) -> Rows {
    let exchange = &level.exchange;
    let speed = 2.0 / exchange.fastest_rate_per_mm2;
    let mut rows = exchange.rows.clone();
    for (&texel, ends) in rows.texels.iter().zip(exchange.rows.starts.windows(2)) {
        let links = &mut rows.links[ends[0] as usize..ends[1] as usize];
        links
            .iter_mut()
            .for_each(|(_, link)| *link *= exchange.inverse_areas_per_mm2[texel as usize] * speed);
    }
    rows
}

impl GpuRows {
    /// Of a matrix.
    pub fn new(gpu: &Gpu, rows: &Rows) -> Self {
        let last = rows.starts.last().copied().unwrap_or(0);
        let pairs = rows.texels.iter().zip(&rows.starts).map(|(&texel, &start)| [texel, start]);
        let pairs: Vec<[u32; 2]> = pairs.chain([[0, last]]).collect();
        Self {
            rows: gpu.storage("rows", &pairs),
            links: gpu.storage("links", &links(rows)),
            count: rows.texels.len() as u32,
            link_count: rows.links.len() as u32,
        }
    }

    /// Writes other strengths of the same links.
    ///
    /// # Panics
    /// If there are more or fewer.
    pub fn write(&self, gpu: &Gpu, rows: &Rows) {
        assert_eq!(rows.links.len(), self.link_count as usize, "a pose has the links of the layout");
        gpu.queue.write_buffer(&self.links, 0, bytemuck::cast_slice(&links(rows)));
    }

    /// A point for every row.
    pub fn draw(
        &self,
        gpu: &Gpu,
        pipeline: &Pipeline,
        bound: &[(u32, Bound)],
        target: &View,
    ) -> Option<Step> {
        let mut all = bound.to_vec();
        all.extend([(9, Bound::Buffer(&self.rows)), (10, Bound::Buffer(&self.links))]);
        (self.count > 0).then(|| points(gpu, pipeline, &all, target, self.count))
    }
}

fn links(rows: &Rows) -> Vec<Link> {
    rows.links.iter().map(|&(texel, strength)| Link { texel, strength }).collect()
}

/// A point for every vertex.
pub fn points(gpu: &Gpu, pipeline: &Pipeline, bound: &[(u32, Bound)], target: &View, count: u32) -> Step {
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups: vec![pipeline.bind(gpu, 0, bound)],
        targets: vec![target.clone()],
        depth: None,
        clear: None,
        indices: None,
        vertices: count,
        instances: 1,
    })
}
