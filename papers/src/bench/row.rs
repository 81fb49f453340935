//! What is measured, as plain data.

use serde::{Deserialize, Serialize};

/// One operator on one model, kept in one form, measured in one process.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The model.
    pub model: String,
    /// Of generated models: what it is a size of.
    pub shape: Option<String>,
    /// What coarsened it.
    pub operator: String,
    /// What is kept: `cells`, or the scheme of a vertex hierarchy.
    pub dependency: String,
    /// Vertices of the input.
    pub vertices: usize,
    /// Triangles of the input.
    pub triangles: usize,
    /// Triangles of the base mesh.
    pub base: usize,
    /// Building and keeping.
    pub built: Built,
    /// Distances at shares of the input's triangles; none where they were not asked for.
    pub quality: Vec<Quality>,
    /// Steps; none for models of which nothing was merged.
    pub steps: Option<Steps>,
    /// A camera path.
    pub frames: Option<Frames>,
}

/// What building and keeping cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Built {
    /// Threads that might work on it, 0 for as many as there are cores.
    pub threads: usize,
    /// Vertices of a region, 0 where it was coarsened as a whole.
    pub region_vertices: u32,
    /// Wall seconds of coarsening and of all that follows from it.
    pub wall_s: f64,
    /// CPU seconds of the same.
    pub cpu_s: f64,
    /// The most memory the process had by then, the input included, where the system tells.
    pub peak_bytes: Option<u64>,
    /// Bytes of the model in memory; of a hierarchy without its input.
    pub bytes: usize,
    /// Bytes of the file.
    pub file_bytes: u64,
    /// Wall seconds of writing it.
    pub write_s: f64,
    /// Wall seconds of loading it.
    pub load_s: f64,
}

/// How far a mesh of so many triangles is from the input, relative to the diagonal of the bounding box.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Share of the input's triangles.
    pub share: f64,
    /// Root mean square of both directions' samples, the larger.
    pub rms: f64,
    /// Largest sampled distance.
    pub maximum: f64,
}

/// What a step costs: everything is refined and coarsened again, checks included; the best of some rounds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// Refining steps per CPU second.
    pub refine_per_s: f64,
    /// Coarsening steps per CPU second.
    pub coarsen_per_s: f64,
    /// Nanoseconds of either, on average.
    pub ns: f64,
    /// The same where somebody hears of the cells.
    pub ns_with_cells: f64,
}

/// What it costs to follow a camera, and to change a little.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Frames of the path once around the model: one pixel of error, culled by frustum and back faces.
    pub count: u32,
    /// CPU milliseconds of a frame, incremental refinement alone: the median.
    pub median_ms: f64,
    /// The 95th percentile.
    pub p95_ms: f64,
    /// Steps of a frame, on average.
    pub steps: f64,
    /// Triangles of a frame, on average.
    pub triangles: f64,
    /// Wall seconds of two views one after the other against both at once on two threads.
    pub two_views: f64,
    /// CPU microseconds of an adaptation that changes a hundredth of a front of twenty thousand nodes, or of half of all, all
    /// over the model; nothing where errors are so alike that no such two fronts can be asked for.
    pub small_change_us: Option<f64>,
    /// The nodes of that front.
    pub small_change_front: u32,
}

impl Row {
    /// Thousands of triangles removed per CPU second.
    pub fn rate(&self) -> f64 {
        (self.triangles - self.base) as f64 / self.built.cpu_s.max(1e-9) / 1e3
    }

    /// Bytes of the model for each vertex of the input.
    pub fn bytes_per_vertex(&self) -> f64 {
        self.built.bytes as f64 / self.vertices.max(1) as f64
    }

    /// Peak memory for each triangle of the input.
    pub fn peak_per_triangle(&self) -> Option<f64> {
        self.built.peak_bytes.map(|bytes| bytes as f64 / self.triangles.max(1) as f64)
    }

    /// Whether two rows are of the same thing, measured twice.
    pub fn is_again(&self, other: &Self) -> bool {
        let name = |row: &Self| (row.model.clone(), row.operator.clone(), row.dependency.clone(), row.built.threads);
        name(self) == name(other)
    }
}
