//! `mtess verify`: the laws of a model over random fronts, or of the vertex hierarchies of a mesh; exit 1 and a
//! counterexample where one is broken.

use super::{CommandError, print_json, print_text};
use crate::certificate;
use crate::coarsening::replay_of;
use crate::files::{self, FileError, Model};
use crate::progress::{Clock, Progress, interrupted};
use crate::subject;
use clap::Args;
use mt_core::container::Meta;
use mt_core::format::LoadOptions;
use mt_core::hierarchy::Dependency;
use mt_core::{Bound, Explicit, Hierarchy, MultiTessellation, Replay};
use multi_tessellation::verify::{self, Counterexample, Summary, Topology};
use operators::AnyOperator;
use operators::order::{Scheme, UnknownScheme, Visit};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;

#[derive(Args)]
pub struct Verify {
    /// The model; or a mesh, to verify its vertex hierarchies: obj, ply, stl, off, gltf or glb
    model: PathBuf,
    /// Of a mesh: what coarsens it, as in `mtess build` [default: edge-collapse]
    #[arg(long, value_name = "NAME[/METRIC]")]
    operator: Option<AnyOperator>,
    /// Of a mesh or a vertex hierarchy: what steps wait for: explicit, one-ring, cut-pair, four-face, dual-piece,
    /// implicit-ids, implicit-ids-stored, dual-piece-free, or all [default: all for a mesh, else what the model was built for]
    #[arg(long, value_name = "NAME")]
    dependency: Option<Schemes>,
    /// Number of random fronts
    #[arg(long, value_name = "N", default_value_t = 100)]
    fronts: u32,
    /// Seed of the fronts
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Where to write a counterexample
    #[arg(long, value_name = "DIR", default_value = ".")]
    counterexample: PathBuf,
    /// Check this certificate of an extraction from the model instead, by its order and what was asked for alone
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["operator", "dependency"])]
    certificate: Option<PathBuf>,
    /// As JSON
    #[arg(long)]
    json: bool,
}

/// One scheme, or all that take the sequence.
#[derive(Copy, Clone)]
enum Schemes {
    One(Scheme),
    All,
}

impl FromStr for Schemes {
    type Err = UnknownScheme;
    fn from_str(name: &str) -> Result<Self, UnknownScheme> {
        if name == "all" { Ok(Self::All) } else { name.parse().map(Self::One) }
    }
}

