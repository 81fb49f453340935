//! A family of small meshes, and the histories of at most 18 modifications that operators make of them.

use mt_core::analysis::{Options, simplify};
use mt_core::{Explicit, Mesh, MultiTessellation, generate};
use mt_tests::{History, VertexIntoNeighbour};

/// Modifications of the largest model: all sets of them are tried.
pub const NODES_MAX: u32 = 18;

/// Operators of triangles by name.
pub const OPERATORS: [&str; 5] =
    ["edge-collapse", "half-edge-collapse", "fan-merge", "vertex-pair", "edge-collapse/edge-length"];

/// Vertices of the largest mesh, so that histories end before they are too long, or nearly.
const VERTICES_MAX: usize = 20;

/// Small meshes of every kind there is a generator of, and some at random.
pub fn meshes() -> Vec<(String, Mesh<3>)> {
    let named = |name: &str, mesh| (name.to_owned(), mesh);
    let mut meshes = vec![
        named("tetrahedron", generate::tetrahedron()),
        named("octahedron", generate::octahedron()),
        named("icosahedron", generate::icosahedron()),
        named("cube", generate::sharp_box(1)),
        named("hourglass", generate::hourglass()),
        named("fan3", generate::fan3()),
        named("two", generate::components(&[generate::octahedron(), generate::grid(2, 2)])),
    ];
    for n in 1..=4 {
        meshes.push((format!("bumpy grid {n}"), generate::bumpy_grid(n, 3, 0.3, n as u64)));
        meshes.push((format!("flat grid {n}"), generate::grid(n, 2)));
        meshes.push((format!("annulus {n}"), generate::annulus(n + 2, 1)));
        meshes.push((format!("cylinder {n}"), generate::cylinder(n + 2, 2)));
        meshes.push((format!("torus {n}"), generate::torus(n + 2, 3)));
        meshes.push((format!("moebius {n}"), generate::moebius(n + 4)));
        meshes.push((format!("strip {n}"), generate::strip(3 * n)));
    }
    let random = (0..).map(|seed| (seed, generate::random_mesh(seed)));
    let small = random.filter(|(_, named)| (4..=VERTICES_MAX).contains(&named.mesh.vertex_count()));
    meshes.extend(small.map(|(seed, named)| (format!("{} {seed}", named.name), named.mesh)).take(12));
    meshes.retain(|(_, mesh)| mesh.vertex_count() <= VERTICES_MAX);
    meshes
}

/// The longest of these that has at most so many modifications: what is left after fewer and fewer triangles.
fn longest<T>(cells: usize, make: impl Fn(Options) -> Option<T>, nodes: impl Fn(&T) -> u32) -> Option<T> {
    let made = (0..=cells as u32).rev().map_while(|until| {
        let made = make(Options { until_cells: Some(until), ..Options::default() })?;
        (nodes(&made) <= NODES_MAX).then_some(made)
    });
    made.last()
}

/// The history that an operator makes of a mesh, as far as it is small; `None` where it does not take the mesh.
pub fn history(mesh: &Mesh<3>, operator: &str) -> Option<History> {
    let operator = operator.parse().expect("an operator");
    longest(mesh.cell_count(), |options| History::new(mesh, &operator, &options), |made| made.sequence.node_count())
}

/// Histories of boxes of tetrahedra.
pub fn tetrahedral() -> Vec<(String, Explicit<4>)> {
    let model = |layers: usize| {
        let mesh = generate::tetrahedral_box(layers);
        let make = |options| Some(simplify(&mesh, &VertexIntoNeighbour, &options, &mut |_| true).ok()?.model);
        (format!("box of {layers}"), longest(mesh.cell_count(), make, Explicit::len).expect("a box is taken"))
    };
    [2, 3, 4].map(model).into()
}
