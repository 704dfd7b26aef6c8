//! A homogeneous scattering medium.

/// Absorption, reduced scattering and refractive index of one medium at one wavelength or channel.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Medium {
    /// Absorption coefficient sigma_a, 1/mm.
    pub sigma_a_per_mm: f64,
    /// Reduced scattering coefficient sigma_s' = (1 - g) sigma_s, 1/mm.
    pub sigma_s_reduced_per_mm: f64,
    /// Refractive index relative to air.
    pub refractive_index: f64,
}
