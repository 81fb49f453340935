//! Generalized view-dependent rendering (`[ElSanaVarshney1999]`, as told in `[DeFlorianiTutorial2002]`): pairs of vertices,
//! topology, implicit dependencies, and the factors by which a hierarchy is simplified.

mod factors;
mod ids;
mod topology;

pub(crate) use ids::allowed;

use crate::ledger::{Item, Paper, Role, Size};
use mt_core::Mesh;
use mt_core::generate::{bumpy_sphere, components, sharp_box};

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
    Role { name: "truck", file: "surfaces/truck.obj", grid: None, stand_in: |size| assembly(size, 3) },
    Role { name: "engine", file: "surfaces/engine.obj", grid: None, stand_in: |size| assembly(size, 12) },
];

/// Boxes and spheres in a row, which do not touch.
fn assembly(size: Size, parts: usize) -> Mesh<3> {
    let (sides, level) = if size == Size::Small { (2, 1) } else { (12, 4) };
    let part = |i: usize| if i.is_multiple_of(2) { sharp_box(sides) } else { bumpy_sphere(level, 0.05, i as u64) };
    components(&(0..parts).map(part).collect::<Vec<_>>())
}
