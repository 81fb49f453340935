//! Steps a CPU second of each scheme, refining everything and coarsening it again, and where the bytes go.
//!
//! `cargo run --release -p mt-operators --example replay -- MESH [in-order|as-it-came] [SCHEME]`: with the input numbered
//! for speed, or as it came; one scheme or all.

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
    let replay = Replay::new(&mesh, &[], &sequence)?;
    println!("{} nodes, replay derived in {:.3} s", replay.len(), begun.elapsed().as_secs_f64());
    let renumber = std::env::args().nth(2).is_none_or(|word| word != "as-it-came");
    let numbering = replay.numbering();
    let replay = Arc::new(if renumber { replay.renumbered(&numbering) } else { replay });
    let vertices = mesh.vertex_count() as f64;
    for (name, bytes) in replay.bytes_table() {
        println!("{name:32} {:6.2} bytes a vertex", bytes as f64 / vertices);
    }
    println!("{:32} {:6.2}", "in all", replay.bytes() as f64 / vertices);
    let one: Option<Scheme> = std::env::args().nth(3).map(|name| name.parse()).transpose()?;
    for scheme in Scheme::ALL.into_iter().filter(|scheme| one.is_none_or(|one| one == *scheme)) {
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
    if one.is_some() {
        return Ok(());
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
    let mut best = [f64::INFINITY; 2];
    let mut stalled = 0;
    for _ in 0..5 {
        let begun = Instant::now();
        for m in (0..model.len()).rev().map(NodeId) {
            out.clear();
            model.prerequisites(m, &view, &mut out);
            assert!(out.is_empty());
            take(&model, Step::refine(m), &mut view, &mut ());
        }
        best[0] = best[0].min(begun.elapsed().as_secs_f64());
        let begun = Instant::now();
        stalled = 0;
        for m in (0..model.len()).map(NodeId) {
            out.clear();
            if model.obstacles(m, &view, &mut out) == Coarsen::Now {
                take(&model, Step::coarsen(m), &mut view, &mut ());
            } else {
                stalled += 1;
            }
        }
        best[1] = best[1].min(begun.elapsed().as_secs_f64());
        assert!(stalled == 0);
    }
    let [refine, coarsen] = best.map(|seconds| seconds / f64::from(model.len()) * 1e9);
    println!(
        "{name:20} {:6.2} M steps/s, {refine:4.0} ns to refine, {coarsen:4.0} ns to coarsen, {:6.2} bytes a vertex, base {} \
         triangles, {stalled} left",
        2e3 / (refine + coarsen),
        model.bytes() as f64 / vertices,
        model.cell_count(&view.mesh)
    );
}
