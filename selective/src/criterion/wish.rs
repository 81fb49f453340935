//! A criterion chosen at run time.

use crate::criterion::{
    Criterion, Facing, FeaturePoints, InRegion, InView, Moving, NormalChange, Relax, ScreenError, Silhouette, Transfer,
    UniformError, VisualError,
};
use mt_core::Bound;

/// A criterion chosen at run time, any of those without memory.
///
/// Memory and path are no choices among these but go around them, the same way for all:
/// `OnPath { criterion: Hysteresis { criterion: wish, margin }, path }`. A margin of 0 is no hysteresis.
#[derive(Clone, Debug)]
pub enum Wish {
    /// The same error everywhere.
    Uniform(UniformError),
    /// An error within a region.
    Region(InRegion),
    /// An error on a screen.
    Screen(Box<ScreenError>),
    /// A function from distance or size to error.
    Transfer(Box<Transfer>),
    /// An error by distance, view and light.
    Visual(Box<VisualError>),
    /// An error, smaller at feature points.
    Features(Box<FeaturePoints>),
    /// A change of normals.
    Normals(NormalChange),
    /// Another within a view frustum.
    InView(Box<InView<Wish>>),
    /// Another where the surface faces the eye.
    Facing(Box<Facing<Wish>>),
    /// Another, and one more at outlines.
    Silhouette(Box<Silhouette<Wish>>),
    /// Another in motion.
    Moving(Box<Moving<Wish>>),
    /// What any of these asks for; the most urgent counts, so their units should agree where urgency matters.
    Any(Vec<Wish>),
}

impl Wish {
    /// What it is called.
    pub fn name(&self) -> &'static str {
        match self {
            Wish::Uniform(_) => "uniform",
            Wish::Region(_) => "region",
            Wish::Screen(_) => "screen",
            Wish::Transfer(_) => "transfer",
            Wish::Visual(criterion) => match criterion.reading {
                crate::Reading::Tolerance => "visual-tolerance",
                crate::Reading::Error => "visual-error",
            },
            Wish::Features(_) => "features",
            Wish::Normals(_) => "normals",
            Wish::InView(_) => "in-view",
            Wish::Facing(_) => "facing",
            Wish::Silhouette(_) => "silhouette",
            Wish::Moving(_) => "moving",
            Wish::Any(_) => "any",
        }
    }
}

impl Criterion<Bound> for Wish {
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        match self {
            Wish::Uniform(criterion) => criterion.excess(bound, refined),
            Wish::Region(criterion) => criterion.excess(bound, refined),
            Wish::Screen(criterion) => criterion.excess(bound, refined),
            Wish::Transfer(criterion) => criterion.excess(bound, refined),
            Wish::Visual(criterion) => criterion.excess(bound, refined),
            Wish::Features(criterion) => criterion.excess(bound, refined),
            Wish::Normals(criterion) => criterion.excess(bound, refined),
            Wish::InView(criterion) => criterion.excess(bound, refined),
            Wish::Facing(criterion) => criterion.excess(bound, refined),
            Wish::Silhouette(criterion) => criterion.excess(bound, refined),
            Wish::Moving(criterion) => criterion.excess(bound, refined),
            Wish::Any(criteria) => {
                criteria.iter().map(|criterion| criterion.excess(bound, refined)).fold(f32::NEG_INFINITY, f32::max)
            }
        }
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        match self {
            Wish::Uniform(criterion) => criterion.asks(bound, refined),
            Wish::Region(criterion) => criterion.asks(bound, refined),
            Wish::Screen(criterion) => criterion.asks(bound, refined),
            Wish::Transfer(criterion) => criterion.asks(bound, refined),
            Wish::Visual(criterion) => criterion.asks(bound, refined),
            Wish::Features(criterion) => criterion.asks(bound, refined),
            Wish::Normals(criterion) => criterion.asks(bound, refined),
            Wish::InView(criterion) => criterion.asks(bound, refined),
            Wish::Facing(criterion) => criterion.asks(bound, refined),
            Wish::Silhouette(criterion) => criterion.asks(bound, refined),
            Wish::Moving(criterion) => criterion.asks(bound, refined),
            Wish::Any(criteria) => criteria.iter().any(|criterion| criterion.asks(bound, refined)),
        }
    }
}

impl Relax for Wish {
    fn relax(&mut self, by: f32) {
        match self {
            Wish::Uniform(criterion) => criterion.relax(by),
            Wish::Region(criterion) => criterion.relax(by),
            Wish::Screen(criterion) => criterion.relax(by),
            Wish::Transfer(criterion) => criterion.relax(by),
            Wish::Visual(criterion) => criterion.relax(by),
            Wish::Features(criterion) => criterion.relax(by),
            Wish::Normals(criterion) => criterion.relax(by),
            Wish::InView(criterion) => criterion.relax(by),
            Wish::Facing(criterion) => criterion.relax(by),
            Wish::Silhouette(criterion) => criterion.relax(by),
            Wish::Moving(criterion) => criterion.relax(by),
            Wish::Any(criteria) => criteria.iter_mut().for_each(|criterion| criterion.relax(by)),
        }
    }
}
