//! How far the two backends may be apart: the one table of it.
//!
//! What both compute the same way differs by rounding: 16-bit floats hold 11 bits, an error of 1/4096 on the mean for each
//! of the few maps that a value passes through. What they compute differently (rays against maps for what is hidden, taps
//! against sampled Gaussians, many samples of a pixel against one that is shared) differs by what was measured on llvmpipe,
//! with a third to a half to spare.

/// What is allowed; see `Difference`.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    /// Mean absolute difference, relative to the mean.
    pub mean: f32,
    /// Share of texels that differ by more than a tenth of the mean.
    pub far: f32,
}

const fn tolerance(mean: f32, far: f32) -> Tolerance {
    Tolerance { mean, far }
}

/// Positions, mm over mm: barycentric weights have 16 bits.
pub const PLACES: Tolerance = tolerance(1e-4, 0.0);
/// Normals, smooth and with relief.
pub const NORMALS: Tolerance = tolerance(1e-4, 1e-4);
/// Stretch.
pub const STRETCH: Tolerance = tolerance(6e-4, 1e-4);
/// Places of deformed vertices, mm: coordinates of 200 mm have steps of 1.5e-5 mm, and a few are added; sines of the
/// device err by 1e-6 of an amplitude of 10 mm.
pub const DEFORMED_MM: f32 = 4e-4;
/// Normals and tangents of deformed vertices, as lengths of differences.
pub const DEFORMED_DIRECTIONS: f32 = 2e-5;
/// Picture of the built-in head with a wave through it.
pub const WAVED_HEAD: Tolerance = tolerance(0.065, 0.03);
/// Picture of a hand whose fingers are bent.
pub const BENT_HAND: Tolerance = tolerance(0.065, 0.03);
/// How open a floor before a wall is, against the closed form: on the mean and at worst.
pub const WALL: [f32; 2] = [0.02, 0.075];
/// How open the head is: many rays against 48 directions.
pub const OPENNESS: Tolerance = tolerance(0.015, 0.001);
/// Mean open directions of the head.
pub const BENT_NORMALS: Tolerance = tolerance(0.022, 0.0035);
/// Irradiance of an unhidden patch. Everywhere it looks up the same place of the environment and of the table, so that what
/// 16-bit floats round off there does not average out.
pub const IRRADIANCE: Tolerance = tolerance(1.3e-3, 1e-4);
/// Fraction of sharp lights that is seen, on the head.
pub const VISIBILITY: Tolerance = tolerance(0.0172, 0.0119);
/// Distance through a ball.
pub const DISTANCE: Tolerance = tolerance(0.05, 0.065);
/// Every level of the diffusion, from the same light.
pub const LEVELS: Tolerance = tolerance(0.024, 0.06);
/// Sum of the Gaussians, from the same light.
pub const LOCAL: Tolerance = tolerance(0.006, 1e-3);
/// Light through the head. Little comes through: most of the difference lies along the edges of shadows, where the maps
/// cannot tell how thin a body is.
pub const TRANSMISSION: Tolerance = tolerance(0.825, 0.12);
/// Normals and colours of a whole picture.
pub const SURFACE: Tolerance = tolerance(0.0218, 0.0102);
/// Light that has been inside, in a whole picture.
pub const DIFFUSE: Tolerance = tolerance(0.0175, 0.0133);
/// Pictures of patches, which nothing hides.
pub const PATCH: Tolerance = tolerance(0.007, 1e-3);
/// Picture of the built-in head.
pub const HEAD: Tolerance = tolerance(0.0535, 0.0186);
/// Picture of the head with three lights and the environment.
pub const THREE_LIGHTS: Tolerance = tolerance(0.0552, 0.0247);
/// The head by wrap lighting, with its shine and the environment, and by wide wraps alone: shadows are as sharp as the maps
/// that tell them. Measured 0.0403 and 0.0168, 0.0124 and 0.0254.
pub const WRAPPED_HEAD: [Tolerance; 2] = [tolerance(0.055, 0.026), tolerance(0.02, 0.037)];
/// A shadow over a plate that the light grazes, by wrap: its edge is one of texels. Measured 0.0036 and 0.0091.
pub const WRAPPED_SHADOW: Tolerance = tolerance(0.005, 0.0125);
/// The head before a lamp, drawn by distances through it: the picture, and what comes through.
pub const BACKLIT_HEAD: [Tolerance; 2] = [tolerance(0.055, 0.055), tolerance(0.09, 0.06)];
/// Two fingers with all numbers of that technique other than usual.
pub const PEELED_FINGERS: [Tolerance; 2] = [tolerance(0.022, 0.004), tolerance(0.022, 0.004)];
/// A finger in a pose against one that was uploaded so.
pub const POSED_FINGER: Tolerance = tolerance(0.002, 1e-3);
/// Picture of the scanned head.
pub const SCAN: Tolerance = tolerance(0.0265, 0.0405);
/// Exact convolution: relative RMS power error of one lit texel (d'Eon et al. 2007, equation 10). The processor's limit.
pub const ONE_LIT_TEXEL: f64 = 0.006;
/// Change of the energy of one lit texel.
pub const ENERGY: f64 = 0.005;
/// Shine in a whole picture: silhouettes are a hundred times as bright as the rest, and a jittered sample more or less at
/// them counts as much as many pixels.
pub const SHINE: Tolerance = tolerance(0.183, 0.0935);
/// Constants after every blur. llvmpipe cuts 16-bit floats off instead of rounding them: up to 1/2048 in each of 13 passes,
/// of which it is half on the mean.
pub const CONSTANT: f32 = 4e-3;
/// Equation 16: the share, and what 16-bit floats lose of little light, W/m².
pub const EQUATION_16: [f64; 2] = [0.03, 2e-5];
/// Radiance in a white furnace of radiance 1: 16-bit floats in the filtered environment, the table and the maps.
pub const FURNACE: f32 = 6e-3;
/// Share of a close view of the scan's ear that is lit on the adapter and dark on the processor, and the other way round.
pub const EAR: [f32; 2] = [0.0022, 0.00025];
/// The same of its nostrils.
pub const NOSTRILS: [f32; 2] = [0.0004, 0.0001];
/// Codes of 8 bits by which the films may be apart: the dither is the same, a value at a threshold may round to either side.
pub const CODES_APART: u8 = 1;
/// Share of the codes that differ at all, where a share of the light was spread: llvmpipe cuts the 16-bit floats of the glow
/// off, by up to 1/2048 in each of three passes, of which it is half on the mean.
pub const fn codes_that_differ(spread: f32) -> f32 {
    1e-3 + 0.15 * spread
}
/// Mismatch of light across seams: the sum of all differences over the sum of the processor's. Along a seam, where the
/// mismatch is found, texels of both charts share one place of the taps, which have half the size.
pub const SEAMS: f32 = 0.13;
/// Light through a plate of parallel sides: the distance is that of a texel's middle, the rest is rounding.
pub const PLATE: Tolerance = tolerance(0.01, 1e-3);
/// Pictures of a patch and of the built-in head under projectors: what they throw ends at an edge, and a texel across it is on
/// either side by the last digit of its place. Measured: 0.0052 and 0.0019; 0.0111 and 0.0216.
pub const PROJECTED: [Tolerance; 2] = [tolerance(0.007, 0.003), tolerance(0.016, 0.03)];
/// Irradiance with such an edge, before anything spreads it: measured 0.0038 and 0.0104.
pub const SHARP: Tolerance = tolerance(0.006, 0.015);
/// Picture and maps of a patch with veins under it. Without a blur their edges are as sharp as texels, which samples of the
/// picture that lie close together share on one backend only: measured 0.0042 and 0.0032.
pub const VEINS: Tolerance = tolerance(0.007, 0.005);
/// Light inside the head after seven-tap blurs, which leave edges of shadows sharper than a sum of Gaussians does: measured
/// 0.0108 and 0.0149.
pub const SEVEN_TAPS: Tolerance = tolerance(0.0175, 0.02);
/// A patch by samples of the profile: the processor draws a random place of each pixel, the adapter its middle.
/// Measured 0.0108 and 0.
pub const SAMPLED_PATCH: Tolerance = tolerance(0.015, 0.002);
/// A patch of two media by samples: the same, so that few pixels take the mixture beside it, and shares in steps of 1/255 on the
/// adapter. Measured 0.0125 and 0.0043.
pub const SAMPLED_MIXTURE: Tolerance = tolerance(0.017, 0.006);
/// The head by samples: the same, and shadows that maps tell. Measured 0.0206 and 0.0511.
pub const SAMPLED_HEAD: Tolerance = tolerance(0.028, 0.068);
/// Light through a plate, all of it from what the lamp sees.
/// Measured 0.0074 and 0.0117.
pub const SAMPLED_PLATE: Tolerance = tolerance(0.011, 0.017);
