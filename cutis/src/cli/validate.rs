//! The words of `cutis validate`.

use clap::Args;
use std::path::PathBuf;

/// Arguments of `cutis validate`.
#[derive(Debug, Args)]
pub struct ValidateArgs {
    /// Scene to judge by; may be given several times [default: all]
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// What to judge, such as texture-space,texture-space/none,image-space:jacobian=off; with numbers of its own it is measured
    /// and held to no bound [default: every technique, and the opaque surface]
    #[arg(long, value_name = "A,B,...")]
    pub techniques: Vec<String>,
    /// Folder of the truth: NAME.exr for every scene, and bounds.toml
    #[arg(long, value_name = "DIR", default_value = "truth")]
    pub truth: PathBuf,
    /// Render the truth anew, and take what is then measured for the bounds
    #[arg(long)]
    pub update: bool,
    /// Take what is measured for the bounds, by the truth that is kept
    #[arg(long)]
    pub accept: bool,
    /// Samples per pixel of that truth [16 to 1048576, default: 1024]
    #[arg(long, value_name = "N", requires = "update")]
    pub samples: Option<u32>,
    /// Folder for pictures to look at: the diffuse part of the truth and of each technique, and maps of the errors
    #[arg(long, value_name = "DIR")]
    pub pictures: Option<PathBuf>,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long, conflicts_with = "table")]
    pub json: bool,
    /// Print the numbers as a table in Markdown
    #[arg(long)]
    pub table: bool,
}
