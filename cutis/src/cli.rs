//! The words of the command line and what they mean, as plain values. What they may be is checked in
//! [`crate::job`].

mod compare;
mod diff;
mod profile;
mod technique;
mod validate;
mod view;

use crate::backend::Backend;
use crate::talk;
use crate::techniques::paper::Paper;
use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::{Args, Parser, Subcommand};
pub use compare::CompareArgs;
use cutis_optics::presets;
use cutis_render::film::ToneMapper;
use cutis_render::settings::Quality;
use cutis_render::{Aov, AovSpace, Diffusion, Settings, TechniqueName};
use cutis_scene::AtlasChoice;
pub use diff::DiffArgs;
pub use profile::{METHODS, ProfileArgs};
use std::fmt::Display;
use std::path::PathBuf;
use std::process::ExitCode;
pub use technique::{DepthAbsorptionArgs, ImageSpaceArgs, TechniqueArgs, TextureBlurArgs, WrapArgs, colour};
pub use validate::ValidateArgs;
pub use view::ViewArgs;

/// Diffusion operators that can be chosen.
pub const DIFFUSIONS: [Diffusion; 3] = [Diffusion::None, Diffusion::Separable, Diffusion::HeatFlow];

/// Names of [`AovSpace`].
pub const AOV_SPACES: [(&str, AovSpace); 2] =
    [("picture", AovSpace::Picture), ("texture", AovSpace::Texture)];

/// Renders skin and other translucent materials.
#[derive(Debug, Parser)]
#[command(name = "cutis", version, about, arg_required_else_help = true, max_term_width = 110)]
pub struct Cli {
    /// Say more on stderr: -v what is done, -vv how
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a picture of a scene, or of the built-in head
    Render(Box<RenderArgs>),
    /// Look at a scene in a window: turn it, light it, change its skin, see every pass
    View(ViewArgs),
    /// Render a scene with every technique and write a page with pictures, errors and times
    Compare(Box<CompareArgs>),
    /// Tell how far a picture is from a reference: RMSE, relative MSE, bias, FLIP
    Diff(DiffArgs),
    /// Render small scenes with every technique and judge them by the simulated truth that is kept
    Validate(ValidateArgs),
    /// Compute a diffusion profile, fit it by Gaussians, plot it, export it
    Profile(Box<ProfileArgs>),
    /// Simulate light in layered slabs by Monte Carlo
    Simulate(SimulateArgs),
    /// List the materials, heads, environments and techniques that ship inside
    Presets(PresetsArgs),
    /// Print a completion script for a shell
    Completions(CompletionsArgs),
}

