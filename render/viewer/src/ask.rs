//! What is asked of every frame: criterion and strategy with their parameters, as a window shows them.

use glam::Vec3;
use mt_core::{Camera, Mesh};
use papers::study::{CriterionKind, StrategyKind, sharp_vertices};
use selective::{
    Facing, FeaturePoints, Hysteresis, InRegion, Limits, Moving, OnPath, Path, PointIndex, Reading, Region,
    ScreenError, Silhouette, UniformError, VisualError, Wish,
};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// What is asked, in numbers that do not depend on the model's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// What is asked for.
    pub criterion: CriterionKind,
    /// In what sequence it is answered.
    pub strategy: StrategyKind,
    /// Largest error on the screen, in pixels.
    pub error_px: f32,
    /// Largest error in space, as a share of the input's diagonal.
    pub error_share: f32,
    /// Half a side of the region about the point looked at, as a share of the diagonal.
    pub region_share: f32,
    /// Most triangles; under [`CriterionKind::Budget`].
    pub cells: u32,
}

impl Ask {
    /// Errors on the screen that may be asked for, in pixels.
    pub const PIXELS: RangeInclusive<f32> = 1e-3..=1e3;
    /// Errors in space that may be asked for, as shares of the diagonal.
    pub const SHARES: RangeInclusive<f32> = 1e-7..=1.0;

    /// One pixel on the screen, from frame to frame; a tenth of the input where there is a budget.
    pub fn usual(cells: u32) -> Self {
        Self {
            criterion: CriterionKind::Screen,
            strategy: StrategyKind::Incremental,
            error_px: 1.0,
            error_share: 1e-3,
            region_share: 0.1,
            cells: cells / 10,
        }
    }

    /// Whether the criterion is about errors in space, and not on a screen.
    pub(crate) fn is_spatial(&self) -> bool {
        use CriterionKind::{Features, Region, Uniform, Visual};
        matches!(self.criterion, Uniform | Region | Features | Visual)
    }

    /// As a line: `screen 1 px, incremental`.
    pub fn told(&self) -> String {
        let share = format!("{:.3} % of the diagonal", 100.0 * self.error_share);
        let how = match self.criterion {
            CriterionKind::Region => format!("{share} within {:.1} %", 200.0 * self.region_share),
            _ if self.is_spatial() => share,
            CriterionKind::Budget => format!("{} triangles", self.cells),
            _ => format!("{} px", short(self.error_px)),
        };
        format!("{} {how}, {}", self.criterion, self.strategy)
    }
}

/// Three digits after the point at most.
fn short(value: f32) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What of an input criteria need to know. Made once.
#[derive(Clone, Debug)]
pub struct Extent {
    /// Corners of the bounding box.
    pub low: Vec3,
    /// The upper one.
    pub high: Vec3,
    /// Triangles of the input.
    pub cells: u32,
    features: Arc<PointIndex>,
}

impl Extent {
    /// Of an input. O(cells log cells).
    pub fn of(input: &Mesh<3>) -> Self {
        let (low, high) = input.bounding_box().unwrap_or_default();
        let features = Arc::new(PointIndex::new(sharp_vertices(input)));
        Self { low, high, cells: input.cell_count() as u32, features }
    }

    /// Length of the diagonal; of a model without extent a small length.
    pub fn diagonal(&self) -> f32 {
        (self.high - self.low).length().max(f32::MIN_POSITIVE * 1e6)
    }
}

/// A question for one frame.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What is asked for.
    pub wish: Wish,
    /// Within what.
    pub limits: Limits,
    /// In what sequence.
    pub strategy: StrategyKind,
    /// What a node's error may lack of what is asked before it goes, under hysteresis; in the criterion's unit.
    pub margin: f32,
    /// Which runs take the coarse path.
    pub path: Path,
}

impl Asked {
    /// The wish with a memory.
    pub(crate) fn lasting(&self) -> Hysteresis<&Wish> {
        Hysteresis { criterion: &self.wish, margin: self.margin }
    }

    /// The wish with runs that are judged as its path says.
    pub(crate) fn on_path(&self) -> OnPath<&Wish> {
        OnPath { criterion: &self.wish, path: self.path }
    }
}

impl Ask {
    /// The question that an eye puts to a model, which came from `last` since the frame before.
    pub fn of(&self, extent: &Extent, camera: &Camera, last: Vec3) -> Asked {
        let diagonal = extent.diagonal();
        let (eye, error) = (camera.eye, diagonal * self.error_share);
        let screen = |share: f32| Wish::Screen(Box::new(ScreenError::new(camera, share * self.error_px)));
        let mut limits = Limits::NONE;
        let wish = match self.criterion {
            CriterionKind::Uniform => Wish::Uniform(UniformError { error_max: error }),
            CriterionKind::Region => {
                let half = Vec3::splat(diagonal * self.region_share);
                let region = Region { low: camera.target - half, high: camera.target + half };
                Wish::Region(InRegion { region, error_max: error })
            }
            CriterionKind::Screen => screen(1.0),
            CriterionKind::Facing => Wish::Facing(Box::new(Facing { eye, criterion: screen(1.0) })),
            CriterionKind::Silhouette => {
                let [outline, elsewhere] = [0.25, 1.0].map(screen);
                Wish::Silhouette(Box::new(Silhouette { eye, outline, elsewhere }))
            }
            CriterionKind::Moving => {
                let speed = last.distance(eye);
                Wish::Moving(Box::new(Moving::new(screen(1.0), 20.0, speed, diagonal)))
            }
            CriterionKind::Features => Wish::Features(Box::new(FeaturePoints {
                points: Arc::clone(&extent.features),
                error_at: error * 0.1,
                error_max: error * 10.0,
            })),
            CriterionKind::Visual => Wish::Visual(Box::new(VisualError {
                eye,
                light: Vec3::new(0.3, 0.9, 0.4).normalize(),
                epsilon: 0.2,
                scale: 1e-3,
                error_min: error * 0.1,
                reading: Reading::Tolerance,
            })),
            CriterionKind::Budget => {
                limits.cells = Some(self.cells);
                screen(0.0)
            }
        };
        let path = match self.strategy {
            StrategyKind::Dual => Path::Difference,
            StrategyKind::DualDistance => Path::Distance { eye, beyond: diagonal * 0.5 },
            StrategyKind::Coarse => Path::Coarse,
            _ => Path::Fine,
        };
        // Half of what is asked for, in the unit that it is asked in.
        let margin = 0.5 * if self.is_spatial() { error } else { self.error_px };
        Asked { wish, limits, strategy: self.strategy, margin, path }
    }
}
