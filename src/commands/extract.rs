//! `mtess extract`: a mesh for a criterion.

use super::{CommandError, print_json, print_text};
use crate::certificate;
use crate::files::{self, FileError, Model};
use crate::progress::Clock;
use crate::selection::Selection;
use clap::Args;
use mt_core::hierarchy::Dependency;
use mt_core::model::mesh_of;
use mt_core::{Bound, Camera, Hierarchy, MultiTessellation, NodeId};
use operators::order::Visit;
use selective::{Outcome, State};
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

/// What came of an extraction, and how long it took.
type Extracted<M> = (State<3, M, ()>, Outcome, f64);

impl Extract {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::mesh_format(&self.output)?;
        files::check_place(&self.output)?;
        self.certificate.as_deref().map_or(Ok(()), files::check_place)?;
        let camera = self.selection.load_camera()?;
        match (files::load_model(&self.model)?.0, self.selection.per_cell) {
            (Model::Triangles(model), Some(per_cell)) => {
                let clock = Clock::start();
                let (state, outcome) = self.selection.run_per_cell(&model, per_cell);
                self.finish(&*model, (state, outcome, clock.wall()), camera.as_ref())
            }
            (Model::Hierarchy { .. }, Some(_)) => Err(FileError::new(
                &self.model,
                "is a vertex hierarchy, which keeps no errors of single cells: --per-cell wants an explicit model",
            )
            .into()),
            (Model::Triangles(model), None) => self.on(&*model, camera.as_ref()),
            (Model::Hierarchy { replay, scheme }, None) => scheme
                .visit(&replay, Take { extract: &self, camera: camera.as_ref() })
                .map_err(|error| FileError::new(&self.model, error))?,
            (Model::Tetrahedra(_), _) => Err(files::no_triangles(&self.model).into()),
        }
    }

    fn on<M: MultiTessellation<3, Bound = Bound>>(
        &self,
        model: &M,
        camera: Option<&Camera>,
    ) -> Result<ExitCode, CommandError> {
        let clock = Clock::start();
        let (state, outcome) = self.selection.run(model, camera)?;
        self.finish(model, (state, outcome, clock.wall()), camera)
    }

    fn finish<M: MultiTessellation<3, Bound = Bound>>(
        &self,
        model: &M,
        (state, outcome, seconds): Extracted<M>,
        camera: Option<&Camera>,
    ) -> Result<ExitCode, CommandError> {
        let mesh = mesh_of(model, &state.view.mesh);
        if let Some(path) = &self.certificate {
            let document = certificate::of_front(model, self.selection.asked(camera)?, state.front());
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
        let base = model.cell_count(&model.base());
        let note = match outcome.complete {
            _ if self.selection.cells.is_some_and(|most| most < base) => {
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

/// Extracts from a hierarchy, whatever its dependencies.
struct Take<'a> {
    extract: &'a Extract,
    camera: Option<&'a Camera>,
}

impl Visit for Take<'_> {
    type Output = Result<ExitCode, CommandError>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        self.extract.on(model, self.camera)
    }
}
