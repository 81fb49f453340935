//! `mtess info`: what is in a model.

use super::{CommandError, print_json, print_text};
use crate::files::{self, FileError, Model};
use clap::Args;
use mt_core::container::{Meta, SectionInfo};
use mt_core::hierarchy::Dependency;
use mt_core::{Explicit, Hierarchy, MultiTessellation, NodeId, Order, Rule};
use operators::order::{Scheme, Visit};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct Info {
    /// The model
    model: PathBuf,
    /// Read the head of the file alone: what it says about itself, and where its bytes are
    #[arg(long)]
    head: bool,
    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        let archive = files::open_archive(&self.model)?;
        let sections: Vec<SectionInfo> = archive.sections().collect();
        let meta = archive.meta().clone();
        drop(archive);
        let mut facts = match self.head {
            true => json!({ "meta": meta }),
            false => match files::load_model(&self.model)?.0 {
                Model::Triangles(model) => facts(&*model, &meta),
                Model::Tetrahedra(model) => facts(&*model, &meta),
                Model::Hierarchy { replay, scheme } => scheme
                    .visit(&replay, Facts { meta: &meta, scheme })
                    .map_err(|error| FileError::new(&self.model, error))?,
            },
        };
        if self.json {
            let told = |s: &SectionInfo| json!({ "name": s.name, "stored": s.stored, "bytes": s.length });
            facts["file"] = sections.iter().map(told).collect();
            print_json(&facts);
        } else if self.head {
            print_text(&[head_text(&meta), sections_text(&sections)].concat().join("\n"));
        } else {
            print_text(&[text(&facts, &meta), sections_text(&sections)].concat().join("\n"));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn head_text(meta: &Meta) -> Vec<String> {
    let kind = match &meta.dependency {
        Some(scheme) => format!("a vertex hierarchy under {scheme}"),
        None => format!("an explicit model of cells of {} corners", meta.corners),
    };
    vec![
        format!("{} by {}: {kind}", meta.source, meta.operator),
        format!("input          {} vertices, {} cells", meta.input_vertices, meta.input_cells),
        format!("modifications  {} ({})", meta.modifications, meta.stopped),
    ]
}

fn sections_text(sections: &[SectionInfo]) -> Vec<String> {
    let stored: u64 = sections.iter().map(|section| section.stored).sum();
    let unpacked: u64 = sections.iter().map(|section| section.length).sum();
    let of = |s: &SectionInfo| format!("{} {}", s.name, s.stored);
    let table = sections.iter().map(of).collect::<Vec<_>>().join(", ");
    let packed = if stored < unpacked { format!(", {unpacked} unpacked") } else { String::new() };
    vec![format!("sections       {stored} bytes in the file{packed}: {table}")]
}

/// The facts of a hierarchy, whatever its dependencies.
struct Facts<'a> {
    meta: &'a Meta,
    scheme: Scheme,
}

impl Visit for Facts<'_> {
    type Output = Value;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Value {
        let (replay, meta) = (&model.replay, self.meta);
        let vertices = f64::from(replay.leaf_count().max(1));
        // A dynamic rule has no order to speak of.
        let order = (D::RULE == Rule::Static).then(|| mt_core::check::order_of(model).ok()).flatten();
        let terminal = |order: &Order| (0..order.len()).filter(|&m| order.needs(NodeId(m)).is_empty()).count();
        let errors = || (0..model.len()).map(|m| model.bound(NodeId(m)).error);
        let leaves = order.as_ref().map(|order| (0..model.len()).filter(|&m| order.dependents(NodeId(m)).is_empty()));
        let input = replay.reference();
        let (diagonal, bounding_box) = (input.diagonal(), input.bounding_box());
        json!({
            "source": meta.source,
            "operator": meta.operator,
            "dependency": self.scheme.name(),
            "grid_step": meta.grid_step,
            "corners": 3,
            "vertices_in": replay.leaf_count(),
            "cells_in": replay.cells().len(),
            "links_in": replay.links().len(),
            "cells_base": model.cell_count(&model.base()),
            "vertices_total": replay.vertex_count(),
            "modifications": model.len(),
            "diagonal": diagonal,
            "bounding_box": bounding_box.map(|(low, high)| [low.to_array(), high.to_array()]),
            "arcs": order.as_ref().map(|order| order.arc_count()),
            "depth": order.as_ref().map(|order| order.depth()),
            "terminal_modifications": order.as_ref().map(terminal),
            "leaf_modifications": leaves.map(Iterator::count),
            "stopped": meta.stopped,
            "error_kind": meta.error_kind,
            "error_min": errors().reduce(f32::min),
            "error_max": errors().reduce(f32::max),
            "bytes": model.bytes(),
            "bytes_per_vertex": model.bytes() as f64 / vertices,
            "bytes_by_part": replay.bytes_table().into_iter().chain([("dependency", model.dependency.bytes())])
                .map(|(name, bytes)| (name.to_owned(), json!(bytes))).collect::<serde_json::Map<_, _>>(),
            "refusals": meta.refusals,
            "load_report": meta.load_report,
        })
    }
}

