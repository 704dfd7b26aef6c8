//! Flags of `wrap`.

use super::{colour, one_of, switch};
use clap::Args;
use cutis_render::technique::wrap::{WrapForm, WrapShine};
use glam::Vec3;

/// Light that wraps around the body.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Technique wrap (Green 2004, section 16.2)")]
pub struct WrapArgs {
    /// How far light goes on beyond the terminator [cosine, 0 to 1, default 0.2]
    #[arg(long, value_name = "COSINE", allow_negative_numbers = true)]
    pub wrap: Option<f32>,
    /// Width of the tint where light ends [wrapped cosine, 0 to 1, default 0.3]
    #[arg(long, value_name = "COSINE", allow_negative_numbers = true)]
    pub scatter_width: Option<f32>,
    /// Colour of that tint [parts of the irradiance, linear, 0 to 1, default 0.15,0,0]
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true, value_parser = colour)]
    pub scatter_colour: Option<Vec3>,
    /// Whether a table over N·L and N·H is read, as in the paper, or the function computed at every place [default: table]
    #[arg(long, value_name = "NAME", value_parser = one_of(&WrapForm::ALL))]
    pub wrap_form: Option<WrapForm>,
    /// Whether a whole ball sends back no more light than a Lambertian one [default: off]
    #[arg(long, value_name = "SWITCH", value_parser = switch())]
    pub wrap_energy_conserving: Option<bool>,
    /// Radius of the body: each channel wraps as far as the material spreads light over it, in place of --wrap [mm, above 0,
    /// default: none]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub wrap_radius: Option<f32>,
    /// How the surface reflects lights: by the measured lobe of all techniques, or by a power of N·H, as in the paper
    /// [default: measured]
    #[arg(long, value_name = "NAME", value_parser = one_of(&WrapShine::ALL))]
    pub wrap_shine: Option<WrapShine>,
    /// Exponent of that power [1 to 1000, default 40]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub shininess: Option<f32>,
    /// Colour of that power [parts of the irradiance, linear, 0 to 1, default 0.2,0.2,0.2]
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true, value_parser = colour)]
    pub wrap_specular: Option<Vec3>,
    /// How far above the surface a place where the light ends looks for what hides it; a tenth of that at the terminator [mm,
    /// 0 to 1000, default 10]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub wrap_shadow_offset: Option<f32>,
}
