//! What is counted of a batch of packets.

/// How finely exits and absorption are counted. What lies beyond the last bin is counted in one bin more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Width of a ring around the beam, mm.
    pub radial_step_mm: f64,
    /// Rings.
    pub radial_bins: usize,
    /// Height of a sheet, mm.
    pub depth_step_mm: f64,
    /// Sheets.
    pub depth_bins: usize,
    /// Bins of the cosine of the angle to the normal at which light leaves, evenly from 0 to 1.
    pub cosine_bins: usize,
}

/// Weights by where they ended, for a batch; the beam has 1 for every packet.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pub(super) grid: Grid,
    pub(super) packets: u64,
    /// All counters one after another; [`Slots`] says where.
    pub(super) values: Vec<f64>,
    slots: Slots,
    rings_per_mm: f64,
    sheets_per_mm: f64,
}

/// Where each counter begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slots {
    pub(super) layers: usize,
    pub(super) reflectance_by_radius: usize,
    pub(super) transmittance_by_radius: usize,
    pub(super) reflectance_by_cosine: usize,
    pub(super) transmittance_by_cosine: usize,
    pub(super) absorption_by_depth: usize,
    pub(super) count: usize,
}

pub(super) const SPECULAR: usize = 0;
pub(super) const REFLECTANCE: usize = 1;
pub(super) const TRANSMITTANCE: usize = 2;
pub(super) const ROULETTE: usize = 3;
pub(super) const ABSORBED: usize = 4;
const FIXED: usize = 5;

impl Slots {
    pub(super) fn new(grid: &Grid, layers: usize) -> Self {
        let rings = grid.radial_bins + 1;
        let reflectance_by_radius = FIXED + layers;
        let transmittance_by_radius = reflectance_by_radius + rings;
        let reflectance_by_cosine = transmittance_by_radius + rings;
        let transmittance_by_cosine = reflectance_by_cosine + grid.cosine_bins;
        let absorption_by_depth = transmittance_by_cosine + grid.cosine_bins;
        let count = absorption_by_depth + grid.depth_bins + 1;
        Self {
            layers: FIXED,
            reflectance_by_radius,
            transmittance_by_radius,
            reflectance_by_cosine,
            transmittance_by_cosine,
            absorption_by_depth,
            count,
        }
    }
}

impl Tally {
    pub(super) fn new(grid: &Grid, layers: usize) -> Self {
        let slots = Slots::new(grid, layers);
        Self {
            grid: *grid,
            packets: 0,
            values: vec![0.0; slots.count],
            slots,
            rings_per_mm: grid.radial_step_mm.recip(),
            sheets_per_mm: grid.depth_step_mm.recip(),
        }
    }

    pub(super) fn begin_packet(&mut self, specular_reflectance: f64) {
        self.packets += 1;
        self.values[SPECULAR] += specular_reflectance;
    }

    /// Weight that left through the top or the bottom.
    #[inline]
    pub(super) fn leave(&mut self, downwards: bool, r_mm: f64, cos: f64, weight: f64) {
        let Slots { reflectance_by_radius, transmittance_by_radius, .. } = self.slots;
        let Slots { reflectance_by_cosine, transmittance_by_cosine, .. } = self.slots;
        let (total, rings, cosines) = if downwards {
            (TRANSMITTANCE, transmittance_by_radius, transmittance_by_cosine)
        } else {
            (REFLECTANCE, reflectance_by_radius, reflectance_by_cosine)
        };
        self.values[total] += weight;
        // Casts saturate: far away is the last bin.
        let ring = (r_mm * self.rings_per_mm) as usize;
        self.values[rings + ring.min(self.grid.radial_bins)] += weight;
        if self.grid.cosine_bins > 0 {
            let bin = (cos * self.grid.cosine_bins as f64) as usize;
            self.values[cosines + bin.min(self.grid.cosine_bins - 1)] += weight;
        }
    }

    /// Weight that was absorbed.
    #[inline]
    pub(super) fn absorb(&mut self, layer: usize, depth_mm: f64, weight: f64) {
        self.values[ABSORBED] += weight;
        self.values[self.slots.layers + layer] += weight;
        let sheet = (depth_mm * self.sheets_per_mm) as usize;
        self.values[self.slots.absorption_by_depth + sheet.min(self.grid.depth_bins)] += weight;
    }

    /// Weight that Russian roulette took away (or, negative, gave).
    #[inline]
    pub(super) fn roulette(&mut self, weight: f64) {
        self.values[ROULETTE] += weight;
    }
}
