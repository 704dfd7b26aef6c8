//! The kernel that light is spread by, as technique and operator want it.

use crate::RenderError;
use crate::prepare::Kernel;
use crate::prepare::kernel::kernel_of;
use crate::settings::{Diffusion, Settings, TechniqueName};
use cutis_scene::Material;

/// Standard deviations of the widest Gaussian beyond which a body is opaque: exp(-5.5²/2) = 3e-7 comes through, which
/// transmission takes for nothing.
const OPAQUE_DEVIATIONS: f32 = 5.5;

/// The kernel of a material under the diffusion operator of the settings.
///
/// # Errors
/// If the material cannot be turned into a kernel, or its thickness scale makes no sense.
pub fn chosen_kernel(material: &Material, settings: &Settings) -> Result<Kernel, RenderError> {
    check_thickness_scale(material)?;
    let kernel = kernel_of(material, settings.gaussians)?;
    // Only one technique spreads light by its Gaussians; the others take their total for the colour of the body.
    Ok(match (settings.technique, settings.diffusion) {
        (TechniqueName::TextureSpace, Diffusion::Separable | Diffusion::HeatFlow) => {
            kernel.without(&settings.muted_gaussians)
        }
        // What was blurred, and the share of what was not.
        (TechniqueName::TextureBlur, Diffusion::Separable | Diffusion::HeatFlow) => {
            let (total, blend) = (kernel.total(), settings.techniques.texture_blur.blend);
            Kernel { variances_mm2: vec![0.0; 2], weights: vec![total * blend, total * (1.0 - blend)] }
        }
        _ => Kernel::opaque(kernel.total()),
    })
}

fn check_thickness_scale(material: &Material) -> Result<(), RenderError> {
    let scale = material.thickness_scale;
    if scale.is_finite() && scale >= 0.0 {
        return Ok(());
    }
    let reason = format!("its thickness scale is {scale}; it must be finite and not negative");
    Err(RenderError::BadMaterial { material: material.name.clone(), reason })
}

/// Thickness of a body, scaled, beyond which nothing comes through, mm.
pub fn opaque_mm(kernel: &Kernel) -> f32 {
    OPAQUE_DEVIATIONS * kernel.reach_mm()
}
