//! What a study may combine, by name: dependencies, criteria, strategies, and which combinations make sense.

use super::{Config, Subject};
use mt_core::Camera;
use operators::order::Scheme;
use selective::{
    Facing, FeaturePoints, InRegion, Limits, Moving, Path, PointIndex, Reading, Region, ScreenError, Silhouette,
    UniformError, VisualError, Wish,
};
use std::sync::Arc;

/// Declares an enum of choices with their names, and reads and writes them.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident, $what:literal { $($(#[$each:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Copy, Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name { $($(#[$each])* $variant,)+ }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];

            /// Its name in commands and reports.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }
        }

        impl std::str::FromStr for $name {
            type Err = UnknownChoice;
            fn from_str(name: &str) -> Result<Self, UnknownChoice> {
                Self::ALL.iter().copied().find(|choice| choice.name() == name).ok_or_else(|| UnknownChoice {
                    what: $what,
                    name: name.to_owned(),
                    names: Self::ALL.iter().map(|choice| choice.name()).collect::<Vec<_>>().join(", "),
                })
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

/// A name that is none of those there are.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} `{name}`; there are {names}")]
pub struct UnknownChoice {
    what: &'static str,
    name: String,
    names: String,
}

choices! {
    /// What is asked for along the camera path.
    CriterionKind, "criterion" {
        /// The same error everywhere, ever smaller.
        Uniform = "uniform",
        /// No error at all within a box that travels through the model.
        Region = "region",
        /// An error on the screen, within the view frustum.
        Screen = "screen",
        /// The same where the surface faces the eye.
        Facing = "facing",
        /// An error on the screen, a quarter of it at outlines.
        Silhouette = "silhouette",
        /// The largest error on the screen grows with the camera's speed.
        Moving = "moving",
        /// Input detail at feature points, coarse elsewhere.
        Features = "features",
        /// Eq. 3 of `[LivnySokolovskyElSana2006]`, read as a tolerance.
        Visual = "visual",
        /// The least error on the screen that a tenth of the triangles allow.
        Budget = "budget",
    }
}

choices! {
    /// In what sequence it is answered.
    StrategyKind, "strategy" {
        /// From the base mesh, depth first.
        TopDown = "top-down",
        /// From the base mesh, most urgent first.
        Priority = "priority",
        /// From the mesh of the last frame.
        Incremental = "incremental",
        /// The same; a node is kept until its error is well below what is asked.
        Hysteresis = "hysteresis",
        /// Incremental; runs of nodes of which all change are one fan step.
        Dual = "dual",
        /// Incremental; runs of nodes far from the eye are one fan step.
        DualDistance = "dual-distance",
        /// Incremental; every run of nodes is one fan step, as its last node decides.
        Coarse = "coarse",
    }
}

/// What a step waits for: the cells of the explicit model, or a scheme on the vertex hierarchy.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DependencyKind {
    /// The explicit model, with its cells and arcs stored.
    Cells,
    /// A scheme on the replay.
    Scheme(Scheme),
}

impl DependencyKind {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Cells).chain(Scheme::ALL.map(Self::Scheme))
    }

    /// Its name in commands and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Scheme(scheme) => scheme.name(),
        }
    }
}

impl std::str::FromStr for DependencyKind {
    type Err = UnknownChoice;
    fn from_str(name: &str) -> Result<Self, UnknownChoice> {
        Self::all().find(|choice| choice.name() == name).ok_or_else(|| UnknownChoice {
            what: "dependency",
            name: name.to_owned(),
            names: Self::all().map(Self::name).collect::<Vec<_>>().join(", "),
        })
    }
}

/// Whether a combination says anything that another does not.
pub(super) fn is_sensible(
    dependency: DependencyKind,
    criterion: CriterionKind,
    strategy: StrategyKind,
    has_runs: bool,
) -> bool {
    let budget = criterion == CriterionKind::Budget;
    match strategy {
        // A budget is met by priority; depth first it would be the same computation under another name.
        StrategyKind::TopDown => !budget,
        StrategyKind::Priority | StrategyKind::Incremental => true,
        StrategyKind::Hysteresis => !budget,
        // Without runs there is one path; the explicit model knows a fan as one node.
        StrategyKind::Dual | StrategyKind::DualDistance | StrategyKind::Coarse => {
            !budget && has_runs && dependency != DependencyKind::Cells
        }
    }
}

