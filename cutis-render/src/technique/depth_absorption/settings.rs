//! Numbers of the technique `depth-absorption`.

use crate::RenderError;
use crate::prepare::ColourRamp;
use crate::settings::within;
use glam::Vec3;
use std::fmt;
use std::sync::Arc;

/// Numbers of the technique `depth-absorption`.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthAbsorptionSettings {
    /// What a distance through the body leaves of the light.
    pub fall_off: FallOff,
    /// How far bodies are grown along their normals in the depth map, mm, 0 to 1000: against the background at their edges.
    pub growth_mm: f32,
    /// What is known of the place where light enters.
    pub entry: EntryPoint,
    /// Places around a point whose ways are followed, 1 to 64: features of the back show through less. One is the point's own.
    pub samples: u32,
    /// Radius of the disc that these are spread over, across the light's direction, mm, 0 to 1000.
    pub filter_radius_mm: f32,
    /// Surfaces along the light's way that are told apart, 1 to 16; all behind the last of them is taken for flesh. 1 is the
    /// paper's depth map, more are what depth peeling finds.
    pub layers: u32,
}

/// What a distance through the body leaves of the light.
#[derive(Debug, Clone, PartialEq)]
pub enum FallOff {
    /// e^(-s sigma_t), sigma_t one over the distance that the material spreads light by.
    Material,
    /// The same with an extinction for each channel, 1/mm.
    Exponential(Vec3),
    /// A colour for each distance.
    Ramp(Arc<ColourRamp>),
}

/// What is known of the place where light enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryPoint {
    /// How far it is (listing 16-4): light enters as if it were faced, and spreads over the surface it leaves by.
    Distance,
    /// Its normal and its colour, too (section 16.3.1).
    Surface,
}

impl EntryPoint {
    /// All of them.
    pub const ALL: [EntryPoint; 2] = [EntryPoint::Distance, EntryPoint::Surface];
}

impl fmt::Display for EntryPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            EntryPoint::Distance => "distance",
            EntryPoint::Surface => "surface",
        })
    }
}

impl Default for DepthAbsorptionSettings {
    fn default() -> Self {
        Self {
            fall_off: FallOff::Material,
            growth_mm: 0.5,
            entry: EntryPoint::Surface,
            samples: 8,
            filter_radius_mm: 1.0,
            layers: 1,
        }
    }
}

impl DepthAbsorptionSettings {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        if let FallOff::Exponential(sigma_t) = self.fall_off {
            let bad = |s: &f32| !(*s >= 0.0 && s.is_finite());
            let worst = sigma_t.to_array().into_iter().find(bad).unwrap_or(0.0);
            within("sigma_t", worst, "not negative and finite, in 1/mm", !bad(&worst))?;
        }
        let lengths_mm = [("growth", self.growth_mm), ("radius of the filter", self.filter_radius_mm)];
        for (name, length_mm) in lengths_mm {
            within(name, length_mm, "0 to 1000 mm", (0.0..=1000.0).contains(&length_mm))?;
        }
        within("samples of the depth map", self.samples as f32, "1 to 64", (1..=64).contains(&self.samples))?;
        within("layers of the depth map", self.layers as f32, "1 to 16", (1..=16).contains(&self.layers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_numbers_are_named() {
        let refused =
            |settings: DepthAbsorptionSettings| settings.check().expect_err("is out of range").to_string();
        let usual = DepthAbsorptionSettings::default;
        assert!(usual().check().is_ok());
        for (sigma, got) in [(-1.0, "got -1"), (f32::NAN, "got NaN"), (f32::INFINITY, "got inf")] {
            let fall_off = FallOff::Exponential(Vec3::new(1.0, sigma, 0.0));
            let told = refused(DepthAbsorptionSettings { fall_off, ..usual() });
            assert!(told.starts_with("sigma_t must be not negative") && told.ends_with(got), "{told}");
        }
        for growth_mm in [-0.1, 1001.0, f32::NAN] {
            let told = refused(DepthAbsorptionSettings { growth_mm, ..usual() });
            assert_eq!(told, format!("growth must be 0 to 1000 mm, got {growth_mm}"));
        }
        let radius = refused(DepthAbsorptionSettings { filter_radius_mm: -1.0, ..usual() });
        assert_eq!(radius, "radius of the filter must be 0 to 1000 mm, got -1");
        let samples = refused(DepthAbsorptionSettings { samples: 0, ..usual() });
        assert_eq!(samples, "samples of the depth map must be 1 to 64, got 0");
        let layers = refused(DepthAbsorptionSettings { layers: 17, ..usual() });
        assert_eq!(layers, "layers of the depth map must be 1 to 16, got 17");
    }
}
