//! Dual paths: runs of nodes that are judged one by one, or as one.
//!
//! After `[LivnySokolovskyElSana2006]`, section 3.4: a fan of edge collapses is a run of nodes, each of which needs the
//! next. On the fine path each node decides for itself; on the coarse path the last node of the run, that of the whole
//! fan's error, decides for all of it. Both end in meshes of one model.

use crate::criterion::angles::distances;
use crate::criterion::{Criterion, Relax};
use glam::Vec3;
use mt_core::Bound;

/// How a run of more than one node is treated.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// Each node decides for itself and is a step by itself.
    #[default]
    Single,
    /// Each node decides for itself; where that changes the whole run in one call, it is one step.
    Together,
    /// Where the last node of the run is asked for, all of it is, as one step.
    Whole,
}

/// Which runs take the coarse path.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub enum Path {
    /// None: edge steps everywhere.
    #[default]
    Fine,
    /// Those of which all nodes are asked for, or none: where the difference between the current and the wanted front
    /// takes in the whole run, it is one fan step. The front is that of [`Path::Fine`].
    Difference,
    /// Those farther from the eye than `beyond`: the paper's heuristic, which spares looking at the difference. A run is
    /// farther when all of its last node's sphere is; the front lies between the fine and the coarse.
    Distance {
        /// Where the eye is.
        eye: Vec3,
        /// Distance beyond which runs are judged as one, in model units.
        beyond: f32,
    },
    /// All: the last node of a run decides for all of it. The front holds that of [`Path::Fine`]. A run is refined in
    /// part only where others need a part of it.
    Coarse,
}

/// A criterion whose runs take a path. It goes outside of all other wrappers that judge places differently.
///
/// The wish that it comes to: a node is asked for if the criterion asks for it, or if its run is judged as one and the
/// criterion asks for the last node of the run. That is a wish like any other, so extract and adapt end in its least
/// closure and every law holds.
#[derive(Clone, Debug)]
pub struct OnPath<C> {
    /// What to ask.
    pub criterion: C,
    /// Of whom.
    pub path: Path,
}

impl<C: Criterion<Bound>> Criterion<Bound> for OnPath<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = true;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        self.criterion.excess(bound, refined)
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        self.criterion.asks(bound, refined)
    }
    fn pace(&self, last: &Bound) -> Pace {
        match self.path {
            Path::Fine => Pace::Single,
            Path::Difference => Pace::Together,
            Path::Distance { eye, beyond } if distances(last, eye).least <= f64::from(beyond) => Pace::Single,
            Path::Distance { .. } | Path::Coarse => Pace::Whole,
        }
    }
}

impl<C: Relax> Relax for OnPath<C> {
    fn relax(&mut self, by: f32) {
        self.criterion.relax(by);
    }
}
