//! `mtess history`: a model's history as text.

use super::CommandError;
use crate::files::{self, Model};
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
        let (model, _) = files::load_model(&self.model)?;
        files::write(&self.output, |mut out| match &model {
            Model::Triangles(model) => history::write(model, &mut out),
            Model::Tetrahedra(model) => history::write(model, &mut out),
        })?;
        Ok(ExitCode::SUCCESS)
    }
}
