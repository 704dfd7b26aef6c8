//! Radial profiles as sums of Gaussians (d'Eon, Luebke & Enderton 2007, section 4).

/// One term: `weight * G(variance, r)`, with G(v, r) = exp(-r²/2v) / (2 pi v) of unit total.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Gaussian {
    /// Share of the energy.
    pub weight: f64,
    /// Variance along one axis, mm².
    pub variance_mm2: f64,
}

/// A profile of one channel.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GaussianSum {
    /// Terms by growing variance.
    pub terms: Vec<Gaussian>,
}

/// A profile of red, green and blue over shared variances: what the blur passes of a renderer need.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RgbGaussianSum {
    /// Variances along one axis, growing, mm².
    pub variances_mm2: Vec<f64>,
    /// Weights of red, green and blue for each variance.
    pub weights: Vec<[f64; 3]>,
}
