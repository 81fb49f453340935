//! `mtess extract`: a mesh for a criterion.

use super::{CommandError, print_json, print_text};
use crate::certificate;
use crate::files;
use crate::progress::Clock;
use crate::selection::Selection;
use clap::Args;
use mt_core::model::mesh_of;
use mt_core::{MultiTessellation, NodeId};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct Extract {
    /// The model
    model: PathBuf,
    #[command(flatten)]
    selection: Selection,
    /// Where to write the mesh: obj, ply, stl, off or glb
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Write here why each modification is refined, as JSON: proof that no smaller front will do. `mtess verify` checks it
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["cells", "time_ms", "per_cell"])]
    certificate: Option<PathBuf>,
    /// Tell the figures as JSON
    #[arg(long)]
    json: bool,
}

impl Extract {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::mesh_format(&self.output)?;
        files::check_place(&self.output)?;
        self.certificate.as_deref().map_or(Ok(()), files::check_place)?;
        let camera = self.selection.load_camera()?;
        let (model, _) = files::load_triangles(&self.model)?;
        let clock = Clock::start();
        let (state, outcome) = self.selection.run(&model, camera.as_ref())?;
        let seconds = clock.wall();
        let mesh = mesh_of(&model, &state.view.mesh);
        if let Some(path) = &self.certificate {
            let document = certificate::of_front(&model, self.selection.asked(camera.as_ref())?, state.front());
            let document = document.map_err(|breach| CommandError::Other(format!("no certificate: {breach}")))?;
            certificate::write(path, &document)?;
        }
        files::write_mesh(&self.output, &mesh)?;
        let unrefined = (0..model.len()).map(NodeId).filter(|&m| !state.front().is_refined(m));
        let error = unrefined.map(|m| model.bound(m).error).fold(0.0, f32::max);
        if self.json {
            print_json(&json!({
                "output": self.output,
                "vertices": mesh.vertex_count(),
                "triangles": mesh.cell_count(),
                "nodes": state.front().len(),
                "refined": outcome.refined,
                "coarsened": outcome.coarsened,
                "forced": outcome.forced,
                "complete": outcome.complete,
                "error": error,
                "seconds": seconds,
            }));
            return Ok(ExitCode::SUCCESS);
        }
        let base = model.base_cells().len();
        let note = match outcome.complete {
            _ if self.selection.cells.is_some_and(|most| (most as usize) < base) => {
                format!("; the base mesh already has {base}, which no budget goes below")
            }
            true => String::new(),
            _ if self.selection.is_budget_only() => String::new(),
            false => "; the criterion asks for more than the limits allow".into(),
        };
        print_text(&format!(
            "{}: {} triangles, {} vertices ({} of {} modifications refined, {} of them forced), error {error} left, in {:.1} ms{note}",
            self.output.display(),
            mesh.cell_count(),
            mesh.vertex_count(),
            state.front().len(),
            model.len(),
            outcome.forced,
            seconds * 1e3,
        ));
        Ok(ExitCode::SUCCESS)
    }
}
