//! The passes' own textures, to be looked at.

use super::LitScene;
use crate::frame::Layer;
use crate::passes::irradiance::distance_slot;
use crate::passes::object_maps::ObjectMaps;
use crate::passes::seam_map::chart_numbers;
use crate::settings::Aov;
use cutis_scene::Scene;
use glam::Vec4;
use std::ops::Deref;

impl<S: Deref<Target = Scene>> LitScene<S> {
    /// Distances through the body towards the first four lights, texel by texel, mm.
    fn distances_mm(&self, maps: &ObjectMaps) -> Vec<Vec4> {
        let layers = &maps.diffused.levels[0].layers;
        let mut distances = vec![Vec4::ZERO; layers[0].len()];
        for l in 0..self.scene.lights.len().min(4) {
            let (layer, component) = distance_slot(l);
            distances.iter_mut().zip(&layers[layer]).for_each(|(to, from)| to[l] = from[component]);
        }
        distances
    }

    /// A pass's own texture, of the first object. `None` for layers that exist only in the picture.
    pub fn texture_layer(&self, aov: Aov) -> Option<Layer> {
        let maps = self.maps.first()?;
        let level = |i: usize| maps.diffused.levels.get(i).map(|l| (l.charts.size, l.layers[0].clone()));
        let (size, pixels) = match aov {
            Aov::Irradiance => level(0)?,
            Aov::Blur(i) => level(usize::from(i) + 1)?,
            Aov::Thickness => (maps.atlas.size, self.distances_mm(maps)),
            Aov::Stretch => {
                (maps.atlas.size, maps.stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0)).collect())
            }
            Aov::Charts => (maps.atlas.size, chart_numbers(&maps.atlas.charts)),
            Aov::Seams => (maps.atlas.size, maps.seam_map(self.scene.objects.first()?)),
            Aov::ShadowSamples => {
                (maps.atlas.size, maps.tried.iter().map(|&tried| Vec4::splat(tried as f32)).collect())
            }
            Aov::Normal
            | Aov::Albedo
            | Aov::Specular
            | Aov::Transmission
            | Aov::Diffuse
            | Aov::Exitance
            | Aov::Samples
            | Aov::StandardError => return None,
        };
        Some(Layer {
            name: aov.to_string(),
            width: size as u32,
            height: size as u32,
            channels: aov.channels(),
            pixels,
        })
    }
}
