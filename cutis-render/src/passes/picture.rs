//! The picture: rays through every pixel, and their mean.
//!
//! Every pixel gets a jittered grid of samples. Where all of them fall on one patch of surface no larger than the texels
//! it is drawn from, shading them one by one would read the same texels again and again: their mean point is shaded
//! once. At edges, and where texels are smaller than pixels, every sample is shaded.

use crate::frame::{Frame, Layer};
use crate::passes::resolve::{PixelPart, Resolve, Sample};
use crate::progress::Progress;
use crate::sampling::random2;
use crate::settings::{Aov, Settings};
use cutis_scene::{Camera, CameraRays, Hit, SurfacePoint};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Stream of random numbers the camera draws from.
const STREAM: u32 = 0xCA;
/// Pixels along a side of a tile.
const TILE: usize = 16;
/// Extent of a pixel on the surface, in texels of the finest map it is drawn from, up to which it is shaded once.
const SHARED_TEXELS: f32 = 1.5;

/// Draws the picture tile by tile: neighbours in both directions read the same texels.
pub fn picture(resolve: &Resolve, camera: &Camera, settings: &Settings, progress: &dyn Progress) -> Frame {
    let (width, height) = (settings.width as usize, settings.height as usize);
    let columns = width.div_ceil(TILE);
    let tiles = columns * height.div_ceil(TILE);
    let lens = Lens::new(resolve, camera, settings);
    progress.begin("resolve", tiles as u64);
    let drawn: Vec<Vec<Sample>> = (0..tiles)
        .into_par_iter()
        .map(|t| {
            let (left, top) = (t % columns * TILE, t / columns * TILE);
            let pixels = (top..(top + TILE).min(height))
                .flat_map(|y| (left..(left + TILE).min(width)).map(move |x| (x as u32, y as u32)));
            // Of a picture that nobody wants any more, tiles are left empty.
            let pixel = |(x, y)| if progress.goes_on() { lens.pixel(x, y) } else { lens.nothing() };
            let samples = pixels.map(pixel).collect();
            progress.advance(1);
            samples
        })
        .collect();
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let tile_width = TILE.min(width - x / TILE * TILE);
        &drawn[y / TILE * columns + x / TILE][y % TILE * tile_width + x % TILE]
    };
    let layer = |(l, &aov): (usize, &Aov)| Layer {
        name: aov.to_string(),
        width: settings.width,
        height: settings.height,
        channels: aov.channels(),
        pixels: (0..width * height).map(|i| at(i).layers[l]).collect(),
    };
    Frame {
        width: settings.width,
        height: settings.height,
        pixels: (0..width * height).map(|i| at(i).radiance).collect(),
        layers: resolve.aovs.iter().enumerate().map(layer).collect(),
        ..Frame::default()
    }
}

/// What the samples of a pixel are taken with.
struct Lens<'a> {
    resolve: &'a Resolve<'a>,
    rays: CameraRays,
    eye_mm: Vec3,
    /// Width and height of the picture, pixels.
    size: Vec2,
    /// Samples along a side of a pixel.
    grid: u32,
    seed: u64,
}

impl<'a> Lens<'a> {
    fn new(resolve: &'a Resolve<'a>, camera: &Camera, settings: &Settings) -> Self {
        let size = Vec2::new(settings.width as f32, settings.height as f32);
        Self {
            resolve,
            rays: camera.rays(size.x / size.y),
            eye_mm: camera.position_mm,
            size,
            grid: settings.samples_grid(),
            seed: settings.seed,
        }
    }

    /// An empty pixel.
    fn nothing(&self) -> Sample {
        Sample { radiance: Vec4::ZERO, layers: vec![Vec4::ZERO; self.resolve.aovs.len()] }
    }

