//! `mtess info`: what is in a model.

use super::{CommandError, print_json, print_text};
use crate::files::{self, Model};
use clap::Args;
use mt_core::container::Meta;
use mt_core::{Explicit, MultiTessellation, NodeId};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct Info {
    /// The model
    model: PathBuf,
    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        let (model, meta) = files::load_model(&self.model)?;
        let facts = match &model {
            Model::Triangles(model) => facts(model, &meta),
            Model::Tetrahedra(model) => facts(model, &meta),
        };
        if self.json {
            print_json(&facts);
        } else {
            print_text(&text(&facts, &meta));
        }
        Ok(ExitCode::SUCCESS)
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

fn text(facts: &Value, meta: &Meta) -> String {
    let get = |key: &str| facts[key].to_string().replace('"', "");
    let refusals: Vec<_> = meta.refusals.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let mut lines = vec![
        format!("{} by {}", get("source"), get("operator")),
        format!(
            "input          {} vertices, {} cells of {} corners",
            get("vertices_in"),
            get("cells_in"),
            get("corners")
        ),
        format!("extent         {} to {}, diagonal {}", get_corner(facts, 0), get_corner(facts, 1), get("diagonal")),
        format!("base mesh      {} cells ({})", get("cells_base"), get("stopped")),
        format!(
            "modifications  {}, in an order of {} arcs and depth {}",
            get("modifications"),
            get("arcs"),
            get("depth")
        ),
        format!(
            "               {} terminal (nothing coarser follows), {} that nothing needs",
            get("terminal_modifications"),
            get("leaf_modifications")
        ),
        format!("errors         {} to {} model units ({})", get("error_min"), get("error_max"), get("error_kind")),
        format!(
            "memory         {} bytes, {:.1} an input vertex",
            get("bytes"),
            facts["bytes_per_vertex"].as_f64().unwrap_or(0.0)
        ),
        format!("refused plans  {}", if refusals.is_empty() { "none".into() } else { refusals.join(", ") }),
    ];
    lines.extend(meta.load_report.iter().map(|line| format!("on loading     {line}")));
    lines.join("\n")
}
