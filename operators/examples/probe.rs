//! Builds the model of an OBJ file eight times, and tells how long it took and what came out.
//!
//! `cargo run --release --example probe -- FILE [half|full] [CELLS]`: half-edge or full edge collapses, down to so many
//! cells.

use mt_core::analysis::{Analysis, Options, simplify};
use mt_core::{ErrorKind, Mesh, MultiTessellation, NodeId};
use mt_operators::EdgeCollapse;
use std::time::Instant;

const TIMES: usize = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else {
        eprintln!("usage: probe FILE [half|full] [CELLS]");
        std::process::exit(2);
    };
    let half = arguments.get(1).is_some_and(|kind| kind == "half");
    let operator = if half { EdgeCollapse::HALF } else { EdgeCollapse::FULL };
    let until_cells = arguments.get(2).and_then(|text| text.parse().ok());
    let options = Options { until_cells, error_kind: ErrorKind::Estimate, ..Options::default() };
    let mesh = load(path);
    println!("{} vertices, {} triangles", mesh.vertex_count(), mesh.cell_count());
    for _ in 0..TIMES {
        let begun = Instant::now();
        let analysis = simplify(&mesh, &operator, &options, &mut |_| true).expect("a manifold");
        tell(&mesh, &analysis, begun.elapsed().as_secs_f64());
    }
}

/// The first object of the file, as it is.
fn load(path: &str) -> Mesh<3> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (objects, _) = tobj::load_obj(path, &options).expect("an OBJ file");
    let object = &objects.first().expect("an object").mesh;
    let positions = object.positions.chunks_exact(3).map(glam::Vec3::from_slice).collect();
    Mesh::from_indices(positions, object.indices.as_chunks().0)
}

fn tell(mesh: &Mesh<3>, analysis: &Analysis<3>, seconds: f64) {
    let model = &analysis.model;
    let [vertices, nodes] = [mesh.vertex_count() as f64, f64::from(model.len())];
    let rate = (mesh.cell_count() - model.base_cells().len()) as f64 / seconds / 1e3;
    println!("{seconds:.3} s, {rate:.0} thousand triangles a second, stopped: {:?}", analysis.stopped);
    println!("  {} base cells, {nodes} nodes, depth {}", model.base_cells().len(), model.order().depth());
    println!("  refusals {:?}", analysis.refusals.iter().collect::<Vec<_>>());
    println!(
        "  {:.1} bytes and {:.2} cells an input vertex, {:.2} arcs a node",
        model.bytes() as f64 / vertices,
        f64::from(model.total_cell_count()) / vertices,
        model.order().arc_count() as f64 / nodes
    );
    for share in [0.5, 0.9, 0.99, 0.999] {
        let bound = model.bound(NodeId((nodes * share) as u32));
        let [error, radius] = [bound.error, bound.radius].map(|x| f64::from(x) / mesh.diagonal());
        println!("  at {share} of the nodes: error {error:.3e}, radius {radius:.3e} of the diagonal");
    }
}
