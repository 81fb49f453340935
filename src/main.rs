//! The command `mtess`.

mod certificate;
mod coarsening;
mod commands;
mod files;
mod kept;
mod memory;
mod progress;
mod selection;
mod subject;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = commands::Cli::parse();
    progress::hear_interruptions();
    match commands::run(cli) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {}", plain(&error.to_string()));
            ExitCode::FAILURE
        }
    }
}

/// On one line, and without what a terminal would obey: names come from anybody.
fn plain(text: &str) -> String {
    let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    text.chars().map(shown).collect()
}
