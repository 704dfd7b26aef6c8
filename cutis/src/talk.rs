//! Results to stdout, talk to stderr. Neither a closed pipe nor a closed stderr stops a run.

use miette::{IntoDiagnostic, Report};
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use tracing::level_filters::LevelFilter;

/// Starts the log on stderr: warnings, with `-v` what is done, with `-vv` how.
pub fn start(verbose: u8) {
    let level = match verbose {
        0 => LevelFilter::WARN,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    let log = tracing_subscriber::fmt().with_writer(stderr).with_max_level(level);
    log.with_ansi(stderr().is_terminal()).without_time().with_target(false).init();
}

/// Prints a result on stdout, and the end of its line. A reader that went away has what it wanted.
pub fn say(result: &str) -> miette::Result<()> {
    let mut out = stdout().lock();
    match writeln!(out, "{result}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.into_diagnostic(),
    }
}

/// Prints talk on stderr; if that is gone there is nobody to tell.
pub fn tell(words: &str) {
    let _ = writeln!(stderr().lock(), "{words}");
}

/// Prints why the program could not run: one line, and one with help where there is some.
pub fn complain(report: &Report) {
    tell(&format!("error: {report:#}"));
    if let Some(help) = report.help() {
        tell(&format!("help: {help}"));
    }
}
