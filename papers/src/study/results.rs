//! What a study finds, as plain data: tidy rows for CSV, the same with summaries for JSON.

use mt_core::Camera;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Everything that a study found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Results {
    /// Frames of the camera path.
    pub frames: u32,
    /// Largest error on the screen, in pixels.
    pub error_px: f32,
    /// One row for each model and operator.
    pub built: Vec<Built>,
    /// One row for each model, operator and size.
    pub degrees: Vec<Degrees>,
    /// One row for each model, operator and dependency.
    pub ordered: Vec<Ordered>,
    /// One row for each model, operator, dependency, criterion, strategy and frame.
    pub observations: Vec<Observation>,
    /// One row for each model, operator and size.
    pub qualities: Vec<Quality>,
    /// What could not be done, such as a picture of a model whose scale no camera can hold.
    pub notes: Vec<String>,
    /// Pictures, without their bytes in JSON.
    pub pictures: Vec<Picture>,
}

/// A model that was built.
#[derive(Clone, Debug, Serialize)]
pub struct Built {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// Vertices of the input.
    pub vertices_in: usize,
    /// Triangles of the input.
    pub triangles_in: usize,
    /// Triangles of the base mesh.
    pub triangles_base: usize,
    /// Merges: edge collapses, or fans.
    pub merges: u32,
    /// Nodes of the hierarchy: vertices that were merged into others.
    pub modifications: u32,
    /// Edges by which vertices are neighbours besides triangles; those of vertex pairs, real and virtual.
    pub links: usize,
    /// Bytes of the vertex hierarchy without dependencies, for each vertex of the input.
    pub bytes_per_vertex: f64,
    /// The same, array by array.
    pub bytes_of: Vec<(&'static str, f64)>,
    /// Bytes of the explicit model, cells and arcs, for each vertex of the input.
    pub explicit_bytes_per_vertex: f64,
    /// Refused plans by reason.
    pub refusals: BTreeMap<String, u64>,
    /// For fans: the share of vertices left at the first merge that did not take a whole link.
    pub stall: Option<f64>,
    /// Wall seconds of analysis, heard by the recorder and the sequence.
    pub seconds: f64,
    /// Wall seconds of deriving the hierarchy from the sequence.
    pub seconds_replay: f64,
    /// Whether it was built by an earlier run; then the seconds are that run's.
    pub from_cache: bool,
}

/// The triangles at a vertex, at some size.
#[derive(Clone, Debug, Serialize)]
pub struct Degrees {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// Share of the vertices that are left.
    pub share: f64,
    /// The most triangles at a vertex.
    pub maximum: usize,
    /// The mean.
    pub mean: f64,
}

/// A dependency on a built model.
#[derive(Clone, Debug, Serialize)]
pub struct Ordered {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// What steps wait for.
    pub dependency: &'static str,
    /// Whether it is a static order; otherwise what it always asks for is counted here.
    pub is_static: bool,
    /// Needs in all.
    pub arcs: usize,
    /// For static schemes: needs that are stored because the forest does not imply them.
    pub beyond_forest: Option<usize>,
    /// Longest chain of needs.
    pub depth: u32,
    /// Bytes for each vertex of the input, hierarchy and dependency.
    pub bytes_per_vertex: f64,
    /// Wall seconds of deriving it.
    pub seconds: f64,
    /// Wall nanoseconds of a step, checks included, refining everything and coarsening it again: the best of three rounds.
    pub nanoseconds_a_step: f64,
}

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct Observation {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// What steps waited for.
    pub dependency: &'static str,
    /// What was asked for.
    pub criterion: &'static str,
    /// In what sequence.
    pub strategy: &'static str,
    /// Which frame, from 0.
    pub frame: u32,
    /// Vertices of the extracted mesh.
    pub vertices: usize,
    /// Its triangles.
    pub triangles: u32,
    /// Steps that refined.
    pub refined: u32,
    /// Steps that coarsened.
    pub coarsened: u32,
    /// Of those that refined, the forced ones.
    pub forced: u32,
    /// Of the chains that forcing took, the 95th percentile in steps.
    pub chain_p95: u32,
    /// The longest of them.
    pub chain_max: u32,
    /// Runs of nodes that changed as one.
    pub fan_steps: u32,
    /// Steps by themselves.
    pub edge_steps: u32,
    /// Nodes refined now and not in the last frame, or the reverse.
    pub changed: u32,
    /// Triangles that the steps made, killed or relabelled.
    pub touched: u32,
    /// Inner edges whose triangles nearly face each other, in every tenth frame of the incremental strategy.
    pub folds: Option<u32>,
    /// Wall seconds of the extraction alone.
    pub seconds: f64,
}

/// The distance of an extracted mesh to the input.
#[derive(Clone, Debug, Serialize)]
pub struct Quality {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// Triangles of the extracted mesh.
    pub triangles: u32,
    /// Its share of the input's triangles.
    pub share: f64,
    /// Root mean square distance, larger direction, relative to the diagonal of the bounding box.
    pub rms: f64,
    /// Largest sampled distance, relative to the diagonal.
    pub max: f64,
    /// Largest error that the model states for this mesh, relative to the diagonal.
    pub stated: f64,
}

/// A picture.
#[derive(Clone, Debug, Serialize)]
pub struct Picture {
    /// The model that it shows.
    pub model: String,
    /// File name, ending in `.png`.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// What drew it.
    pub painter: String,
    /// The camera that looks, for a file `NAME.json` beside the picture.
    pub camera: Camera,
    /// What makes the same picture, from that file and the mesh, whose file stands as `MESH`.
    pub command: String,
    /// The file's bytes.
    #[serde(skip)]
    pub png: Vec<u8>,
}

impl Results {
    /// The observations as CSV, one a row, with a header.
    pub fn csv(&self) -> String {
        let mut csv = "model,operator,dependency,criterion,strategy,frame,vertices,triangles,refined,coarsened,forced,\
                       chain_p95,chain_max,fan_steps,edge_steps,changed,touched,folds,seconds\n"
            .to_owned();
        for o in &self.observations {
            let names = [quoted(&o.model), quoted(&o.operator)].join(",");
            let counts = [o.refined, o.coarsened, o.forced, o.chain_p95, o.chain_max, o.fan_steps, o.edge_steps];
            let counts = counts.map(|count| count.to_string()).join(",");
            let folds = o.folds.map(|folds| folds.to_string()).unwrap_or_default();
            _ = writeln!(
                csv,
                "{names},{},{},{},{},{},{},{counts},{},{},{folds},{:.9}",
                o.dependency,
                o.criterion,
                o.strategy,
                o.frame,
                o.vertices,
                o.triangles,
                o.changed,
                o.touched,
                o.seconds
            );
        }
        csv
    }
}

/// A CSV field, in quotes where it needs them.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_with_commas_are_quoted() {
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(quoted("plain"), "plain");
    }
}
