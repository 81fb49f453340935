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
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
