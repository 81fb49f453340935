//! Criteria on bounds: is a modification's coarse side good enough?
//!
//! All of these are monotone in the bound: what contains another bound asks for at least as much. Sums are in `f64`, so
//! that rounding does not undo what saturation has proved. The exception is [`Hysteresis`], which has a memory.
//!
//! | criterion | asks |
//! |---|---|
//! | [`UniformError`], [`InRegion`] | above an error, everywhere or within a region |
//! | [`ScreenError`] | above an error in pixels, within the view frustum |
//! | [`Transfer`] | above an error that a piecewise linear function gives for a distance or a size on the screen |
//! | [`VisualError`] | above an error that depends on distance, view and light |
//! | [`FeaturePoints`] | above a smaller error where feature points are |
//! | [`NormalChange`] | while normals differ by more than an angle |
//!
//! Others wrap criteria: [`InView`] and [`Facing`] leave out what the camera does not see, [`Silhouette`] is stricter at
//! outlines, [`Moving`] more lenient in motion, [`Hysteresis`] hesitates to coarsen, [`OnPath`] judges runs of nodes as
//! one. [`Wish`] is any of those without memory, chosen at run time.

mod angles;
mod facing;
mod features;
mod hysteresis;
mod moving;
mod normals;
mod path;
mod region;
mod screen;
mod silhouette;
#[cfg(test)]
mod tests;
mod transfer;
mod uniform;
mod visual;
mod wish;

pub use facing::Facing;
pub use features::{FeaturePoints, PointIndex};
pub use hysteresis::Hysteresis;
pub use moving::{Moving, Relax};
pub use normals::NormalChange;
pub use path::{OnPath, Pace, Path};
pub use region::{InRegion, Region};
pub use screen::{Frustum, InView, ScreenError};
pub use silhouette::Silhouette;
pub use transfer::{Measure, Transfer, TransferError};
pub use uniform::UniformError;
pub use visual::{Reading, VisualError};
pub use wish::Wish;

/// Judges a modification by its bound.
pub trait Criterion<B>: Sync {
    /// Whether the answer depends on `refined` (hysteresis). Such criteria are exempt from extract = adapt.
    const MEMORY: bool = false;
    /// Whether [`Self::pace`] may say anything but [`Pace::Single`]; without, the engine never looks at runs.
    const RUNS: bool = false;
    /// How far the coarse side is from good enough, in the criterion's own unit; above 0 asks to refine. Larger is more
    /// urgent. Never not a number.
    fn excess(&self, bound: &B, refined: bool) -> f32;
    /// Whether it asks to refine: whether the excess is above 0, told with less work where that can be.
    fn asks(&self, bound: &B, refined: bool) -> bool {
        self.excess(bound, refined) > 0.0
    }
    /// How a run of nodes that a coarse step makes at once is treated, by the bound of its last node. See [`OnPath`].
    fn pace(&self, _last: &B) -> Pace {
        Pace::Single
    }
}

impl<B, C: Criterion<B>> Criterion<B> for &C {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &B, refined: bool) -> f32 {
        (**self).excess(bound, refined)
    }
    fn asks(&self, bound: &B, refined: bool) -> bool {
        (**self).asks(bound, refined)
    }
    fn pace(&self, last: &B) -> Pace {
        (**self).pace(last)
    }
}
