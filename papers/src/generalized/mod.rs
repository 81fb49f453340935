//! Generalized view-dependent rendering (`[ElSanaVarshney1999]`, as told in `[DeFlorianiTutorial2002]`): pairs of vertices,
//! topology, implicit dependencies, and the factors by which a hierarchy is simplified.

mod factors;
mod ids;
mod topology;

use crate::ledger::{Item, Paper, Role, Size};
use mt_core::Mesh;
use mt_core::generate::{bumpy_sphere, components, genus_surface, sharp_box};

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/generalized.json"),
    items: &[
        Item {
            id: "virtual-edges",
            title: "edges between vertices that share no triangle",
            run: topology::virtual_edges,
        },
        Item { id: "topology", title: "an assembly coarsened with its topology", run: topology::topology },
        Item { id: "implicit-ids", title: "the implicit dependency rule", run: ids::implicit_ids },
        Item { id: "factors", title: "the simplification factors", run: factors::factors },
    ],
};

const ASSEMBLIES: [Role; 2] = [
    Role { name: "truck", file: "surfaces/truck.obj", part: None, stand_in: |size| assembly(size, 3) },
    Role { name: "engine", file: "surfaces/engine.obj", part: None, stand_in: |size| assembly(size, 12) },
];

/// Boxes and spheres in a row, which do not touch.
fn assembly(size: Size, parts: usize) -> Mesh<3> {
    let (sides, level) = if size == Size::Small { (2, 1) } else { (12, 4) };
    let part = |i: usize| if i.is_multiple_of(2) { sharp_box(sides) } else { bumpy_sphere(level, 0.05, i as u64) };
    components(&(0..parts).map(part).collect::<Vec<_>>())
}

const COW: Role = Role {
    name: "cow",
    file: "surfaces/cow.obj",
    part: None,
    stand_in: |size| genus_surface(1, if size == Size::Small { 5 } else { 10 }, 0.02, 4),
};
const BUNNY: Role = Role {
    name: "bunny",
    file: "surfaces/stanford-bunny.obj",
    part: None,
    stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 5 }, 0.15, 9),
};
