//! What a study finds, as plain data: tidy rows for CSV, the same with summaries for JSON.

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
    /// One row for each model, operator, criterion, strategy and frame.
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
    /// Modifications.
    pub modifications: u32,
    /// Arcs of the order.
    pub arcs: usize,
    /// Longest chain of needs.
    pub depth: u32,
    /// Bytes in memory for each vertex of the input.
    pub bytes_per_vertex: f64,
    /// Refused plans by reason.
    pub refusals: BTreeMap<String, u64>,
    /// Wall seconds of analysis.
    pub seconds: f64,
}

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct Observation {
    /// The subject.
    pub model: String,
    /// What coarsened it.
    pub operator: String,
    /// Which order was kept.
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
    /// File name, ending in `.png`.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// What drew it.
    pub painter: String,
    /// The file's bytes.
    #[serde(skip)]
    pub png: Vec<u8>,
}

impl Results {
    /// The observations as CSV, one a row, with a header.
    pub fn csv(&self) -> String {
        let mut csv =
            "model,operator,dependency,criterion,strategy,frame,vertices,triangles,refined,coarsened,forced,seconds\n"
                .to_owned();
        for o in &self.observations {
            _ = writeln!(
                csv,
                "{},{},{},{},{},{},{},{},{},{},{},{:.9}",
                quoted(&o.model),
                quoted(&o.operator),
                o.dependency,
                o.criterion,
                o.strategy,
                o.frame,
                o.vertices,
                o.triangles,
                o.refined,
                o.coarsened,
                o.forced,
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