fn facts<const N: usize>(model: &Explicit<N>, meta: &Meta) -> Value {
    let order = model.order();
    let nodes = (0..model.len()).map(NodeId);
    let errors = || (0..model.len()).map(|m| model.bound(NodeId(m)).error);
    // Terminal: no other modification builds on it, so nothing coarser follows.
    let terminal = nodes.clone().filter(|&m| order.needs(m).is_empty()).count();
    let leaves = nodes.filter(|&m| order.dependents(m).is_empty()).count();
    let parts = model.parts();
    let input = model.reference();
    let (diagonal, bounding_box) = (input.diagonal(), input.bounding_box());
    json!({
        "source": meta.source,
        "operator": meta.operator,
        "corners": N,
        "vertices_in": model.input_vertex_count(),
        "cells_in": model.input_cell_count(),
        "cells_base": model.base_cells().len(),
        "cells_total": model.total_cell_count(),
        "vertices_total": parts.positions.len(),
        "modifications": model.len(),
        "diagonal": diagonal,
        "bounding_box": bounding_box.map(|(low, high)| [low.to_array(), high.to_array()]),
        "arcs": order.arc_count(),
        "depth": order.depth(),
        "terminal_modifications": terminal,
        "leaf_modifications": leaves,
        "stopped": meta.stopped,
        "error_kind": model.error_kind(),
        "error_min": errors().reduce(f32::min),
        "error_max": errors().reduce(f32::max),
        "bytes": model.bytes(),
        "bytes_per_vertex": model.bytes() as f64 / f64::from(model.input_vertex_count().max(1)),
        "bytes_by_part": {
            "positions": 12 * parts.positions.len(),
            "corners": 4 * N * parts.corners.len(),
            "coarse_sides": 4 * parts.coarse_start.len(),
            "fine_sides": 4 * (parts.fine.len() + parts.fine_start.len()),
            "arcs": order.bytes(),
            "discovery_forest": size_of_val(parts.parents.as_slice()),
            "bounds": size_of_val(parts.bounds.as_slice()),
            "base_and_roots": size_of_val(model.base_cells()) + 4 * terminal,
        },
        "refusals": meta.refusals,
        "load_report": meta.load_report,
    })
}

fn get_corner(facts: &Value, i: usize) -> String {
    facts["bounding_box"][i].to_string()
}

fn text(facts: &Value, meta: &Meta) -> Vec<String> {
    let get = |key: &str| facts[key].to_string().replace('"', "");
    let refusals: Vec<_> = meta.refusals.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let mut lines = vec![
        match &meta.dependency {
            Some(_) => {
                format!("{} by {}, a vertex hierarchy under {}", get("source"), get("operator"), get("dependency"))
            }
            None => format!("{} by {}", get("source"), get("operator")),
        },
        format!(
            "input          {} vertices, {} cells of {} corners",
            get("vertices_in"),
            get("cells_in"),
            get("corners")
        ),
        format!("extent         {} to {}, diagonal {}", get_corner(facts, 0), get_corner(facts, 1), get("diagonal")),
        format!("base mesh      {} cells ({})", get("cells_base"), get("stopped")),
        match facts["arcs"].is_null() {
            true => format!("modifications  {}, under a rule that looks at the mesh", get("modifications")),
            false => format!(
                "modifications  {}, in an order of {} arcs and depth {}; {} terminal (nothing coarser follows), {} that nothing \
                 needs",
                get("modifications"),
                get("arcs"),
                get("depth"),
                get("terminal_modifications"),
                get("leaf_modifications")
            ),
        },
        format!("errors         {} to {} model units ({})", get("error_min"), get("error_max"), get("error_kind")),
        format!(
            "memory         {} bytes{}, {:.1} an input vertex",
            get("bytes"),
            if meta.dependency.is_some() { " besides the input" } else { "" },
            facts["bytes_per_vertex"].as_f64().unwrap_or(0.0)
        ),
        format!("refused plans  {}", if refusals.is_empty() { "none".into() } else { refusals.join(", ") }),
    ];
    lines.extend(
        meta.grid_step.map(|step| format!("grid           {step} model units a step: vertices were moved onto it")),
    );
    lines.extend(meta.load_report.iter().map(|line| format!("on loading     {line}")));
    lines
}
