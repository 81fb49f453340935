//! Models that more than one paper has, and the edge collapse that all of them compare with.

use super::{Coding, Grid, Role, Size};
use mt_core::generate::{bumpy_sphere, genus_surface};
use operators::metric::{AnyMetric, Quadrics};
use operators::{AnyOperator, EdgeCollapse};

/// Full edge collapse in the order of the quadric error.
pub(crate) fn edge_collapse() -> AnyOperator {
    AnyOperator::EdgeCollapse(EdgeCollapse::FULL.with(AnyMetric::Quadric(Quadrics)))
}

pub(crate) const BUNNY: Role = Role {
    name: "Bunny",
    file: "surfaces/stanford-bunny.obj",
    grid: None,
    stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 5 }, 0.15, 9),
};

pub(crate) const COW: Role = Role {
    name: "Cow",
    file: "surfaces/cow.obj",
    grid: None,
    stand_in: |size| genus_surface(1, if size == Size::Small { 5 } else { 10 }, 0.02, 4),
};

pub(crate) const HORSE: Role = Role {
    name: "Horse",
    file: "surfaces/horse.ply",
    grid: None,
    stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 5 }, 0.2, 6),
};

/// Mount Fuji, whole or a part.
pub(crate) const fn fuji(part: Option<[usize; 4]>) -> Option<Grid> {
    Some(Grid { coding: Coding::Mapbox, part })
}
