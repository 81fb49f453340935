//! What a command is about: a model from a file, or the vertex hierarchy of a mesh under a scheme; the options that say so.

use crate::coarsening::replay_of;
use crate::commands::CommandError;
use crate::files::{self, FileError, Model};
use clap::{Args, ValueEnum};
use mt_core::format::{Format, LoadOptions, NonManifold};
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
    /// Of a mesh or a vertex hierarchy: what steps wait for: explicit, one-ring, cut-pair, four-face, dual-piece, implicit-ids,
    /// implicit-ids-stored or dual-piece-free [default: dual-piece for a mesh, one-ring if its topology is coarsened, else what the model was built for]
    #[arg(long, value_name = "NAME")]
    dependency: Option<Scheme>,
    /// Of a mesh: what to do with edges and vertices where several sheets meet
    #[arg(long, value_enum, default_value_t = Sheets::Refuse)]
    non_manifold: Sheets,
}

/// What is done where several sheets of a mesh meet.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheets {
    /// Refuse the mesh
    Refuse,
    /// Separate the sheets, and report it
    Split,
}

impl Sheets {
    /// For whoever loads a mesh.
    pub fn options(self) -> LoadOptions {
        let non_manifold = match self {
            // Operators refuse it.
            Self::Refuse => NonManifold::Keep,
            Self::Split => NonManifold::Split,
        };
        LoadOptions { non_manifold, ..LoadOptions::default() }
    }
}

/// What steps usually wait for: the most local scheme that takes what the operator makes.
pub fn usual_scheme(operator: &AnyOperator) -> Scheme {
    if operator.coarsens_topology() { Scheme::OneRing } else { Scheme::DualPiece }
}

impl Subject {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.model
    }

    /// Loads the model, or the mesh and coarsens it.
    pub fn load(&self) -> Result<Model, CommandError> {
        if !is_mesh(&self.model) {
            let (model, _) = files::load_model(&self.model)?;
            refuse_for_models(&self.model, "--operator", self.operator.is_some())?;
            return match (model, self.dependency) {
                (Model::Hierarchy { replay, .. }, Some(scheme)) => Ok(Model::Hierarchy { replay, scheme }),
                (model, other) => {
                    refuse_for_models(&self.model, "--dependency", other.is_some())?;
                    Ok(model)
                }
            };
        }
        let (mesh, report) = files::load_mesh(&self.model, &self.non_manifold.options())?;
        eprint!("{report}");
        let operator = operator_or_usual(self.operator.as_ref())?;
        let replay = Arc::new(replay_of(&self.model, &mesh, &operator)?);
        Ok(Model::Hierarchy { replay, scheme: self.dependency.unwrap_or_else(|| usual_scheme(&operator)) })
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
