use mt_core::*;
use mt_core::analysis::*;
use operators_probe::*;
mod operators_probe { pub use mt_operators::*; }
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let half = std::env::args().nth(2).as_deref() == Some("half");
    let until = std::env::args().nth(3).and_then(|s| s.parse().ok());
    let (m, _) = tobj::load_obj(&path, &tobj::LoadOptions { triangulate: true, ..Default::default() }).unwrap();
    let m = &m[0].mesh;
    let positions = m.positions.chunks(3).map(|p| glam::Vec3::from_slice(p)).collect::<Vec<_>>();
    let mesh = Mesh::<3>{ positions, cells: m.indices.chunks(3).map(|c| [c[0],c[1],c[2]].map(VertexId)).collect() };
    println!("{} v {} t", mesh.positions.len(), mesh.cells.len());
    for kind in [ErrorKind::Estimate; 8] {
    let t = std::time::Instant::now();
    let op = if half { EdgeCollapse::HALF } else { EdgeCollapse::FULL };
    let a = simplify(&mesh, &op, &Options{until_cells: until, error_kind: kind, ..Default::default()}, &mut |_| true).unwrap();
    let s = t.elapsed().as_secs_f64();
    let model = &a.model;
    println!("{:?} {:.3} s, base {} nodes {} , {:.0} k tri/s, {:?}", kind, s, model.base_cells().len(), model.len(), (mesh.cells.len()-model.base_cells().len()) as f64/s/1e3, a.stopped);
    println!("{:?}", a.refusals.iter().collect::<Vec<_>>());
    println!("bytes/v {:.1}, arcs/node {:.2}, cells {:.2}/v, depth {}", model.bytes() as f64/mesh.positions.len() as f64, model.order().arc_count() as f64/model.len() as f64, model.total_cell_count() as f64/mesh.positions.len() as f64, model.order().depth());
    let d = mesh.diagonal();
    for k in [0.5,0.9,0.99,0.999] { let i=(model.len() as f64*k) as u32; println!("  {} err {:.3e} r {:.3e}", k, model.bound(NodeId(i)).error as f64/d, model.bound(NodeId(i)).radius as f64/d); }
    }
}
