//! Layers beside the picture, drawn when they are asked for.

use super::GpuScene;
use super::picture::Picture;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::levels::Level;
use crate::passes::resolve::{Canvas, LAYER, LayerKind};
use crate::readback::read_layer;
use crate::{Gpu, GpuError};
use cutis_render::passes::seam_map::chart_numbers;
use cutis_render::{Aov, AovSpace, Layer};
use glam::Vec4;

impl GpuScene {
    /// Layers of the frame that was drawn last. Those that do not exist are left out.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn layers(
        &self,
        gpu: &Gpu,
        passes: &Passes,
        aovs: &[Aov],
        space: AovSpace,
    ) -> Result<Vec<Layer>, GpuError> {
        let mut layers = Vec::new();
        for &aov in aovs {
            layers.extend(match space {
                AovSpace::Picture => Some(self.seen_layer(gpu, passes, aov)?),
                AovSpace::Texture => self.texture_layer(gpu, passes, aov)?,
            });
        }
        Ok(layers)
    }

    /// A layer through the camera.
    fn seen_layer(&self, gpu: &Gpu, passes: &Passes, aov: Aov) -> Result<Layer, GpuError> {
        let Picture { pixels: seen, depth, grid, .. } = &self.picture;
        let size = [seen.width(), seen.height()];
        let samples = Map::new(gpu, "samples of a layer", size.map(|s| s * grid), 1, LAYER);
        let pixels = Map::new(gpu, "layer", size, 1, LAYER);
        // Where nothing is met, samples are taken all the same.
        let taken = wgpu::Color { g: f64::from(grid * grid), ..wgpu::Color::TRANSPARENT };
        let mut steps = Vec::new();
        for (i, maps) in self.objects.iter().enumerate() {
            let Some((kind, level)) = self.source(gpu, passes, i as u32, aov)? else { continue };
            let clear = Some(if aov == Aov::Samples { taken } else { wgpu::Color::TRANSPARENT });
            let canvas = Canvas { samples: &samples, depth, clear, first: i == 0 };
            let inputs = maps.resolve_inputs(passes, &self.shared, self.picture.gathered());
            steps.push(passes.resolve.layer_step(gpu, &inputs, (kind, grid * grid), &level, &canvas));
        }
        steps.push(passes.downsample.step(gpu, *grid, &samples, &pixels));
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        steps.iter().for_each(|step| step.encode(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
        Ok(layer(aov, size, read_layer(gpu, &pixels, 0)?))
    }

    /// What a layer shows of object number `number`, and the level it is read from. `None` if there is nothing to show.
    fn source(
        &self,
        gpu: &Gpu,
        passes: &Passes,
        number: u32,
        aov: Aov,
    ) -> Result<Option<(LayerKind, Level)>, GpuError> {
        let maps = &self.objects[number as usize];
        let levels = &maps.levels.all;
        let level = |i: usize| levels[i.min(levels.len() - 1)].clone();
        let texel = |light: Map| Ok(Some((LayerKind::Texel, Level { light, ..maps.stretch_level() })));
        let kind = match aov {
            Aov::Irradiance => LayerKind::Level,
            Aov::Blur(i) => return Ok(Some((LayerKind::Level, level(usize::from(i) + 1)))),
            Aov::Stretch => return texel(maps.atlas.stretch.clone()),
            Aov::Seams => return texel(self.seams_as_a_map(gpu, maps)?),
            Aov::ShadowSamples => return texel(self.shadow_samples(gpu, passes, number)),
            Aov::Samples => LayerKind::Samples,
            Aov::Thickness if self.shared.depth_maps.is_some() => LayerKind::Ways,
            Aov::Thickness if self.shared.light_count > 1 => LayerKind::Distances,
            Aov::Thickness => LayerKind::DistanceOfOne,
            Aov::Normal => LayerKind::Normal,
            Aov::Albedo => LayerKind::Albedo,
            Aov::Specular => LayerKind::Specular,
            Aov::Transmission => LayerKind::Transmission,
            Aov::Diffuse => LayerKind::Diffuse,
            Aov::Exitance => LayerKind::Exitance,
            Aov::Charts => LayerKind::Charts,
            // Nothing here is left to chance.
            Aov::StandardError => return Ok(None),
        };
        Ok(Some((kind, level(0))))
    }

    /// A pass's own texture, of the first object. `None` for layers that exist only in the picture.
    fn texture_layer(&self, gpu: &Gpu, passes: &Passes, aov: Aov) -> Result<Option<Layer>, GpuError> {
        let Some(maps) = self.objects.first() else { return Ok(None) };
        let size = maps.seams.charts.size as u32;
        let counts;
        let levels = &maps.levels.all;
        let many = self.shared.light_count > 1;
        let (map, texture_layer) = match aov {
            Aov::Irradiance => (&levels[0].light, 0),
            Aov::Blur(i) => match levels.get(usize::from(i) + 1) {
                Some(level) => (&level.light, 0),
                None => return Ok(None),
            },
            Aov::Thickness => (&levels[0].light, u32::from(many)),
            Aov::Stretch => (&maps.atlas.stretch, 0),
            Aov::ShadowSamples => {
                counts = self.shadow_samples(gpu, passes, 0);
                (&counts, 0)
            }
            Aov::Charts => return Ok(Some(layer(aov, [size, size], chart_numbers(&maps.seams.charts)))),
            Aov::Seams => return Ok(Some(layer(aov, [size, size], self.seams(gpu, maps)?))),
            _ => return Ok(None),
        };
        let mut pixels = read_layer(gpu, map, texture_layer)?;
        match aov {
            Aov::Thickness if !many => pixels.iter_mut().for_each(|p| *p = Vec4::new(p.w, 0.0, 0.0, 0.0)),
            Aov::Stretch => pixels.iter_mut().for_each(|p| *p = Vec4::new(p.x, p.y, 0.0, 0.0)),
            _ => {}
        }
        Ok(Some(layer(aov, [map.width(), map.height()], pixels)))
    }
}

fn layer(aov: Aov, [width, height]: [u32; 2], pixels: Vec<Vec4>) -> Layer {
    Layer { name: aov.to_string(), width, height, channels: aov.channels(), pixels }
}
