//! Steps a CPU second of each scheme, refining everything and coarsening it again, and where the bytes go.
//!
//! `cargo run --release -p mt-operators --example replay -- MESH.obj`

use mt_core::analysis::{Options, analyse};
use mt_core::hierarchy::Dependency;
use mt_core::model::{MultiTessellation, Step, take};
use mt_core::{Coarsen, Hierarchy, NodeId, Replay, Sequence};
use mt_operators::EdgeCollapse;
use mt_operators::order::{DualPieceFree, ImplicitIds, Scheme, StoredIds};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("which mesh?")?;
    let bytes = std::fs::read(&path)?;
    let format =
        mt_core::format::Format::from_extension(path.rsplit('.').next().unwrap_or("")).ok_or("which format?")?;
    let (mesh, _) = mt_core::format::read(format, &bytes, &Default::default(), &|_| None)?;
    let mut sequence = Sequence::new(&mesh);
    analyse(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut sequence, &mut |_| true)?;
    let begun = Instant::now();
    let replay = Arc::new(Replay::new(&mesh, &[], &sequence)?);
    println!("{} nodes, replay derived in {:.3} s", replay.len(), begun.elapsed().as_secs_f64());
    let vertices = mesh.vertex_count() as f64;
    for (name, bytes) in replay.bytes_table() {
        println!("{name:32} {:6.2} bytes a vertex", bytes as f64 / vertices);
    }
    println!("{:32} {:6.2}", "in all", replay.bytes() as f64 / vertices);
    for scheme in Scheme::ALL {
        let begun = Instant::now();
        if let Some(stored) = scheme.stored(&replay)? {
            println!(
                "{scheme}: {} needs beyond the forest, derived in {:.3} s",
                stored.needs_rows().entry_count(),
                begun.elapsed().as_secs_f64()
            );
            time(scheme.name(), &replay, stored, vertices);
        }
    }
    time("implicit-ids", &replay, ImplicitIds, vertices);
    time("implicit-ids-stored", &replay, StoredIds::new(&replay)?, vertices);
    time("dual-piece-free", &replay, DualPieceFree::new(&replay)?, vertices);
    Ok(())
}

fn time<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D, vertices: f64) {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let mut view = model.base_view();
    let mut out = Vec::new();
    let mut best = f64::INFINITY;
    let mut stalled = 0;
    for _ in 0..5 {
        let begun = Instant::now();
        for m in (0..model.len()).rev().map(NodeId) {
            out.clear();
            model.prerequisites(m, &view, &mut out);
            assert!(out.is_empty());
            take(&model, Step::refine(m), &mut view, &mut ());
        }
        stalled = 0;
        for m in (0..model.len()).map(NodeId) {
            out.clear();
            if model.obstacles(m, &view, &mut out) == Coarsen::Now {
                take(&model, Step::coarsen(m), &mut view, &mut ());
            } else {
                stalled += 1;
            }
        }
        best = best.min(begun.elapsed().as_secs_f64());
        assert!(stalled == 0);
    }
    let steps = 2.0 * f64::from(model.len());
    println!(
        "{name:20} {:6.2} M steps/s, {:4.0} ns a step, {:6.2} bytes a vertex, base {} triangles, {stalled} left",
        steps / best / 1e6,
        best / steps * 1e9,
        model.bytes() as f64 / vertices,
        model.cell_count(&view.mesh)
    );
}
