//! A mean with its standard error.

use glam::DVec3;

/// Sums over independent samples of a colour.
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Estimate {
    sum: DVec3,
    squares: DVec3,
    count: f64,
}

impl Estimate {
    /// Adds a sample.
    pub fn add(&mut self, sample: DVec3) {
        self.sum += sample;
        self.squares += sample * sample;
        self.count += 1.0;
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.count as u64
    }

    /// Mean of the samples; 0 without any.
    pub fn mean(&self) -> DVec3 {
        self.sum / self.count.max(1.0)
    }

    /// Standard error of the mean; infinite below two samples.
    pub fn standard_error(&self) -> DVec3 {
        if self.count < 2.0 {
            return DVec3::INFINITY;
        }
        let mean = self.mean();
        let variance = (self.squares / self.count - mean * mean).max(DVec3::ZERO);
        (variance / (self.count - 1.0)).map(f64::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_samples_by_hand() {
        let mut estimate = Estimate::default();
        [1.0, 2.0, 6.0].into_iter().for_each(|x| estimate.add(DVec3::splat(x)));
        // Mean 3; squared deviations 4 + 1 + 9 = 14, over 2 and 3.
        assert!((estimate.mean().x - 3.0).abs() < 1e-15);
        assert!((estimate.standard_error().x - (14.0f64 / 6.0).sqrt()).abs() < 1e-14);
    }
}
