//! `mtess build`: a mesh becomes a model.

use super::{CommandError, print_json, print_text};
use crate::coarsening::{Coarsening, use_threads, usual_regions};
use crate::files::{self, FileError};
use crate::kept::Kept;
use crate::memory::peak_bytes;
use crate::progress::{Clock, interrupted};
use crate::subject::Sheets;
use clap::{Args, ValueEnum};
use mt_core::analysis::{Options, Regions};
use mt_core::container::{Meta, Storage};
use mt_core::format::{LoadOptions, LoadReport};
use mt_core::{ErrorKind, Mesh, RefusalCounts, history};
use operators::AnyOperator;
use operators::edge_collapse::BoundaryRule;
use operators::fan_merge::BelowStall;
use operators::order::Scheme;
use operators::vertex_pair::Preference;
use serde_json::json;
use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub struct Build {
    /// The mesh: obj, ply, stl, off, gltf or glb
    model: PathBuf,
    /// Where to write the model
    #[arg(short, long, value_name = "X.mt")]
    output: PathBuf,
    /// What coarsens the mesh: edge-collapse, half-edge-collapse, vertex-pair, fan-merge; the first three also with a
    /// metric, as in edge-collapse/lindstrom-turk (quadric, quadric-attributes, lindstrom-turk, edge-length)
    #[arg(long, value_name = "NAME[/METRIC]", default_value = "edge-collapse", conflicts_with = "history")]
    operator: AnyOperator,
    /// Fan-merge: what to do when no legal full fan is left
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "history")]
    below_stall: Option<Stall>,
    /// Vertex-pair: what comes first
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "history")]
    preference: Option<Preferred>,
    /// Replay this history instead of coarsening
    #[arg(long, value_name = "H.jsonl")]
    history: Option<PathBuf>,
    /// Stop at this many triangles
    #[arg(long, value_name = "N", conflicts_with = "history")]
    until_cells: Option<u32>,
    /// Allow no modification with a larger error, in model units
    #[arg(long, value_name = "E", conflicts_with = "history")]
    until_error: Option<f32>,
    /// Which errors to record: the metric's estimates, or measured distances (slower)
    #[arg(long, value_enum, default_value_t = Errors::Estimate, conflicts_with = "history")]
    errors: Errors,
    /// What may happen to boundaries
    #[arg(long, value_enum, default_value_t = Boundary::Weighted, conflicts_with = "history")]
    boundary: Boundary,
    /// What to do with edges and vertices where several sheets meet
    #[arg(long, value_enum, default_value_t = Sheets::Refuse)]
    non_manifold: Sheets,
    /// Leave vertices at the same place apart
    #[arg(long)]
    no_weld: bool,
    /// Coarsen region by region of about so many vertices, 0 for all at once; collapses of edges only. If not set, 4096
    /// for meshes of 40,000 triangles and more
    #[arg(long, value_name = "VERTICES", conflicts_with = "history")]
    regions: Option<u32>,
    /// Threads to use, 0 for as many as there are cores; the result is the same to the bit
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    threads: u32,
    /// Keep the vertex hierarchy under this scheme instead of all cells, in a file of a third of the size: explicit, one-ring, cut-pair,
    /// four-face, dual-piece, implicit-ids, implicit-ids-stored or dual-piece-free. Vertices and triangles of the input are
    /// numbered anew, as steps find them fastest
    #[arg(long, value_name = "NAME", conflicts_with = "history")]
    dependency: Option<Scheme>,
    /// Put all vertices on a grid of so many bits along the longest side, 8 to 24, and tell their places in whole steps; with
    /// --packed a file of two thirds of the size. The finest mesh is then the input moved by at most half a step along each axis
    #[arg(long, value_name = "BITS", requires = "dependency", value_parser = clap::value_parser!(u32).range(8..=24))]
    quantise: Option<u32>,
    /// Pack the file without loss: about half the bytes
    #[arg(long)]
    packed: bool,
    /// Tell the figures as JSON
    #[arg(long)]
    json: bool,
}

/// A model that was made, and how.
struct Made {
    model: Kept,
    operator: String,
    regions: Option<Regions>,
    refusals: RefusalCounts,
    stopped: String,
}

#[derive(ValueEnum, Clone, Copy)]
enum Errors {
    Estimate,
    Measured,
}

#[derive(ValueEnum, Clone, Copy)]
enum Stall {
    /// Merge the children that can go
    Partial,
    /// Collapse single edges
    Collapse,
    /// End there
    Stop,
}

