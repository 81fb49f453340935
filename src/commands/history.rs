//! `mtess history`: a model's history as text.

use super::CommandError;
use crate::files::{self, FileError, Model};
use clap::Args;
use mt_core::history;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct History {
    /// The model
    model: PathBuf,
    /// Where to write the text, one modification a line
    #[arg(short, long, value_name = "H.jsonl")]
    output: PathBuf,
}

impl History {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::check_output(&self.output, "a history", "jsonl")?;
        match files::load_model(&self.model)?.0 {
            Model::Triangles(model) => files::write(&self.output, |mut out| history::write(&*model, &mut out))?,
            Model::Tetrahedra(model) => files::write(&self.output, |mut out| history::write(&*model, &mut out))?,
            Model::Hierarchy { .. } => {
                let what =
                    "is a vertex hierarchy, which keeps merges and no cells: a history is one of an explicit model";
                return Err(FileError::new(&self.model, what).into());
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}
