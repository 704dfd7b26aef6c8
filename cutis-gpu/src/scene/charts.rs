//! Charts as shaders read them, and the tiles of a map that they cover.

use crate::Gpu;
use crate::map::{Map, Pyramid, View};
use crate::passes::TILE_TEXELS;
use cutis_render::passes::atlas::{Atlas, ChartMap, NO_CHART};
use cutis_render::passes::seven_taps::FARTHEST_TEXELS;
use cutis_scene::Object;
use glam::Vec2;

/// Texels of a chart that are counted to either side at most: two of these numbers share 16 bits.
const MAX_REACH: u16 = FARTHEST_TEXELS;
/// In place of a chart: none.
const NO_CODE: u16 = u16::MAX;

/// The charts of a map and of halved ones.
#[derive(Debug, Clone)]
pub struct ChartPyramid {
    /// The largest first, each half of the one before.
    pub sizes: Vec<ChartTexture>,
    /// All of them for shaders that choose one.
    pub all: View,
}

impl ChartPyramid {
    /// Uploads a map of charts and what halving it so often gives.
    pub fn new(gpu: &Gpu, charts: &ChartMap, halvings: usize) -> Self {
        let size = charts.size as u32;
        let pyramid = Pyramid::new(gpu, "charts", size, [1, halvings as u32], wgpu::TextureFormat::Rg16Uint);
        let mut charts = charts.clone();
        let mut sizes = vec![ChartTexture::new(gpu, &charts, pyramid.part(0, 0, 1))];
        for halving in 1..=halvings {
            charts = charts.halved();
            sizes.push(ChartTexture::new(gpu, &charts, pyramid.part(halving as u32, 0, 1)));
        }
        Self { sizes, all: pyramid.first }
    }
}

/// Which chart every texel of a map belongs to.
#[derive(Debug, Clone)]
pub struct ChartTexture {
    /// Width and height in texels.
    pub size: u32,
    /// Chart in the first channel, reaches in the second.
    pub map: Map,
    /// Runs of tiles with at least one texel of a chart; see `lib/tiles.wgsl`.
    pub tiles: wgpu::Buffer,
    /// Number of those runs.
    pub runs: u32,
    /// The same tiles, each a run of its own.
    pub single_tiles: wgpu::Buffer,
    /// Number of those tiles.
    pub tile_count: u32,
}

impl ChartTexture {
    /// Fills a texture with a map of charts of its size.
    fn new(gpu: &Gpu, charts: &ChartMap, map: Map) -> Self {
        let size = charts.size as u32;
        let texels = charts.chart.iter().zip(&charts.reach_u).zip(&charts.reach_v);
        let codes = texels
            .flat_map(|((&chart, &u), &v)| [chart_code(chart), u.min(MAX_REACH) | v.min(MAX_REACH) << 8]);
        let bytes: Vec<u8> = codes.flat_map(u16::to_le_bytes).collect();
        map.write(gpu, 0, &bytes);
        let runs = runs(charts);
        let singles = single_tiles(&runs);
        let buffer = |label, codes: &[u32]| gpu.storage(label, &[&[size], codes].concat());
        Self {
            size,
            map,
            tiles: buffer("runs of tiles", &runs),
            runs: runs.len() as u32,
            single_tiles: buffer("tiles", &singles),
            tile_count: singles.len() as u32,
        }
    }
}

/// A chart's number in 16 bits. Of more than 65535 charts some share a number: only neighbours in the texture could notice.
pub fn chart_code(chart: u32) -> u16 {
    if chart == NO_CHART { NO_CODE } else { (chart % u32::from(NO_CODE)) as u16 }
}

/// First column, end column and row of every run of tiles that hold a texel of a chart.
fn runs(charts: &ChartMap) -> Vec<u32> {
    let tiles = charts.size.div_ceil(TILE_TEXELS);
    let covered = |column: usize, row: usize| {
        let ys = row * TILE_TEXELS..((row + 1) * TILE_TEXELS).min(charts.size);
        let xs = column * TILE_TEXELS..((column + 1) * TILE_TEXELS).min(charts.size);
        ys.into_iter()
            .any(|y| charts.chart[y * charts.size..][xs.clone()].iter().any(|&chart| chart != NO_CHART))
    };
    let mut runs = Vec::new();
    for row in 0..tiles {
        let mut column = 0;
        while column < tiles {
            let end = (column..tiles).find(|&c| !covered(c, row)).unwrap_or(tiles);
            if end > column {
                runs.push((row << 20 | end << 10 | column) as u32);
            }
            column = end + 1;
        }
    }
    runs
}

/// Every tile of some runs as a run of its own.
fn single_tiles(runs: &[u32]) -> Vec<u32> {
    let tiles = |&run: &u32| {
        let (row, end, first) = (run >> 20, (run >> 10) & 1023, run & 1023);
        (first..end).map(move |column| row << 20 | (column + 1) << 10 | column)
    };
    runs.iter().flat_map(tiles).collect()
}

/// The triangle under every texel of the atlas, as `passes/atlas.wgsl` reads it.
pub fn surface_texture(gpu: &Gpu, atlas: &Atlas) -> Map {
    let words = atlas.surface.iter().map(|s| [s.triangle, packed(Vec2::new(s.b1, s.b2))]);
    pairs(gpu, "surface", atlas.size, &words.collect::<Vec<_>>())
}

/// Where every texel of the atlas lies in the material's maps, which repeat, and in the maps of light.
pub fn coordinates_texture(gpu: &Gpu, object: &Object, atlas: &Atlas) -> Map {
    let words = (0..atlas.surface.len()).map(|i| {
        let uvs =
            [atlas.map_uv_under(object, i), atlas.atlas_uv_under(object, i)].map(Option::unwrap_or_default);
        [packed(uvs[0] - uvs[0].floor()), packed(uvs[1])]
    });
    pairs(gpu, "coordinates", atlas.size, &words.collect::<Vec<_>>())
}

/// Two numbers from 0 to 1 in 16 bits each, as `unpack2x16unorm` reads them.
fn packed(pair: Vec2) -> u32 {
    let [x, y] = (pair.clamp(Vec2::ZERO, Vec2::ONE) * 65535.0).round().as_uvec2().to_array();
    x | y << 16
}

fn pairs(gpu: &Gpu, label: &str, size: usize, words: &[[u32; 2]]) -> Map {
    let size = size as u32;
    Map::filled(gpu, label, [size, size], wgpu::TextureFormat::Rg32Uint, bytemuck::cast_slice(words))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_every_chart_and_little_else() {
        let size = 64;
        // One texel in the second tile of the first row, and a bar through the last row of tiles.
        let chart = |i: usize| if i == 5 * size + 20 || i / size == 50 { 3 } else { NO_CHART };
        let charts = ChartMap::new(size, (0..size * size).map(chart).collect());
        let runs = runs(&charts);
        assert_eq!(runs, [2 << 10 | 1, 3 << 20 | 4 << 10]);
        let last_row = [1, 2, 3, 4].map(|end| 3 << 20 | end << 10 | (end - 1));
        assert_eq!(single_tiles(&runs), [&[2 << 10 | 1], last_row.as_slice()].concat());
    }

    #[test]
    fn no_chart_is_no_number_of_a_chart() {
        assert_eq!(chart_code(NO_CHART), NO_CODE);
        assert_ne!(chart_code(u32::from(NO_CODE)), NO_CODE);
    }
}