/// Arguments of `cutis render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scene to render: .toml, .glb, .gltf or .obj; left out: the built-in head
    pub scene: Option<PathBuf>,
    /// Picture to write: .png (developed, sRGB) or .exr (radiance as rendered, layers inside)
    #[arg(short, long, value_name = "FILE", default_value = "cutis.png")]
    pub output: PathBuf,
    /// Method that draws the picture [default: texture-space, or that of --as-in]
    #[arg(long, value_name = "NAME", value_parser = names(TechniqueName::ALL))]
    pub technique: Option<String>,
    /// Numbers of a paper's own technique, where it tells them; flags that are given win. green-2004: the numbers of its
    /// listings, for --technique wrap, depth-absorption or texture-blur; mertens-2003: image-space, 500x500 pixels, the
    /// material skin1, the scene scaled as a whole so that its longest side is 100 mm, without Jacobian and without views
    /// of lights
    #[arg(long, value_name = "PAPER", value_parser = names(Paper::ALL))]
    pub as_in: Option<String>,
    /// How light spreads under the surface; heat-flow: from texel to texel, across seams; separable: blurs along u and v as
    /// d'Eon et al. 2007 have them; none: the surface is opaque
    #[arg(long, value_name = "NAME", default_value_t = Settings::default().diffusion.to_string(), value_parser = names(DIFFUSIONS))]
    pub diffusion: String,
    /// Where it is computed; auto: on a graphics processor if there is one, else on the processor; gpu: on any graphics
    /// adapter, also a program that stands in for one
    #[arg(long, value_name = "NAME", default_value_t = Backend::Auto.to_string(), value_parser = names(Backend::ALL))]
    pub backend: String,
    /// Sizes and numbers of samples that no other flag names, after table 1 of d'Eon et al. 2007; full: 1250x750 pixels of 4
    /// samples, maps of 2048² texels; low: 1024x1024 of 1, 1024², half of the rays; auto: as told below
    #[arg(long, value_name = "NAME", default_value_t = Quality::Auto.to_string(), value_parser = names(Quality::ALL))]
    pub quality: String,
    /// Width and height of the picture [pixels, 1x1 to 16384x16384, default 1024x1024]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub size: Option<String>,
    /// Samples per pixel; texture-space rounds them up to a square number [1 to 1048576, default 4]
    #[arg(long, value_name = "N")]
    pub samples: Option<u32>,
    /// Noise at which truth stops before all samples are taken: root mean squared standard error over mean radiance
    /// [fraction, above 0, below 1, default: none]
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true)]
    pub target_error: Option<f64>,
    /// Go on from OUTPUT.paths, if it is there, and keep the state of truth in it three times a minute; more samples
    /// may be asked for later
    #[arg(long)]
    pub resume: bool,
    /// Cap the holes of open bodies, for truth, which needs closed ones
    #[arg(long)]
    pub close_holes: bool,
    /// Seed of every random choice: the same seed gives the same bytes [0 to 2^64 - 1]
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
    pub seed: u64,
    /// Layer to write beside the picture; may be given several times. In an EXR file as a named layer, otherwise as
    /// NAME.LAYER.png beside the picture
    #[arg(long, value_name = "LAYER", value_parser = names(Aov::all()))]
    pub aov: Vec<String>,
    /// Layers as the camera sees them, or as textures of the first object
    #[arg(long, value_name = "SPACE", default_value = "picture", value_parser = names(AOV_SPACES.map(|(name, _)| name)))]
    pub aov_space: String,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long)]
    pub json: bool,
    /// Width and height of the largest object's irradiance texture, rounded up to a multiple of 8 [texels, 16 to 16384,
    /// default 2048]
    #[arg(long, value_name = "N")]
    pub irradiance_size: Option<u32>,
    /// Gaussians in the kernel of a material given by its coefficients [1 to 16]
    #[arg(long, value_name = "N", default_value_t = Settings::default().gaussians)]
    pub gaussians: usize,
    /// Shadow rays per texel towards lights with an extent [1 to 1024, default 4]
    #[arg(long, value_name = "N")]
    pub shadow_samples: Option<u32>,
    /// Measure what the diffusion did: change of energy, mismatch across UV seams, and how wide texels lie on the surface; where
    /// that differs much, --atlas new serves light better
    #[arg(long)]
    pub diffusion_report: bool,
    /// Ambient-occlusion rays per texel of the occlusion map [1 to 4096, default 6]
    #[arg(long, value_name = "N")]
    pub ambient_samples: Option<u32>,
    /// Light of the picture, on top of the scene camera's own exposure; not for EXR [EV (stops), -32 to 32, default 0]
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    pub exposure_ev: Option<f32>,
    /// Curve from scene light to screen light; not for EXR [default: neutral]
    #[arg(long, value_name = "NAME", value_parser = names(ToneMapper::ALL))]
    pub tone_mapper: Option<String>,
    /// Share of the light that glows around bright things; not for EXR [fraction, 0 to 1, default 0.04]
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true)]
    pub bloom: Option<f32>,
    /// Bits per channel: PNG 8 or 16 [default 8], EXR 16 or 32 [default 16]
    #[arg(long, value_name = "BITS")]
    pub bits: Option<u32>,
    /// Threads to work with [1 to 1024, default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Length of the mesh file's unit [mm, above 0, default: what the file says; 1000 for glTF]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub millimetres_per_unit: Option<f32>,
    /// Scale the whole scene, lights and camera too, so that the longest side of the box around it is so long; the material
    /// stays, so that light goes farther through a smaller head [mm, above 0, default: as long as it is]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub longest_side: Option<f32>,
    /// How long light that moves has moved: images of projectors with a drift [s, 0 to 100000, default 0]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// Material of all objects, by the name of a preset, instead of their own scattering
    #[arg(long, value_name = "NAME", value_parser = names(presets::all().iter().map(|preset| preset.name)))]
    pub material: Option<String>,
    /// Where light lies: own: where the mesh's texture coordinates say, if they can carry it; new: in an atlas that is made, with
    /// even texels [own or new, default: what the scene file says, else own]
    #[arg(long, value_name = "NAME", value_parser = names(AtlasChoice::ALL.map(AtlasChoice::name)))]
    pub atlas: Option<String>,
    /// Diffuse colour texture for all objects, instead of their own
    #[arg(long, value_name = "FILE")]
    pub albedo: Option<PathBuf>,
    /// Tangent-space normal map for all objects, instead of their own
    #[arg(long, value_name = "FILE")]
    pub normal: Option<PathBuf>,
    /// Map of specular intensity for all objects, instead of their own
    #[arg(long, value_name = "FILE")]
    pub specular: Option<PathBuf>,
    /// Latitude-longitude map that lights the scene from all around (.exr or .hdr), instead of its own
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// Triangles of the built-in head, about [1000 to 4000000, default 100000]
    #[arg(long, value_name = "N")]
    pub triangles: Option<usize>,
    /// Width and height of the built-in head's maps; 0: no maps [texels, 0 to 8192, default 2048]
    #[arg(long, value_name = "N")]
    pub map_size: Option<u32>,
    #[command(flatten)]
    pub techniques: TechniqueArgs,
}

