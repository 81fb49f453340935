//! Fan hierarchies (`[LivnySokolovskyElSana2006]`): fans against single edges, on the models that stand for the paper's.
//!
//! The rival, the view-dependence tree of `[ElSanaVarshney1999]`, is ours: full edge collapses in the order of the quadric
//! error, without virtual edges. Both hierarchies keep to implicit ids, as in the paper.

mod adapting;
mod anomalies;
mod construction;
mod degrees;
mod pictures;

use crate::ledger::{Item, LedgerError, Paper, Role, Size, Subject, Workshop, edge_collapse, fuji};
use mt_core::generate::{bumpy_sphere, components, genus_surface, terrain};
use mt_core::{Hierarchy, Mesh};
use operators::order::ImplicitIds;
use operators::{AnyOperator, FanMerge};
use std::sync::Arc;

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/fan-hierarchy.json"),
    items: &[
        Item { id: "table-1", title: "preprocessing time", run: construction::table_1 },
        Item { id: "table-2", title: "size of the hierarchies", run: construction::table_2 },
        Item { id: "depth", title: "depth and pointers", run: construction::depth },
        Item { id: "table-3", title: "adaptive operations and time", run: adapting::table_3 },
        Item { id: "figure-3", title: "vertex degrees along the simplification", run: degrees::figure_3 },
        Item { id: "figure-8", title: "distribution of operations, armadillo", run: pictures::figure_8 },
        Item { id: "figure-9", title: "distribution of operations, dragon", run: pictures::figure_9 },
        Item { id: "figure-10", title: "three speeds of flight over the terrain", run: pictures::figure_10 },
        Item { id: "anomalies", title: "what we noticed in the paper", run: anomalies::run },
    ],
};

const TERRAIN: Role = Role {
    name: "Terrain",
    file: "terrain/fuji.png",
    grid: fuji(None),
    stand_in: |size| terrain(if size == Size::Small { 24 } else { 160 }, 0.55, 7),
};
const ARMADILLO: Role = Role {
    name: "Armadillo",
    file: "surfaces/armadillo.obj",
    grid: None,
    stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 6 }, 0.15, 3),
};
const DRAGON: Role = Role {
    name: "A. Dragon",
    file: "surfaces/dragon_vrip_res2.ply",
    grid: None,
    stand_in: |size| genus_surface(3, if size == Size::Small { 5 } else { 18 }, 0.02, 5),
};

/// The models of the tables.
const ROLES: [Role; 6] = [
    TERRAIN,
    Role {
        name: "Hand",
        file: "surfaces/hand.obj",
        grid: None,
        stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 5 }, 0.1, 1),
    },
    Role {
        name: "Buddha",
        file: "surfaces/buddha.obj",
        grid: None,
        stand_in: |size| genus_surface(2, if size == Size::Small { 5 } else { 16 }, 0.02, 2),
    },
    Role { name: "Scene", file: "surfaces/cycloidal.ply", grid: None, stand_in: scene },
    DRAGON,
    ARMADILLO,
];

/// Several objects of several kinds.
fn scene(size: Size) -> Mesh<3> {
    let level = if size == Size::Small { 2 } else { 4 };
    let parts: Vec<Mesh<3>> = (0..8).map(|seed| bumpy_sphere(level, 0.1 + 0.02 * seed as f32, seed)).collect();
    components(&parts)
}

fn fans() -> AnyOperator {
    AnyOperator::FanMerge(FanMerge::PARTIAL)
}

/// A model of the paper with both hierarchies.
struct Both {
    subject: Arc<Subject>,
    fan: Hierarchy<ImplicitIds>,
    tree: Hierarchy<ImplicitIds>,
    /// Wall seconds to make each, replay included.
    seconds: [f64; 2],
}

fn both(workshop: &mut Workshop<'_>, role: &Role) -> Result<Both, LedgerError> {
    let subject = workshop.subject(role)?;
    let [fan, tree] = [fans(), edge_collapse()].map(|operator| workshop.sequence(&subject, &operator));
    let (fan, tree) = (fan?, tree?);
    let seconds = [&fan, &tree].map(|made| made.seconds + made.seconds_replay);
    let hierarchy = |replay| Hierarchy { replay, dependency: ImplicitIds };
    Ok(Both { subject, fan: hierarchy(fan.replay), tree: hierarchy(tree.replay), seconds })
}

/// The slope of a line through points of logarithms: 1 where the one grows as the other.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let (along, square) =
        logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x) * (p.0 - x)));
    along / square
}

/// The least and the largest of some numbers, as a text of so many digits.
fn range(values: &[f64], digits: usize) -> String {
    let (low, high) = ends(values);
    format!("{low:.digits$} to {high:.digits$}")
}

fn ends(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}
