//! `mtess verify`: the laws of a model over random fronts; exit 1 and a counterexample where one is broken.

use super::{CommandError, print_json, print_text};
use crate::files::{self, Model};
use crate::progress::{Clock, Progress, interrupted};
use clap::Args;
use mt_core::{Explicit, Mesh};
use multi_tessellation::verify::{self, Counterexample, Summary};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub struct Verify {
    /// The model
    model: PathBuf,
    /// Number of random fronts
    #[arg(long, value_name = "N", default_value_t = 100)]
    fronts: u32,
    /// Seed of the fronts
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Where to write a counterexample
    #[arg(long, value_name = "DIR", default_value = ".")]
    counterexample: PathBuf,
    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::check_folder(&self.counterexample)?;
        let (model, _) = files::load_model(&self.model)?;
        match &model {
            Model::Triangles(model) => self.check(model, write_obj),
            // No mesh format here carries tetrahedra; the text log has them.
            Model::Tetrahedra(model) => self.check(model, |_, _| Ok(())),
        }
    }

    fn check<const N: usize>(
        &self,
        model: &Explicit<N>,
        write_mesh: impl Fn(&Path, &Mesh<N>) -> Result<(), CommandError>,
    ) -> Result<ExitCode, CommandError> {
        let clock = Clock::start();
        let mut progress = Progress::new("verifying", u64::from(self.fronts));
        let options = verify::Options { fronts: self.fronts, seed: self.seed };
        let result = verify::explicit(model, &options, &mut |at| progress.at(u64::from(at)));
        drop(progress);
        match result {
            // Cut short, it has not seen what it would say holds.
            Ok(_) if interrupted() => Err(CommandError::Interrupted),
            Ok(summary) => {
                self.tell(&summary, clock.wall());
                Ok(ExitCode::SUCCESS)
            }
            Err(found) => self.report(&found, write_mesh),
        }
    }

    fn tell(&self, summary: &Summary, seconds: f64) {
        if self.json {
            print_json(
                &json!({ "holds": true, "fronts": self.fronts, "seed": self.seed, "checks": summary, "seconds": seconds }),
            );
            return;
        }
        let mut text =
            format!("every law holds over {} random fronts (seed {}) in {seconds:.1} s:", self.fronts, self.seed);
        for (law, count) in summary {
            _ = write!(text, "\n  {law}: checked {count} times");
        }
        print_text(&text);
    }

    fn report<const N: usize>(
        &self,
        found: &Counterexample<N>,
        write_mesh: impl Fn(&Path, &Mesh<N>) -> Result<(), CommandError>,
    ) -> Result<ExitCode, CommandError> {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        let mesh_path = self.counterexample.join(format!("{stem}-counterexample.obj"));
        let log_path = self.counterexample.join(format!("{stem}-counterexample.txt"));
        write_mesh(&mesh_path, &found.mesh)?;
        files::write_bytes(&log_path, self.log(found).as_bytes())?;
        if self.json {
            print_json(&json!({
                "holds": false, "law": found.breach.law, "what": found.breach.what, "node": found.breach.node,
                "front": found.front.len(), "found_at": found.found_at, "seed": self.seed, "log": log_path,
            }));
        }
        eprintln!("error: {}: {}", self.model.display(), found.breach);
        eprintln!(
            "the smallest front found has {} nodes (found at {}), its mesh {} cells; written to {}",
            found.front.len(),
            found.found_at,
            found.mesh.cell_count(),
            log_path.display()
        );
        Ok(ExitCode::FAILURE)
    }

    fn log<const N: usize>(&self, found: &Counterexample<N>) -> String {
        let mut log = format!("model: {}\nseed: {}\n{}\n", self.model.display(), self.seed, found.breach);
        _ = writeln!(log, "\nfront, finest first: {}", join(found.front.finest_first().map(|m| m.0)));
        if let Some((m, patch)) = &found.patch {
            _ = writeln!(log, "\nnode {m} replaces, when refined:");
            patch.coarse.iter().for_each(|cell| _ = writeln!(log, "  - {}", join(cell.iter().map(|v| v.0))));
            patch.fine.iter().for_each(|cell| _ = writeln!(log, "  + {}", join(cell.iter().map(|v| v.0))));
        }
        log
    }
}

fn join(numbers: impl Iterator<Item = u32>) -> String {
    numbers.map(|n| n.to_string()).collect::<Vec<_>>().join(" ")
}

fn write_obj(path: &Path, mesh: &Mesh<3>) -> Result<(), CommandError> {
    Ok(files::write_mesh(path, mesh)?)
}