/// Arguments of `cutis simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// A layer, top first; may be given several times: "mu_a=..,mu_s=..,g=..,n=..,d=.." [mu_a, mu_s: 1/mm; d: mm, inf for
    /// the last; without g 0, without n 1, without d inf]
    #[arg(long, value_name = "LAYER", required = true)]
    pub layer: Vec<String>,
    /// Photon packets [2048 to 10^12]
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub photons: u64,
    /// Seed of every random choice: the same seed gives the same numbers [0 to 2^64 - 1]
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
    pub seed: u64,
    /// Rings around the beam in which exits are counted [1 to 100000]
    #[arg(long, value_name = "N", default_value_t = crate::simulate::default_rings())]
    pub rings: usize,
    /// Width of a ring [mm, above 0, default: a twentieth of a transport mean free path]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub ring_width: Option<f64>,
    /// Threads to work with [1 to 1024, default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `cutis presets`.
#[derive(Debug, Args)]
pub struct PresetsArgs {
    /// Print one JSON object, with all numbers [coefficients in 1/mm, variances in mm²]
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `cutis completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: clap_complete::Shell,
}

/// Reads the command line. The error is the exit code, after the answer was printed.
pub fn parse() -> Result<Cli, ExitCode> {
    Cli::try_parse().map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A pipe that closed before it read the help is no error.
            let _ = talk::say(error.render().to_string().trim_end());
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            talk::tell(error.render().to_string().trim_end());
            ExitCode::from(2)
        }
        _ => {
            talk::complain(&miette::miette!(
                help = "cutis --help and cutis render --help list what there is",
                "{}",
                one_line(&error)
            ));
            ExitCode::from(2)
        }
    })
}

/// The parser's complaint without its usage and hints, on one line.
pub fn one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let told = text.lines().take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let words: Vec<_> = told.flat_map(str::split_whitespace).collect();
    let line = words.join(" ");
    line.strip_prefix("error: ").map_or(line.clone(), str::to_owned)
}

/// A parser of the names of some values.
fn names<T: Display>(values: impl IntoIterator<Item = T>) -> PossibleValuesParser {
    PossibleValuesParser::new(values.into_iter().map(|value| value.to_string()))
}

fn default_size() -> String {
    let settings = Settings::default();
    format!("{}x{}", settings.width, settings.height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use cutis_render::film::Film;
    use cutis_scene::head::HeadDetail;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn defaults_in_the_help_are_those_of_the_libraries() {
        let film = Film::default();
        let help = Cli::command().find_subcommand("render").map(|c| c.clone().render_long_help().to_string());
        let help = help.expect("there is a render command").split_whitespace().collect::<Vec<_>>().join(" ");
        let strength = film.bloom.map_or(0.0, |bloom| bloom.strength);
        assert!(help.contains(&format!("0 to 1, default {strength}")), "{help}");
        assert!(help.contains(&format!("[default: {}]", film.tone_mapper)), "{help}");
        let head = HeadDetail::default();
        assert!(help.contains(&format!("4000000, default {}", head.triangles)), "{help}");
        assert!(help.contains(&format!("8192, default {}", head.map_size)), "{help}");
        assert!(help.contains(&format!("-32 to 32, default {}", film.exposure_ev)), "{help}");
        let settings = Settings::default();
        assert!(help.contains(&format!("16384x16384, default {}", default_size())), "{help}");
        assert!(help.contains(&format!("1048576, default {}]", settings.samples_per_pixel)), "{help}");
        assert!(help.contains(&format!("16 to 16384, default {}]", settings.irradiance_size)), "{help}");
        assert!(help.contains(&format!("1 to 1024, default {}]", settings.shadow_samples)), "{help}");
        assert!(help.contains(&format!("1 to 4096, default {}]", settings.ambient_samples)), "{help}");
        let full = settings.clone().with_quality(Quality::Full);
        let words = format!(
            "full: {}x{} pixels of {} samples, maps of {}²",
            full.width, full.height, full.samples_per_pixel, full.irradiance_size
        );
        assert!(help.contains(&words), "{help}");
        let low = settings.with_quality(Quality::Low);
        let words = format!(
            "low: {}x{} of {}, {}²",
            low.width, low.height, low.samples_per_pixel, low.irradiance_size
        );
        assert!(help.contains(&words), "{help}");
    }

    #[test]
    fn defaults_of_the_techniques_in_the_help_are_their_own() {
        use cutis_render::settings::TechniqueSettings;
        use cutis_render::technique::texture_blur::BlurWidth;
        let help = Cli::command().find_subcommand("render").map(|c| c.clone().render_long_help().to_string());
        let help = help.expect("there is a render command").split_whitespace().collect::<Vec<_>>().join(" ");
        // What is said of a flag ends where the next one begins.
        let of = |flag: &str| {
            let start = help.find(&format!("{flag} <")).unwrap_or_else(|| panic!("{flag} is not in {help}"));
            let told = &help[start..];
            let is_next = |(at, _): &(usize, &str)| {
                told[at + 1..].split_whitespace().nth(1).is_some_and(|word| word.starts_with('<'))
            };
            told.match_indices(" --").find(is_next).map_or(told, |(end, _)| &told[..end]).to_owned()
        };
        let told = |flag: &str, default: &dyn Display| {
            let (text, words) = (of(flag), format!("default {default}]"));
            let named = format!("[default: {default}]");
            assert!(text.contains(&words) || text.contains(&named), "{words} is not in {text}");
        };
        let rgb = |c: glam::Vec3| format!("{},{},{}", c.x, c.y, c.z);
        let on = |is_on: bool| if is_on { "on" } else { "off" };
        let TechniqueSettings { wrap, depth_absorption: depth, texture_blur: blur, image_space: image } =
            TechniqueSettings::default();
        told("--wrap", &wrap.wrap);
        told("--scatter-width", &wrap.scatter_width);
        told("--scatter-colour", &rgb(wrap.scatter_colour));
        told("--wrap-form", &wrap.form);
        told("--wrap-energy-conserving", &on(wrap.energy_conserving));
        assert!(wrap.radius_mm.is_none() && of("--wrap-radius").contains("default: none]"));
        told("--wrap-shine", &wrap.shine);
        told("--shininess", &wrap.shininess);
        told("--wrap-specular", &rgb(wrap.specular_colour));
        told("--wrap-shadow-offset", &wrap.shadow_offset_mm);
        told("--growth", &depth.growth_mm);
        told("--entry", &depth.entry);
        told("--depth-samples", &depth.samples);
        told("--depth-filter-radius", &depth.filter_radius_mm);
        told("--depth-layers", &depth.layers);
        told("--blur-weights", &blur.weights);
        told("--blur-passes", &blur.passes);
        told("--blur-blend", &blur.blend);
        assert!(blur.width == BlurWidth::Listing(1.0) && of("--blur-width").contains("default 1]"));
        told("--blur-depth", &on(blur.depth));
        told("--profile-samples", &image.samples);
        told("--uniform-samples", &image.uniform_samples);
        told("--jacobian", &on(image.jacobian));
        told("--sample-count", &image.count);
        told("--light-views", &on(image.light_views));
        told("--sampled-profile", &image.profile);
        told("--technique", &format!("{}, or that of --as-in", Settings::default().technique));
    }

    #[test]
    fn complaints_fit_on_a_line() {
        let error = Cli::try_parse_from(["cutis", "render", "--technique", "raytrace"]).expect_err("unknown");
        let line = one_line(&error);
        assert!(line.starts_with("invalid value 'raytrace' for '--technique <NAME>'"), "{line}");
        assert!(line.contains("texture-space") && !line.contains('\n'), "{line}");
    }
}