impl Verify {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::check_folder(&self.counterexample)?;
        if subject::is_mesh(&self.model) {
            if self.certificate.is_some() {
                return Err(FileError::new(&self.model, "is a mesh; a certificate is of a model").into());
            }
            return self.mesh();
        }
        let (model, meta) = files::load_model(&self.model)?;
        subject::refuse_for_models(&self.model, "--operator", self.operator.is_some())?;
        if !matches!(model, Model::Hierarchy { .. }) {
            subject::refuse_for_models(&self.model, "--dependency", self.dependency.is_some())?;
        }
        match &model {
            Model::Triangles(model) if self.certificate.is_some() => self.certified(&**model),
            Model::Hierarchy { replay, scheme } if self.certificate.is_some() => {
                scheme.visit(replay, Certify(&self)).map_err(|error| FileError::new(&self.model, error))?
            }
            Model::Tetrahedra(_) if self.certificate.is_some() => {
                Err(FileError::new(&self.model, "is a model of tetrahedra; certificates are of triangles").into())
            }
            Model::Triangles(model) => self.model(model, &meta),
            Model::Tetrahedra(model) => self.model(model, &meta),
            Model::Hierarchy { replay, scheme } => {
                let operator = subject::operator_or_usual(meta.operator.parse().ok().as_ref())?;
                self.hierarchies(replay, &operator, self.dependency.unwrap_or(Schemes::One(*scheme)))
            }
        }
    }

    fn options(&self, topology: Topology) -> verify::Options {
        verify::Options { fronts: self.fronts, seed: self.seed, topology }
    }

    fn model<const N: usize>(&self, model: &Explicit<N>, meta: &Meta) -> Result<ExitCode, CommandError> {
        let topology = meta.operator.parse().map_or(Topology::Kept, |operator| topology_of(&operator));
        let clock = Clock::start();
        let verdict = self.watch(|watch| verify::explicit(model, &self.options(topology), watch))?;
        let summary = match verdict {
            Ok(summary) => summary,
            Err(found) => return self.report(&found, None),
        };
        if self.json {
            print_json(&json!({
                "holds": true, "fronts": self.fronts, "seed": self.seed, "topology": topology, "checks": summary,
                "seconds": clock.wall(),
            }));
        } else {
            print_text(&self.text("every law", &summary, clock.wall()));
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Judges a certificate.
    fn certified(&self, model: &impl MultiTessellation<3, Bound = Bound>) -> Result<ExitCode, CommandError> {
        let path = self.certificate.as_deref().unwrap_or(&self.model);
        let nodes = certificate::check(path, model)?;
        if self.json {
            print_json(&json!({ "holds": true, "nodes": nodes }));
        } else {
            let file = path.display();
            print_text(&format!("{file}: these {nodes} modifications are asked for or needed, and nothing else is"));
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Analyses the mesh, and verifies its hierarchies.
    fn mesh(&self) -> Result<ExitCode, CommandError> {
        let (mesh, load_report) = files::load_mesh(&self.model, &LoadOptions::default())?;
        if !self.json {
            eprint!("{load_report}");
        }
        let operator = subject::operator_or_usual(self.operator.as_ref())?;
        let replay = Arc::new(replay_of(&self.model, &mesh, &operator)?);
        self.hierarchies(&replay, &operator, self.dependency.unwrap_or(Schemes::All))
    }

    /// Verifies the hierarchies of one sequence.
    fn hierarchies(
        &self,
        replay: &Arc<Replay>,
        operator: &AnyOperator,
        schemes: Schemes,
    ) -> Result<ExitCode, CommandError> {
        let (schemes, is_one) = match schemes {
            Schemes::One(scheme) => (vec![scheme], true),
            Schemes::All => (Scheme::ALL.to_vec(), false),
        };
        let mut told: Vec<Value> = Vec::new();
        for scheme in schemes {
            let clock = Clock::start();
            let options = self.options(topology_of(operator));
            let judged = self.watch(|watch| verify::scheme(replay, scheme, &options, watch))?;
            let verdict = match judged {
                Ok(verdict) => verdict,
                Err(error) if is_one => return Err(FileError::new(&self.model, error).into()),
                Err(error) => {
                    if !self.json {
                        print_text(&error.to_string());
                    }
                    told.push(json!({ "dependency": scheme.name(), "unfit": error.to_string() }));
                    continue;
                }
            };
            match verdict {
                Err(found) => return self.report(&found, Some((operator, scheme))),
                Ok(summary) => {
                    let seconds = clock.wall();
                    if !self.json {
                        print_text(&self.text(
                            &format!("{operator}, {scheme}: {}", laws_of(scheme)),
                            &summary,
                            seconds,
                        ));
                    }
                    told.push(json!({ "dependency": scheme.name(), "checks": summary, "seconds": seconds }));
                }
            }
        }
        if self.json {
            print_json(&json!({
                "holds": true, "fronts": self.fronts, "seed": self.seed, "operator": operator.name(), "schemes": told,
            }));
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Runs a check that hears of Ctrl-C. Cut short, it has not seen what it would say holds.
    fn watch<T, E>(
        &self,
        check: impl FnOnce(&mut dyn FnMut(u32) -> bool) -> Result<T, E>,
    ) -> Result<Result<T, E>, CommandError> {
        let mut progress = Progress::new("verifying", u64::from(self.fronts));
        let verdict = check(&mut |at| progress.at(u64::from(at)));
        drop(progress);
        if verdict.is_ok() && interrupted() { Err(CommandError::Interrupted) } else { Ok(verdict) }
    }

    fn text(&self, what: &str, summary: &Summary, seconds: f64) -> String {
        let mut text =
            format!("{what} holds over {} random fronts (seed {}) in {seconds:.1} s:", self.fronts, self.seed);
        for (law, count) in summary {
            _ = write!(text, "\n  {law}: checked {count} times");
        }
        text
    }

    fn report<const N: usize>(
        &self,
        found: &Counterexample<N>,
        of: Option<(&AnyOperator, Scheme)>,
    ) -> Result<ExitCode, CommandError> {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        let path = |ending: &str| self.counterexample.join(format!("{stem}-counterexample.{ending}"));
        let [mesh_path, log_path, test_path] = ["obj", "txt", "rs"].map(path);
        let hierarchy = of.map(|(operator, scheme)| format!("{operator}, {scheme}"));
        let topology = of.map_or(Topology::Kept, |(operator, _)| topology_of(operator));
        let making = of.map_or(String::new(), |(_, scheme)| making(scheme));
        files::write_bytes(&mesh_path, found.obj().as_bytes())?;
        files::write_bytes(&log_path, self.log(found, hierarchy.as_deref()).as_bytes())?;
        files::write_bytes(&test_path, found.test(&stem, &making, &self.options(topology)).as_bytes())?;
        if self.json {
            print_json(&json!({
                "holds": false, "law": found.breach.law, "what": found.breach.what, "node": found.breach.node,
                "front": found.front.len(), "found_at": found.found.front, "seed": self.seed, "log": log_path,
                "cells": found.mesh.cell_count(), "test": test_path,
                "dependency": of.map(|(_, scheme)| scheme.name()),
            }));
        }
        let which = hierarchy.map_or(String::new(), |which| format!("{which}: "));
        eprintln!("error: {}: {which}{}", self.model.display(), found.breach);
        eprintln!("made small: {}; written to {} (.obj the mesh, .rs a test)", found.sizes(), log_path.display());
        Ok(ExitCode::FAILURE)
    }

    fn log<const N: usize>(&self, found: &Counterexample<N>, hierarchy: Option<&str>) -> String {
        let mut log = format!("model: {}\n", self.model.display());
        if let Some(hierarchy) = hierarchy {
            _ = writeln!(log, "hierarchy: {hierarchy}");
        }
        _ = write!(log, "seed: {}\n{}", self.seed, found.story());
        log
    }
}

/// Judges a certificate of a hierarchy, whatever its dependencies.
struct Certify<'a>(&'a Verify);

impl Visit for Certify<'_> {
    type Output = Result<ExitCode, CommandError>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        self.0.certified(model)
    }
}

/// What is judged of a scheme.
fn laws_of(scheme: Scheme) -> &'static str {
    if scheme.is_static() { "every law" } else { "every law that a dynamic rule claims, none of those on orders," }
}

/// The statement of Rust that makes a scheme for a replay.
fn making(scheme: Scheme) -> String {
    let made = match scheme {
        Scheme::ImplicitIds => "operators::order::ImplicitIds".to_owned(),
        Scheme::ImplicitIdsStored => "operators::order::StoredIds::new(&replay).unwrap()".to_owned(),
        Scheme::DualPieceFree => "operators::order::DualPieceFree::new(&replay).unwrap()".to_owned(),
        _ => format!("operators::order::Scheme::{scheme:?}.stored(&replay).unwrap().unwrap()"),
    };
    format!("let dependency = {made};")
}

/// What an operator may do to the topology of a mesh.
fn topology_of(operator: &AnyOperator) -> Topology {
    if operator.coarsens_topology() { Topology::Coarsened } else { Topology::Kept }
}
