//! `cutis completions`: scripts that let a shell complete the program's words.

use crate::cli::{Cli, CompletionsArgs};
use crate::{Outcome, talk};
use clap::CommandFactory;

/// Prints the script for a shell.
pub fn run(args: &CompletionsArgs) -> miette::Result<Outcome> {
    // Into memory first: the generator panics when its writer fails, as a closed pipe does.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "cutis", &mut script);
    talk::say(String::from_utf8_lossy(&script).trim_end())?;
    Ok(Outcome::Done)
}