/// What [`is_sensible`] leaves out, for a reader.
pub(super) const LEFT_OUT: [&str; 3] = [
    "a budget top-down, which would be the same as by priority; with hysteresis; and along the paths of fans",
    "dual, dual-distance and coarse where no fans are: they differ for hierarchies of fans alone (cells knows a fan as one node)",
    "schemes that do not take a sequence, each of them with its reason at the end of the page",
];

/// A criterion and the limits it is asked under, for one frame.
pub(super) struct Query {
    pub(super) criterion: Wish,
    pub(super) limits: Limits,
}

/// What the queries of a subject have in common.
pub(super) struct Scene<'a> {
    pub(super) subject: &'a Subject,
    pub(super) config: &'a Config,
    pub(super) cameras: Vec<Camera>,
    features: Arc<PointIndex>,
    diagonal: f32,
}

impl<'a> Scene<'a> {
    pub(super) fn new(subject: &'a Subject, config: &'a Config) -> Self {
        let diagonal = subject.mesh.diagonal() as f32;
        let features = Arc::new(PointIndex::new(super::features::sharp_vertices(&subject.mesh)));
        Self { subject, config, cameras: super::camera_path(&subject.mesh, config.frames), features, diagonal }
    }

    /// The path that a strategy gives to runs.
    pub(super) fn path(&self, strategy: StrategyKind, frame: usize) -> Path {
        match strategy {
            StrategyKind::Dual => Path::Difference,
            StrategyKind::DualDistance => Path::Distance { eye: self.cameras[frame].eye, beyond: self.diagonal * 0.5 },
            StrategyKind::Coarse => Path::Coarse,
            _ => Path::Fine,
        }
    }

    /// The wish of a frame.
    pub(super) fn query(&self, kind: CriterionKind, frame: usize) -> Query {
        let camera = &self.cameras[frame];
        let t = frame as f32 / self.config.frames.max(1) as f32;
        let screen = || ScreenError::new(camera, self.config.error_px);
        let mut limits = Limits::NONE;
        let criterion = match kind {
            // From coarse to fine, by the same factor each frame.
            CriterionKind::Uniform => {
                Wish::Uniform(UniformError { error_max: self.diagonal * 0.02 * (0.005f32).powf(t) })
            }
            CriterionKind::Region => Wish::Region(InRegion { region: self.region(t), error_max: self.diagonal * 2e-4 }),
            CriterionKind::Screen => Wish::Screen(Box::new(screen())),
            CriterionKind::Facing => {
                let criterion = Wish::Screen(Box::new(screen()));
                Wish::Facing(Box::new(Facing { eye: camera.eye, criterion }))
            }
            CriterionKind::Silhouette => {
                let [outline, elsewhere] = [0.25, 1.0]
                    .map(|share| Wish::Screen(Box::new(ScreenError::new(camera, share * self.config.error_px))));
                Wish::Silhouette(Box::new(Silhouette { eye: camera.eye, outline, elsewhere }))
            }
            CriterionKind::Moving => {
                let last = &self.cameras[frame.saturating_sub(1)];
                let speed = last.eye.distance(camera.eye);
                Wish::Moving(Box::new(Moving::new(Wish::Screen(Box::new(screen())), 20.0, speed, self.diagonal)))
            }
            CriterionKind::Features => Wish::Features(Box::new(FeaturePoints {
                points: Arc::clone(&self.features),
                error_at: self.diagonal * 1e-4 * (1.0 + 9.0 * t),
                error_max: self.diagonal * 0.01,
            })),
            CriterionKind::Visual => Wish::Visual(Box::new(VisualError {
                eye: camera.eye,
                light: glam::Vec3::new(0.3, 0.9, 0.4).normalize(),
                epsilon: 0.2,
                scale: 1e-3,
                error_min: self.diagonal * 1e-4,
                reading: Reading::Tolerance,
            })),
            CriterionKind::Budget => {
                limits.cells = Some((self.subject.mesh.cell_count() / 10) as u32);
                Wish::Screen(Box::new(ScreenError::new(camera, 0.0)))
            }
        };
        Query { criterion, limits }
    }

    /// A box of a quarter of the extent that travels through the model.
    fn region(&self, t: f32) -> Region {
        let (low, high) = self.subject.mesh.bounding_box().unwrap_or_default();
        let half = (high - low) * 0.125;
        let at = low + half + (high - low - half * 2.0) * t;
        Region { low: at - half, high: at + half }
    }
}