#[derive(ValueEnum, Clone, Copy)]
enum Preferred {
    /// All collapses that keep the topology come before any that do not
    GeometryFirst,
    /// The cheapest, whatever it does
    Equal,
}

#[derive(ValueEnum, Clone, Copy)]
enum Boundary {
    /// Coarsened, held in place by the metric
    Weighted,
    /// Left as they are
    Locked,
}

impl Build {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::check_output(&self.output, "a model", "mt")?;
        if self.dependency.is_some() && matches!(self.errors, Errors::Measured) {
            // What is measured is a modification as a whole; a hierarchy wants the error of each merge.
            return Err(CommandError::Other("--errors measured is for explicit models, not with --dependency".into()));
        }
        use_threads(self.threads as usize)?;
        let history = self.history.as_deref().map(|path| files::open_lines(path).map(|lines| (path, lines)));
        let history = history.transpose()?;
        let clock = Clock::start();
        let options = LoadOptions { weld: !self.no_weld, ..self.non_manifold.options() };
        let (mesh, report) = files::load_mesh(&self.model, &options)?;
        let load_s = clock.wall();
        if !self.json {
            eprint!("{report}");
        }
        let clock = Clock::start();
        let counts_in = [mesh.vertex_count(), mesh.cell_count()];
        let made = match history {
            Some((path, lines)) => replay(&mesh, path, lines)?,
            None => self.make(mesh)?,
        };
        let (analysis_s, analysis_cpu_s) = (clock.wall(), clock.cpu());
        let clock = Clock::start();
        let meta = self.meta(&made, &report);
        let storage = if self.packed { Storage::Packed } else { Storage::Plain };
        files::write(&self.output, |out| made.model.write(&meta, storage, out))?;
        let seconds = Seconds { load_s, analysis_s, analysis_cpu_s, write_s: clock.wall() };
        self.tell(counts_in, &made, &meta, &report, &seconds);
        Ok(ExitCode::SUCCESS)
    }

    fn make(&self, mesh: Mesh<3>) -> Result<Made, CommandError> {
        let coarsening = self.coarsening(&mesh)?;
        let (model, ended) = match self.dependency {
            None => Kept::cells(&self.model, &mesh, &coarsening)?,
            Some(scheme) => Kept::merges(&self.model, mesh, &coarsening, scheme, self.quantise)?,
        };
        if interrupted() {
            return Err(CommandError::Interrupted);
        }
        Ok(Made {
            model,
            operator: coarsening.operator.name(),
            regions: coarsening.regions,
            refusals: ended.refusals,
            stopped: ended.stopped.to_string(),
        })
    }

    fn coarsening(&self, mesh: &Mesh<3>) -> Result<Coarsening, CommandError> {
        if self.until_error.is_some_and(|error| error.is_nan() || error < 0.0) {
            return Err(CommandError::Other("--until-error must be a number, 0 or more".into()));
        }
        let operator = self.chosen_operator()?;
        let options = Options {
            until_cells: self.until_cells,
            until_error: self.until_error,
            error_kind: match self.errors {
                Errors::Estimate => ErrorKind::Estimate,
                Errors::Measured => ErrorKind::Measured,
            },
            ..Options::default()
        };
        let regions = self.chosen_regions(mesh, &operator, &options)?;
        Ok(Coarsening { operator, options, regions })
    }

    /// The regions to coarsen one by one, if that is how; what was asked for and cannot be is refused.
    fn chosen_regions(
        &self,
        mesh: &Mesh<3>,
        operator: &AnyOperator,
        options: &Options,
    ) -> Result<Option<Regions>, CommandError> {
        let threads = self.threads as usize;
        let vertices = match self.regions {
            None => return Ok(usual_regions(mesh, operator, options, threads)),
            Some(0) => return Ok(None),
            Some(vertices @ 1..16) => {
                return Err(CommandError::Other(format!("--regions {vertices} is too few: 16 at least, 0 for none")));
            }
            Some(vertices) => vertices,
        };
        if !operator.works_by_regions() {
            return Err(CommandError::Other(format!("--regions is for collapses of edges, not for {operator}")));
        }
        if options.error_kind == ErrorKind::Measured {
            return Err(CommandError::Other("--errors measured needs the mesh as a whole: --regions 0".into()));
        }
        Ok(Some(Regions { vertices, threads }))
    }

    /// The operator with the options that only some of them have; an option that would do nothing is refused.
    fn chosen_operator(&self) -> Result<AnyOperator, CommandError> {
        let rule = match self.boundary {
            Boundary::Weighted => BoundaryRule::Weighted,
            Boundary::Locked => BoundaryRule::Locked,
        };
        let mut operator = self.operator.clone();
        let takes_stall = match &mut operator {
            AnyOperator::EdgeCollapse(collapse) => {
                collapse.boundary = rule;
                false
            }
            AnyOperator::VertexPair(pair) => {
                if rule == BoundaryRule::Locked {
                    return Err(CommandError::Other(
                        "--boundary locked is not for vertex-pair, which closes holes".into(),
                    ));
                }
                pair.preference = match self.preference {
                    None | Some(Preferred::GeometryFirst) => Preference::GeometryFirst,
                    Some(Preferred::Equal) => Preference::Equal,
                };
                false
            }
            AnyOperator::FanMerge(fan) => {
                fan.boundary = rule;
                fan.below_stall = match self.below_stall {
                    None | Some(Stall::Partial) => BelowStall::Partial,
                    Some(Stall::Collapse) => BelowStall::Collapse,
                    Some(Stall::Stop) => BelowStall::Stop,
                };
                true
            }
            // No name leads to one.
            AnyOperator::Yours(_) => false,
        };
        if self.preference.is_some() && !matches!(operator, AnyOperator::VertexPair(_)) {
            return Err(CommandError::Other(format!("--preference is for vertex-pair, not for {operator}")));
        }
        if self.below_stall.is_some() && !takes_stall {
            return Err(CommandError::Other(format!("--below-stall is for fan-merge, not for {operator}")));
        }
        Ok(operator)
    }

    fn meta(&self, made: &Made, report: &LoadReport) -> Meta {
        let name = self.model.file_name().unwrap_or(self.model.as_os_str());
        Meta {
            operator: made.operator.clone(),
            grid_step: made.model.grid_step(),
            region_vertices: made.regions.map_or(0, |regions| regions.vertices),
            source: name.to_string_lossy().into_owned(),
            stopped: made.stopped.clone(),
            refusals: made.refusals.iter().map(|(reason, count)| (reason.name().to_owned(), count)).collect(),
            load_report: report.to_string().lines().map(str::to_owned).collect(),
            ..Meta::default()
        }
    }

    fn tell(
        &self,
        [vertices_in, cells_in]: [usize; 2],
        made: &Made,
        meta: &Meta,
        report: &LoadReport,
        seconds: &Seconds,
    ) {
        let model = &made.model;
        let base = model.base();
        if !self.json {
            let rate = (cells_in as f64 - base as f64) / seconds.analysis_s.max(1e-9) / 1e3;
            print_text(&format!(
                "{}: {cells_in} triangles to {base} in {} modifications, {:.2} s ({rate:.0} thousand triangles a second); {}",
                self.output.display(),
                model.len(),
                seconds.analysis_s,
                meta.stopped
            ));
            return;
        }
        print_json(&json!({
            "model": self.output,
            "operator": meta.operator,
            "dependency": self.dependency.map(Scheme::name),
            "vertices_in": vertices_in,
            "triangles_in": cells_in,
            "triangles_base": base,
            "modifications": model.len(),
            "bytes": model.bytes(),
            "error_kind": model.error_kind(),
            "stopped": meta.stopped,
            "refusals": meta.refusals,
            "load_report": report,
            "load_s": seconds.load_s,
            "analysis_s": seconds.analysis_s,
            "analysis_cpu_s": seconds.analysis_cpu_s,
            "write_s": seconds.write_s,
            "grid_step": meta.grid_step,
            "region_vertices": meta.region_vertices,
            "threads_asked": self.threads,
            "peak_bytes": peak_bytes(),
        }));
    }
}

fn replay(mesh: &Mesh<3>, path: &Path, lines: impl BufRead) -> Result<Made, CommandError> {
    let wrong = |what: String| CommandError::File(FileError::new(path, what));
    let model = history::read(mesh, lines).map_err(|error| wrong(error.to_string()))?;
    // A history from elsewhere is not believed before its modifications conform.
    mt_core::check::conformity(&model).map_err(|breach| {
        let line = breach.node.map_or(String::new(), |m| format!("modification {}: ", m.0 + 1));
        wrong(format!("{line}{}", breach.what))
    })?;
    Ok(Made {
        model: Kept::Cells(Box::new(model)),
        operator: "history".to_owned(),
        regions: None,
        refusals: RefusalCounts::default(),
        stopped: "the history ends".to_owned(),
    })
}

struct Seconds {
    load_s: f64,
    analysis_s: f64,
    analysis_cpu_s: f64,
    write_s: f64,
}
