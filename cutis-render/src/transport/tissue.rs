//! What a body is filled with: layers that follow its surface.

use crate::RenderError;
use cutis_optics::{self as optics, Medium, presets};
use cutis_scene::{Material, Scattering};
use glam::DVec3;

/// Coefficients of red, green and blue in one layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TissueLayer {
    /// Thickness below the surface or the layer above, mm; the last one's is not asked for.
    pub thickness_mm: f64,
    /// Absorption, 1/mm.
    pub sigma_a_per_mm: DVec3,
    /// Scattering, 1/mm.
    pub sigma_s_per_mm: DVec3,
    /// Mean cosine of the scattering angle (Henyey–Greenstein).
    pub g: f64,
}

/// Layers under the surface, the outermost first; the last fills what is left of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Tissue {
    layers: Vec<TissueLayer>,
    /// Depth at which the last layer begins, mm.
    core_depth_mm: f64,
    /// Highest extinction of all layers, 1/mm.
    majorant_per_mm: DVec3,
    /// Refractive index against air, the same for all layers.
    pub refractive_index: f64,
}

impl Tissue {
    /// Layers of one refractive index.
    ///
    /// # Panics
    /// Without a layer.
    pub fn new(layers: Vec<TissueLayer>, refractive_index: f64) -> Self {
        let above = &layers[..layers.len() - 1];
        let core_depth_mm = above.iter().map(|layer| layer.thickness_mm).sum();
        let majorant_per_mm = layers.iter().map(TissueLayer::sigma_t_per_mm).fold(DVec3::ZERO, DVec3::max);
        Self { layers, core_depth_mm, majorant_per_mm, refractive_index }
    }

    /// One medium throughout; scattering by reduced coefficients, all directions alike.
    pub fn homogeneous(media: &[Medium; 3]) -> Self {
        Self::new(vec![TissueLayer::isotropic(media, f64::INFINITY)], media[1].refractive_index)
    }

    /// Layers by reduced coefficients, all directions alike.
    ///
    /// # Errors
    /// In words, if a layer cannot be, their indices of refraction or the thicknesses of their channels differ, or the last one
    /// does not fill the body.
    pub fn of_layers([red, green, blue]: &[Vec<optics::TissueLayer>; 3]) -> Result<Self, String> {
        let rows: Vec<_> = red.iter().zip(green).zip(blue).map(|((r, g), b)| [*r, *g, *b]).collect();
        let all = || rows.iter().flatten();
        let Some(last) = red.last() else { return Err("it has no layer".to_owned()) };
        for layer in all() {
            layer.medium.validated().map_err(|e| e.to_string())?;
        }
        let index = last.medium.refractive_index;
        if all().any(|layer| layer.medium.refractive_index != index) {
            return Err("its layers have different refractive indices; a path has only one".to_owned());
        }
        if rows.iter().any(|row| row.iter().any(|layer| layer.thickness_mm != row[0].thickness_mm)) {
            return Err("its layers are of another thickness in each channel; a path has only one".to_owned());
        }
        if last.thickness_mm.is_finite() {
            return Err(
                "its last layer ends; within a body it is endless (without `thickness_mm`)".to_owned()
            );
        }
        let layer = |row: &[optics::TissueLayer; 3]| {
            TissueLayer::isotropic(&row.map(|layer| layer.medium), row[0].thickness_mm)
        };
        Ok(Self::new(rows.iter().map(layer).collect(), index))
    }

    /// The tissue of a material.
    ///
    /// # Errors
    /// If the material is a finished kernel, which says how far light goes but not by what, or its channels have different
    /// refractive indices.
    pub fn of_material(material: &Material) -> Result<Self, RenderError> {
        let bad = |reason: String| RenderError::BadMaterial { material: material.name.clone(), reason };
        let no_medium = || {
            bad("it is a finished kernel, and a simulation needs the medium behind it: give a preset of measured media \
                 such as skin1, or a medium of its own"
                .to_owned())
        };
        let media = match &material.scattering {
            Scattering::Medium(media) => *media,
            Scattering::Kernel(_) => return Err(no_medium()),
            Scattering::Layers(channels) => return Self::of_layers(channels).map_err(bad),
            Scattering::Preset(name) => {
                let preset = presets::find(name).map_err(|e| bad(e.to_string()))?;
                match preset.media() {
                    Some(media) => *media,
                    None => return Ok(three_layer_skin()),
                }
            }
        };
        for medium in &media {
            medium.validated().map_err(|e| bad(e.to_string()))?;
        }
        if media.iter().any(|m| m.refractive_index != media[0].refractive_index) {
            return Err(
                bad("its channels have different refractive indices; a path has only one".to_owned()),
            );
        }
        Ok(Self::homogeneous(&media))
    }

