//! Selective refinement: criteria say where a mesh is too coarse, `extract` and `adapt` make it fine enough there.
//!
//! After `[DeFlorianiTutorial2002]`. `extract` starts from the base mesh; `adapt` from the last frame (contraction, then
//! expansion). Both end in the same front: the least closed set that holds every node the criterion asks for. The
//! engine never sees a triangle, and never an operator.
//!
//! Two things go around a criterion rather than into it: a memory ([`Hysteresis`]), and how nodes that come in runs are
//! judged ([`OnPath`], the dual paths of a fan hierarchy).
//!
//! ```
//! use mt_core::{analysis, Recorder, ErrorKind, Mesh, MultiTessellation};
//! use mt_selective::{Limits, Strategy, UniformError, adapt, extract};
//! # use mt_core::{CellId, VertexId}; use glam::Vec3;
//! # let square = Mesh::from_indices(
//! #     vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::new(0.5, 0.5, 0.1)],
//! #     &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
//! # let mut recorder = Recorder::new(&square).unwrap();
//! # for cell in 0..4 { recorder.kill(CellId(cell)).unwrap(); }
//! # recorder.make([0, 1, 2].map(VertexId)).unwrap();
//! # recorder.make([0, 2, 3].map(VertexId)).unwrap();
//! # recorder.end(0.1).unwrap();
//! # let model = recorder.finish(ErrorKind::Measured).unwrap();
//! // `model` has one modification of error 0.1, from two cells to four.
//! let (mut state, _) = extract(&model, &UniformError { error_max: 0.05 }, &Limits::NONE, Strategy::TopDown, ());
//! assert_eq!(state.cell_count(&model), 4);
//! adapt(&model, &UniformError { error_max: 0.2 }, &Limits::NONE, &mut state);
//! assert_eq!(state.cell_count(&model), 2);
//! ```

mod adapt;
mod certify;
mod criterion;
mod exact;
mod extract;
mod judge;
mod state;

pub use adapt::{adapt, approach};
pub use certify::certify;
pub use criterion::{
    Criterion, Facing, FeaturePoints, Frustum, Hysteresis, InRegion, InView, Measure, Moving, NormalChange, OnPath,
    Pace, Path, PointIndex, Reading, Region, Relax, ScreenError, Silhouette, Transfer, TransferError, UniformError,
    VisualError, Wish,
};
pub use exact::{CellCriterion, CellView, ErrorBelow, Focus, ThresholdBelow, extract_exact};
pub use extract::{Strategy, extract, wish_closure, wish_closure_after};
pub use state::{Limits, Outcome, State};
