//! What a command is about: a model from a file, or the vertex hierarchy of a mesh under a scheme; the options that say so.

use crate::commands::CommandError;
use crate::files::{self, FileError, Model};
use crate::progress::{Progress, interrupted};
use clap::Args;
use mt_core::analysis::{AnalysisError, Options, Stopped, Unfit};
use mt_core::format::{Format, LoadOptions};
use mt_core::{Mesh, Replay, Sequence};
use operators::AnyOperator;
use operators::order::Scheme;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// A model, or a mesh with what makes a hierarchy of it.
#[derive(Args)]
pub struct Subject {
    /// The model; or a mesh, for its vertex hierarchy: obj, ply, stl, off, gltf or glb
    model: PathBuf,
    /// Of a mesh: what coarsens it, as in `mtess build` [default: edge-collapse]
    #[arg(long, value_name = "NAME[/METRIC]")]
    operator: Option<AnyOperator>,
    /// Of a mesh: what steps wait for: explicit, one-ring, cut-pair, four-face, dual-piece, implicit-ids,
    /// implicit-ids-stored or dual-piece-free [default: dual-piece]
    #[arg(long, value_name = "NAME")]
    dependency: Option<Scheme>,
}

/// What was loaded.
pub enum Loaded {
    /// A model from a file.
    Model(Model),
    /// A mesh, coarsened.
    Mesh { replay: Arc<Replay>, scheme: Scheme },
}

impl Subject {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.model
    }

    /// Loads the model, or the mesh and coarsens it.
    pub fn load(&self) -> Result<Loaded, CommandError> {
        if !is_mesh(&self.model) {
            let (model, _) = files::load_model(&self.model)?;
            for (option, given) in
                [("--operator", self.operator.is_some()), ("--dependency", self.dependency.is_some())]
            {
                refuse_for_models(&self.model, option, given)?;
            }
            return Ok(Loaded::Model(model));
        }
        let (mesh, report) = files::load_mesh(&self.model, &LoadOptions::default())?;
        eprint!("{report}");
        let operator = operator_or_usual(self.operator.as_ref())?;
        let replay = Arc::new(replay_of(&self.model, &mesh, &operator)?);
        Ok(Loaded::Mesh { replay, scheme: self.dependency.unwrap_or(Scheme::DualPiece) })
    }
}

/// Whether a file is a mesh by its ending.
pub fn is_mesh(path: &Path) -> bool {
    Format::from_extension(path.extension().and_then(|e| e.to_str()).unwrap_or("")).is_some()
}

/// Refuses an option that is for meshes only.
pub fn refuse_for_models(path: &Path, option: &str, given: bool) -> Result<(), CommandError> {
    let what = || format!("is a model, made and ordered as it is; {option} is for meshes");
    if given { Err(FileError::new(path, what()).into()) } else { Ok(()) }
}

/// The operator of an option, or edge collapse.
pub fn operator_or_usual(operator: Option<&AnyOperator>) -> Result<AnyOperator, CommandError> {
    let operator = operator.cloned().map_or_else(|| AnyOperator::from_str("edge-collapse"), Ok);
    operator.map_err(|error| CommandError::Other(error.to_string()))
}

/// Coarsens a mesh and keeps its merges.
pub fn replay_of(path: &Path, mesh: &Mesh<3>, operator: &AnyOperator) -> Result<Replay, CommandError> {
    let wrong = |what: String| CommandError::File(FileError::new(path, what));
    let mut sequence = Sequence::new(mesh);
    let mut progress = Progress::new("coarsening", mesh.cell_count() as u64);
    let mut watch = |at: mt_core::analysis::Progress| progress.at((at.cells_in - at.cells) as u64);
    let ended = operator.analyse(mesh, &Options::default(), &mut sequence, &mut watch).map_err(|error| {
        let way_out = match error {
            AnalysisError::Unfit(Unfit::NonManifold { .. }) => "; --operator vertex-pair takes the mesh as it is",
            _ => "",
        };
        wrong(format!("{error}{way_out}"))
    })?;
    if ended.stopped == Stopped::Cancelled || interrupted() {
        return Err(CommandError::Interrupted);
    }
    Replay::new(mesh, &operator.links(mesh), &sequence).map_err(|error| wrong(error.to_string()))
}