    /// Whether one medium fills it all.
    pub fn is_homogeneous(&self) -> bool {
        self.layers.len() == 1
    }

    /// Depth at which the last layer begins, mm.
    pub fn core_depth_mm(&self) -> f64 {
        self.core_depth_mm
    }

    /// The layer that fills the inside.
    pub fn core(&self) -> &TissueLayer {
        &self.layers[self.layers.len() - 1]
    }

    /// All layers, the outermost first.
    pub fn layers(&self) -> &[TissueLayer] {
        &self.layers
    }

    /// Highest extinction of all layers, 1/mm.
    pub fn majorant_per_mm(&self) -> DVec3 {
        self.majorant_per_mm
    }

    /// The layer at a depth.
    pub fn layer_at(&self, depth_mm: f64) -> &TissueLayer {
        let mut bottom_mm = 0.0;
        for layer in &self.layers[..self.layers.len() - 1] {
            bottom_mm += layer.thickness_mm;
            if depth_mm < bottom_mm {
                return layer;
            }
        }
        self.core()
    }
}

impl TissueLayer {
    /// By reduced coefficients, all directions alike.
    fn isotropic(media: &[Medium; 3], thickness_mm: f64) -> Self {
        let rgb = |of: fn(&Medium) -> f64| DVec3::from_array([&media[0], &media[1], &media[2]].map(of));
        Self {
            thickness_mm,
            sigma_a_per_mm: rgb(|m| m.sigma_a_per_mm),
            sigma_s_per_mm: rgb(|m| m.sigma_s_reduced_per_mm),
            g: 0.0,
        }
    }

    /// Extinction, 1/mm.
    pub fn sigma_t_per_mm(&self) -> DVec3 {
        self.sigma_a_per_mm + self.sigma_s_per_mm
    }
}

/// Epidermis, upper dermis and bloody dermis of the skin whose kernel is the preset `three-layer-skin`: coefficients in 1/cm
/// as published (Donner & Jensen 2005, doi:10.1145/1073204.1073308, not opened; numbers as a public port has them), index
/// 1.4. The published kernel can not be derived from them, only from the same model of skin.
fn three_layer_skin() -> Tissue {
    let layer = |thickness_mm, absorption: [f64; 3], scattering: [f64; 3]| TissueLayer {
        thickness_mm,
        sigma_a_per_mm: DVec3::from_array(absorption) * 0.1,
        sigma_s_per_mm: DVec3::from_array(scattering) * 0.1,
        g: 0.0,
    };
    let layers = vec![
        layer(0.25, [2.1, 2.1, 5.0], [48.0, 60.0, 65.0]),
        layer(0.20, [0.16, 0.19, 0.30], [32.0, 40.0, 46.0]),
        layer(f64::INFINITY, [0.085, 1.0, 25.0], [4.5, 4.7, 4.8]),
    ];
    Tissue::new(layers, 1.4)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(change: impl Fn(usize, usize, &mut optics::TissueLayer)) -> [Vec<optics::TissueLayer>; 3] {
        [0, 1, 2].map(|channel| {
            let layer = |i: usize| {
                let medium =
                    Medium::new(0.1 * (i + 1) as f64, 1.0 + channel as f64, 1.4).expect("is physical");
                let mut layer = optics::TissueLayer { medium, thickness_mm: [0.25, f64::INFINITY][i] };
                change(channel, i, &mut layer);
                layer
            };
            vec![layer(0), layer(1)]
        })
    }

    #[test]
    fn layers_fill_a_body() {
        let tissue = Tissue::of_layers(&layers(|_, _, _| {})).expect("can be simulated");
        assert_eq!((tissue.layers().len(), tissue.core_depth_mm(), tissue.refractive_index), (2, 0.25, 1.4));
        assert_eq!(tissue.layer_at(0.2).sigma_s_per_mm, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(tissue.layer_at(0.3).sigma_a_per_mm, DVec3::splat(0.2));
    }

    #[test]
    fn layers_that_no_path_can_take_are_refused_in_words() {
        let refused = |change: fn(usize, usize, &mut optics::TissueLayer)| {
            Tissue::of_layers(&layers(change)).expect_err("is refused")
        };
        assert!(
            refused(|_, i, layer| layer.medium.refractive_index += i as f64).contains("refractive indices")
        );
        assert!(
            refused(|c, i, layer| layer.thickness_mm += (c * i) as f64 - 0.1 * c as f64)
                .contains("another thickness")
        );
        assert!(refused(|_, i, layer| layer.thickness_mm = 1.0 + i as f64).contains("last layer ends"));
        assert!(refused(|_, _, layer| layer.medium.sigma_a_per_mm = -1.0).contains("negative"));
        assert!(Tissue::of_layers(&[vec![], vec![], vec![]]).is_err());
    }
}
