//! The options that say what to extract, shared by `extract` and `render`.

use crate::certificate::Asked;
use crate::files::{self, FileError};
use clap::{Args, ValueEnum};
use glam::Vec3;
use mt_core::{Bound, Camera, Explicit, Mesh, MultiTessellation};
use selective::{ErrorBelow, Focus, Limits, Outcome, Region, State, Strategy, adapt, extract, extract_exact};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What to extract.
#[derive(Args, Debug, Clone)]
pub struct Selection {
    /// Largest error, in model units; with --region, within it
    #[arg(long, value_name = "E")]
    pub error: Option<f32>,
    /// Most cells; never exceeded
    #[arg(long, value_name = "N")]
    pub cells: Option<u32>,
    /// View-dependent: error on the screen of this camera, and coarse outside its frustum
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["error", "region"])]
    pub camera: Option<PathBuf>,
    /// Largest error on the screen of --camera, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0, requires = "camera")]
    pub pixels: f32,
    /// Fine within this box only
    #[arg(long, value_name = "x0,y0,z0,x1,y1,z1", value_parser = parse_region, requires = "error", allow_hyphen_values = true)]
    pub region: Option<Region>,
    /// The input itself
    #[arg(long, conflicts_with_all = ["error", "cells", "camera", "region", "time_ms"])]
    pub reference: bool,
    /// In what sequence to refine
    #[arg(long, value_enum, default_value_t = Way::TopDown)]
    pub strategy: Way,
    /// Stop refining after this many milliseconds, with a mesh that conforms
    #[arg(long, value_name = "MS")]
    pub time_ms: Option<u64>,
    /// Judge single cells instead of modifications: a cell across the region's border may be coarse (loose) or not (strict)
    #[arg(long, value_enum, requires = "error", conflicts_with_all = ["cells", "time_ms"])]
    pub per_cell: Option<PerCell>,
}

/// In what sequence to refine.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Depth first from the base mesh
    TopDown,
    /// Most urgent first from the base mesh
    Priority,
    /// Contraction from the full mesh, then expansion
    Incremental,
}

/// How cells across the border of the region are judged.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum PerCell {
    /// By their most lenient point
    Loose,
    /// By their most demanding point
    Strict,
}

/// The cameras of a file, a JSON list of them, each checked; without one a path of so many frames once around these points.
pub fn cameras(path: Option<&Path>, frames: u32, around: &[Vec3]) -> Result<Vec<Camera>, FileError> {
    let Some(path) = path else {
        let mesh = Mesh { positions: around.to_vec(), cells: Vec::new() };
        return Ok(papers::study::camera_path(&mesh, frames));
    };
    let cameras: Vec<Camera> = files::load_json(path)?;
    if cameras.is_empty() {
        return Err(FileError::new(path, "there is no camera in it"));
    }
    for (i, camera) in cameras.iter().enumerate() {
        camera.check().map_err(|error| FileError::new(path, format!("camera {i}: {error}")))?;
    }
    Ok(cameras)
}

fn parse_region(text: &str) -> Result<Region, String> {
    let numbers: Vec<f32> = text
        .split(',')
        .map(|part| part.trim().parse().map_err(|_| format!("'{part}' is not a number")))
        .collect::<Result<_, _>>()?;
    let &[x0, y0, z0, x1, y1, z1] = numbers.as_slice() else {
        return Err(format!("six numbers are wanted, not {}", numbers.len()));
    };
    let (a, b) = (glam::Vec3::new(x0, y0, z0), glam::Vec3::new(x1, y1, z1));
    if !(a.is_finite() && b.is_finite()) {
        return Err("the box must be finite".into());
    }
    if !a.cmple(b).all() {
        return Err("the first corner must not exceed the second: x0 <= x1, y0 <= y1, z0 <= z1".into());
    }
    Ok(Region { low: a, high: b })
}

/// Why the options ask for nothing.
#[derive(Debug, thiserror::Error)]
pub enum SelectionError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("say what to extract: --error, --cells, --camera, --region with --error, or --reference")]
    Nothing,
    #[error("--{0} must be a number, 0 or more")]
    Number(&'static str),
}

impl Selection {
    /// The camera of `--camera`, read and checked.
    pub fn load_camera(&self) -> Result<Option<Camera>, FileError> {
        let Some(path) = &self.camera else { return Ok(None) };
        let camera: Camera = files::load_json(path)?;
        camera.check().map_err(|error| FileError::new(path, error))?;
        Ok(Some(camera))
    }

    /// Whether a number of cells is all that was asked for.
    pub fn is_budget_only(&self) -> bool {
        self.cells.is_some() && self.error.is_none() && self.camera.is_none() && self.time_ms.is_none()
    }

    /// What is asked for, apart from limits.
    pub fn asked(&self, camera: Option<&Camera>) -> Result<Asked, SelectionError> {
        if self.error.is_some_and(|error| error.is_nan() || error < 0.0) {
            return Err(SelectionError::Number("error"));
        }
        if self.pixels.is_nan() || self.pixels < 0.0 {
            return Err(SelectionError::Number("pixels"));
        }
        match (camera, self.error, self.region) {
            (Some(&camera), ..) => Ok(Asked::Screen { camera, error_px: self.pixels }),
            (_, Some(error_max), Some(Region { low, high })) => Ok(Asked::Region { low, high, error_max }),
            (_, Some(error_max), None) => Ok(Asked::Uniform { error_max }),
            // Below 0, so that what costs no error is asked for too.
            _ if self.reference || self.cells.is_some() => Ok(Asked::Uniform { error_max: -1.0 }),
            _ => Err(SelectionError::Nothing),
        }
    }

    /// Extracts from a model.
    pub fn run<M: MultiTessellation<3, Bound = Bound>>(
        &self,
        model: &M,
        camera: Option<&Camera>,
    ) -> Result<(State<3, M, ()>, Outcome), SelectionError> {
        let wish = self.asked(camera)?.wish();
        let limits = Limits { cells: self.cells, time: self.time_ms.map(Duration::from_millis) };
        Ok(match self.strategy {
            Way::TopDown => extract(model, &wish, &limits, Strategy::TopDown, ()),
            Way::Priority => extract(model, &wish, &limits, Strategy::Priority, ()),
            Way::Incremental => {
                let mut state = State::new(model, ());
                (0..model.len()).rev().for_each(|m| state.force(model, mt_core::NodeId(m)));
                let outcome = adapt(model, &wish, &limits, &mut state);
                (state, outcome)
            }
        })
    }

    /// Extracts by judging single cells, of which only explicit models keep errors.
    pub fn run_per_cell(&self, model: &Explicit<3>, per_cell: PerCell) -> (State<3, Explicit<3>, ()>, Outcome) {
        let focus = if per_cell == PerCell::Loose { Focus::Loose } else { Focus::Strict };
        let criterion = ErrorBelow { error_max: self.error.unwrap_or(0.0), region: self.region, focus };
        extract_exact(model, &criterion, ())
    }
}
