//! Flat layers, stacked, between two clear half-spaces.

use super::fresnel::fresnel_reflectance;

/// One layer.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Layer {
    /// Absorption coefficient, 1/mm.
    pub sigma_a_per_mm: f64,
    /// Scattering coefficient (not reduced), 1/mm.
    pub sigma_s_per_mm: f64,
    /// Mean cosine of the Henyey–Greenstein phase function, in (-1, 1).
    pub g: f64,
    /// Refractive index.
    pub refractive_index: f64,
    /// Thickness, mm; infinite for the last layer of a half-space.
    pub thickness_mm: f64,
}

/// Layers from top to bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredSlab {
    layers: Vec<Layer>,
    flights: Vec<Flight>,
    index_above: f64,
}

/// What a flight needs to know of a layer, divisions done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Flight {
    /// Infinite where nothing is met.
    pub(super) mean_free_path_mm: f64,
    /// Share of the light that a collision absorbs.
    pub(super) absorbed: f64,
    pub(super) g: f64,
    /// Depths of the top and the bottom, mm.
    pub(super) bounds_mm: [f64; 2],
    /// Refractive index of the layer over that beyond its top and its bottom.
    pub(super) index_over_beyond: [f64; 2],
}

impl Flight {
    /// All of it, in the order of the fields.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [f64; 7] {
        let &Self { mean_free_path_mm, absorbed, g, bounds_mm: [top, bottom], index_over_beyond } = self;
        let [up, down] = index_over_beyond;
        [mean_free_path_mm, absorbed, g, top, bottom, up, down]
    }
}

/// Why layers are refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LayerError {
    /// Nothing to simulate.
    #[error("there must be at least one layer")]
    Empty,
    /// A number that no material has.
    #[error("layer {layer}: {quantity} must be {range}, got {value}")]
    OutOfRange {
        /// Number of the layer, the top one is 1.
        layer: usize,
        /// The field at fault.
        quantity: &'static str,
        /// What is allowed.
        range: &'static str,
        /// What was given.
        value: f64,
    },
    /// Light would never come back from something clear and endless below which there is nothing.
    #[error("layer {layer}: only the last layer may be infinitely thick")]
    InfiniteInside {
        /// Number of the layer, the top one is 1.
        layer: usize,
    },
}

impl LayeredSlab {
    /// Layers in air.
    ///
    /// # Errors
    /// If there is no layer, a number is out of its range, or a layer above another is infinite.
    pub fn in_air(layers: Vec<Layer>) -> Result<Self, LayerError> {
        Self::new(layers, 1.0, 1.0)
    }

    /// Layers between media of these refractive indices.
    ///
    /// # Errors
    /// As [`LayeredSlab::in_air`]; the media above and below count as layers 0 and one past the last.
    pub fn new(layers: Vec<Layer>, index_above: f64, index_below: f64) -> Result<Self, LayerError> {
        if layers.is_empty() {
            return Err(LayerError::Empty);
        }
        check_index(0, index_above)?;
        check_index(layers.len() + 1, index_below)?;
        for (i, layer) in layers.iter().enumerate() {
            check(i + 1, layer)?;
            if layer.thickness_mm.is_infinite() && i + 1 < layers.len() {
                return Err(LayerError::InfiniteInside { layer: i + 1 });
            }
        }
        let flights = flights(&layers, index_above, index_below);
        Ok(Self { layers, flights, index_above })
    }

    /// The layers, top first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Fraction of the beam that the top surface mirrors before anything enters.
    pub fn specular_reflectance(&self) -> f64 {
        fresnel_reflectance(self.index_above, self.layers[0].refractive_index, 1.0).0
    }

    /// The constants of all layers.
    pub(super) fn flights(&self) -> &[Flight] {
        &self.flights
    }
}

fn flights(layers: &[Layer], index_above: f64, index_below: f64) -> Vec<Flight> {
    let index = |number: usize| match number {
        0 => index_above,
        number => layers.get(number - 1).map_or(index_below, |l| l.refractive_index),
    };
    let mut depth_mm = 0.0;
    let flight = |(i, layer): (usize, &Layer)| {
        let top_mm = depth_mm;
        depth_mm += layer.thickness_mm;
        let sigma_t_per_mm = layer.sigma_a_per_mm + layer.sigma_s_per_mm;
        Flight {
            mean_free_path_mm: sigma_t_per_mm.recip(),
            absorbed: if sigma_t_per_mm > 0.0 { layer.sigma_a_per_mm / sigma_t_per_mm } else { 0.0 },
            g: layer.g,
            bounds_mm: [top_mm, depth_mm],
            index_over_beyond: [i, i + 2].map(|beyond| layer.refractive_index / index(beyond)),
        }
    };
    layers.iter().enumerate().map(flight).collect()
}

fn check(number: usize, layer: &Layer) -> Result<(), LayerError> {
    let refuse =
        |quantity, range, value| Err(LayerError::OutOfRange { layer: number, quantity, range, value });
    let coefficient = 0.0..=1e9;
    if !coefficient.contains(&layer.sigma_a_per_mm) {
        return refuse("sigma_a_per_mm", "from 0 to 1e9 1/mm", layer.sigma_a_per_mm);
    }
    if !coefficient.contains(&layer.sigma_s_per_mm) {
        return refuse("sigma_s_per_mm", "from 0 to 1e9 1/mm", layer.sigma_s_per_mm);
    }
    let is_cosine = layer.g > -1.0 && layer.g < 1.0;
    if !is_cosine {
        return refuse("g", "between -1 and 1", layer.g);
    }
    let has_thickness = layer.thickness_mm > 0.0;
    if !has_thickness {
        return refuse("thickness_mm", "above 0", layer.thickness_mm);
    }
    check_index(number, layer.refractive_index)
}

fn check_index(number: usize, index: f64) -> Result<(), LayerError> {
    if (0.5..=4.0).contains(&index) {
        return Ok(());
    }
    let (quantity, range) = ("refractive_index", "from 0.5 to 4");
    Err(LayerError::OutOfRange { layer: number, quantity, range, value: index })
}