    /// The mean of a pixel.
    fn pixel(&self, x: u32, y: u32) -> Sample {
        let eye_mm = self.eye_mm;
        let seen: Vec<(Vec3, Option<Hit>)> = (0..self.grid * self.grid)
            .map(|i| {
                let dir = self.dir(x, y, i);
                (dir, self.resolve.lit.bvh.closest(eye_mm, dir, f32::INFINITY))
            })
            .collect();
        if let Some((hit, point)) = self.shared_point(&seen) {
            let whole = PixelPart { sample: [x, y], is_whole: true };
            let sample = self.resolve.shade(&hit, &point, (point.position_mm - eye_mm).normalize(), whole);
            return self.counted(sample, 1);
        }
        let mut sum = self.nothing();
        for (i, (dir, hit)) in (0..).zip(&seen) {
            let part = PixelPart {
                sample: [x * self.grid + i % self.grid, y * self.grid + i / self.grid],
                is_whole: self.grid == 1,
            };
            let sample = match hit {
                Some(hit) => self.resolve.shade(hit, &self.resolve.point(hit), *dir, part),
                None => self.resolve.miss(*dir),
            };
            sum.radiance += sample.radiance;
            sum.layers.iter_mut().zip(&sample.layers).for_each(|(sum, value)| *sum += *value);
        }
        let scale = 1.0 / seen.len() as f32;
        let layers = sum.layers.iter().map(|&l| l * scale).collect();
        let shaded = seen.iter().filter(|(_, hit)| hit.is_some()).count();
        self.counted(Sample { radiance: sum.radiance * scale, layers }, shaded)
    }

    /// Tells in the layer of samples how many of them were shaded.
    fn counted(&self, mut sample: Sample, shaded: usize) -> Sample {
        let taken = (self.grid * self.grid) as f32;
        for (layer, _) in
            sample.layers.iter_mut().zip(self.resolve.aovs).filter(|(_, aov)| **aov == Aov::Samples)
        {
            *layer = Vec4::new(shaded as f32, taken, 0.0, 0.0);
        }
        sample
    }

    /// Direction of sample `i` of a pixel.
    fn dir(&self, x: u32, y: u32, i: u32) -> Vec3 {
        let jitter = random2(x, y, STREAM + (i << 8), self.seed);
        let within = (Vec2::new((i % self.grid) as f32, (i / self.grid) as f32) + jitter) / self.grid as f32;
        let place = (Vec2::new(x as f32, y as f32) + within) / self.size;
        self.rays.dir_through(Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y))
    }

    /// The point that can stand for all samples: their mean, if they lie in one chart and close together. With it, one of
    /// the hits, for the object and the chart.
    fn shared_point(&self, seen: &[(Vec3, Option<Hit>)]) -> Option<(Hit, SurfacePoint)> {
        let first = seen.first()?.1?;
        let (object, maps) = self.resolve.object_of(&first);
        let chart = object.charts.of_triangle[first.triangle as usize];
        let texels = [object.material.largest_map() as f32, maps.atlas.size as f32];
        let mut boxes = [[Vec2::INFINITY, Vec2::NEG_INFINITY]; 2];
        for (_, hit) in seen {
            // Another object may have fewer triangles than the number of this one.
            let hit = (*hit).filter(|hit| hit.object == first.object)?;
            let Hit { triangle, b1, b2, .. } = hit;
            if object.charts.of_triangle[triangle as usize] != chart {
                return None;
            }
            let uvs = [object.map_uv_at(triangle, b1, b2), object.atlas_uv_at(triangle, b1, b2)];
            for (([lo, hi], uv), texels) in boxes.iter_mut().zip(uvs).zip(texels) {
                (*lo, *hi) = (lo.min(uv), hi.max(uv));
                if (*hi - *lo).max_element() * texels > SHARED_TEXELS {
                    return None;
                }
            }
        }
        let points = seen.iter().filter_map(|(_, hit)| hit.as_ref()).map(|hit| self.resolve.point(hit));
        SurfacePoint::mean(points).map(|point| (first, point))
    }
}
