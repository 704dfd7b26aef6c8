//! `cutis`, the program: renders skin and other translucent materials from the command line.
//!
//! The story of a run: words become a [`cli::Cli`] of plain values; `render` checks them into a [`job::Job`], reads the
//! scene, draws it, develops the film, writes the files and says where they are. Results go to stdout, talk to
//! stderr. Exit code 0: done; 1: finished, but a check failed; 2: could not run.

mod backend;
mod cli;
mod compare;
mod completions;
mod diff;
mod job;
mod layer_words;
mod machine;
mod measure;
mod presets;
mod profile;
mod progress;
mod render;
mod report;
mod scene_source;
mod simulate;
mod talk;
mod techniques;
mod validate;
mod view;
mod whole_file;

use cli::{Cli, Command};
use std::process::ExitCode;

/// How a command that ran has ended.
enum Outcome {
    /// All is well.
    Done,
    /// There is a result, but it is not what it should be.
    CheckFailed,
}

fn main() -> ExitCode {
    let cli = match cli::parse() {
        Ok(cli) => cli,
        Err(answer) => return answer,
    };
    talk::start(cli.verbose);
    match run(&cli) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Err(report) => {
            talk::complain(&report);
            ExitCode::from(2)
        }
    }
}

fn run(cli: &Cli) -> miette::Result<Outcome> {
    match &cli.command {
        Command::Render(args) => render::run(args, cli.verbose),
        Command::View(args) => view::run(args),
        Command::Compare(args) => compare::run(args, cli.verbose),
        Command::Diff(args) => diff::run(args),
        Command::Validate(args) => validate::run(args, cli.verbose),
        Command::Profile(args) => profile::run(args, cli.verbose),
        Command::Simulate(args) => simulate::run(args, cli.verbose),
        Command::Presets(args) => presets::run(args),
        Command::Completions(args) => completions::run(args),
    }
}
