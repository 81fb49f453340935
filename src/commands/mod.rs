//! The command line: one file per command.

mod bench;
mod bisect;
mod build;
mod extract;
mod history;
mod info;
mod movie;
mod paper;
mod render;
mod study;
mod verify;
#[cfg(feature = "view")]
mod view;

use crate::files::FileError;
use crate::selection::SelectionError;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Multi-Tessellations: build a multiresolution model of a mesh, extract from it, prove it right, look at it.
#[derive(Parser)]
#[command(name = "mtess", version, about, arg_required_else_help = true)]
pub struct Cli {
    /// Memory that may be taken, as in 900M, 8G or 4GiB: work that is expected to take more is refused before it begins, by an
    /// estimate. If not set, what is free on this machine
    #[arg(long, global = true, value_name = "BYTES", value_parser = crate::memory::parse_bytes)]
    memory_limit: Option<u64>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Coarsen a mesh to the end and keep every step as a model
    Build(build::Build),
    /// Write the history of a model as text, one modification a line
    History(history::History),
    /// Say what is in a model
    Info(info::Info),
    /// Extract a mesh: by error, by number of cells, for a camera, within a region
    Extract(extract::Extract),
    /// Check the laws of a model over random fronts
    Verify(verify::Verify),
    /// Find the first step of a log or a camera path at which something goes wrong
    Bisect(bisect::Bisect),
    /// Make a picture of an extracted mesh
    Render(render::Render),
    /// Open a window on one model or two: fly around, freeze, go back in time, ask what made a triangle
    #[cfg(feature = "view")]
    View(view::View),
    /// Make a picture of each frame of a camera path
    Movie(movie::Movie),
    /// Build, extract along a camera path, measure and render; write a report
    Study(study::Study),
    /// Reproduce tables and figures of papers, published beside measured; write the ledger
    Paper(paper::Paper),
    /// Measure what models cost to build, to keep and to step, and how good they are; write a report
    Bench(bench::Bench),
}

/// Why a command failed, as one line.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A file is at fault.
    #[error(transparent)]
    File(#[from] FileError),
    /// The options ask for nothing that can be done.
    #[error(transparent)]
    Selection(#[from] SelectionError),
    /// Ctrl-C.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

/// Runs a command; the code is 1 where a check found a broken law.
pub fn run(cli: Cli) -> Result<ExitCode, CommandError> {
    cli.memory_limit.into_iter().for_each(crate::memory::limit);
    match cli.command {
        Command::Build(command) => command.run(),
        Command::History(command) => command.run(),
        Command::Info(command) => command.run(),
        Command::Extract(command) => command.run(),
        Command::Verify(command) => command.run(),
        Command::Bisect(command) => command.run(),
        Command::Render(command) => command.run(),
        #[cfg(feature = "view")]
        Command::View(command) => command.run(),
        Command::Movie(command) => command.run(),
        Command::Study(command) => command.run(),
        Command::Paper(command) => command.run(),
        Command::Bench(command) => command.run(),
    }
}

/// Prints JSON to standard output. A closed pipe is not an error.
fn print_json(value: &serde_json::Value) {
    use std::io::Write;
    _ = writeln!(std::io::stdout(), "{value:#}");
}

/// Prints lines to standard output. A closed pipe is not an error.
fn print_text(text: &str) {
    use std::io::Write;
    _ = writeln!(std::io::stdout(), "{}", visible(text));
}

/// The text without what a terminal would obey, or would turn around: names in files may be anything.
fn visible(text: &str) -> String {
    let is_plain = |c: char| {
        matches!(c, '\n' | '\t')
            || !(c.is_control()
                || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'))
    };
    text.chars().map(|c| if is_plain(c) { c.to_string() } else { c.escape_unicode().to_string() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_shown_and_not_obeyed() {
        assert_eq!(visible("armadillo.obj\tby é\n"), "armadillo.obj\tby é\n");
        assert_eq!(visible("\u{1b}[2J\u{202e}gpj"), "\\u{1b}[2J\\u{202e}gpj");
    }
}
