//! Coarsens a mesh by fans and tells where full fans stall, what came after, and how long it took beside edge collapse.
//!
//! `cargo run --release --example fans -- FILE [TIMES] [levels|quality|speed|edges|stop]`, a mesh in any format that can be read.

use mt_core::analysis::{Draft, Ended, Listener, Operator, Options, Stopped, analyse, simplify};
use mt_core::explicit::HistoryError;
use mt_core::format::{Format, LoadOptions, NonManifold, read};
use mt_core::{ErrorKind, Mesh, MultiTessellation, NodeId, Plan, Slot};
use mt_operators::edge_collapse::EdgeCollapse;
use mt_operators::fan_merge::{FanMerge, FanTally, Planes};
use std::time::Instant;

/// Hears nothing, so that analysis alone is timed.
struct Deaf;

impl Listener<3> for Deaf {
    fn applying(&mut self, _: &Draft<3>, _: &Plan<3>) -> Result<(), HistoryError> {
        Ok(())
    }
    fn applied(&mut self, _: &mut Draft<3>, _: &Plan<3>, _: &[Slot]) -> Result<(), HistoryError> {
        Ok(())
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else {
        eprintln!("usage: fans FILE [TIMES] [levels|quality|speed|edges|stop]");
        std::process::exit(2);
    };
    let times = arguments.get(1).and_then(|text| text.parse().ok()).unwrap_or(3);
    let mesh = load(path);
    println!("{} vertices, {} triangles", mesh.vertex_count(), mesh.cell_count());
    match arguments.get(2).map(String::as_str) {
        Some("levels") => levels(&mesh),
        Some("quality") => quality(&mesh),
        Some("speed") => speed(&mesh, times),
        Some("edges") => (0..times).for_each(|_| _ = run(&mesh, &EdgeCollapse::FULL, None, &mut Deaf)),
        Some("stop") => (0..times).for_each(|_| _ = run(&mesh, &FanMerge::STOP, None, &mut Deaf)),
        _ => {
            levels(&mesh);
            quality(&mesh);
            speed(&mesh, times);
        }
    }
}

/// The file's mesh, split where it is not a manifold.
fn load(path: &str) -> Mesh<3> {
    let extension = path.rsplit('.').next().unwrap_or_default();
    let format = Format::from_extension(extension).expect("a known extension");
    let bytes = std::fs::read(path).expect("a file that can be read");
    let options = LoadOptions { non_manifold: NonManifold::Split, ..LoadOptions::default() };
    read(format, &bytes, &options, &|_| None).expect("a mesh").0
}

/// Where full fans stall, and the base meshes, for each way on.
fn levels(mesh: &Mesh<3>) {
    let free = FanMerge { fold_cosine: -1.0, ..FanMerge::STOP };
    let cases = [
        ("stop", FanMerge::STOP),
        ("stop, any turn", free),
        ("stop, turn below 90", FanMerge { fold_cosine: 0.0, ..free }),
        ("stop, by degree", FanMerge { weigh_degree: true, ..FanMerge::STOP }),
        ("stop, any, degree", FanMerge { weigh_degree: true, ..free }),
        ("stop, current", FanMerge { planes: Planes::Current, ..FanMerge::STOP }),
        ("partial", FanMerge::PARTIAL),
        ("partial, current", FanMerge { planes: Planes::Current, ..FanMerge::PARTIAL }),
        ("collapse", FanMerge::COLLAPSE),
    ];
    for (name, fan) in cases {
        let mut tally = FanTally::new(mesh);
        let input = tally.vertices as f64;
        let ended = run(mesh, &fan, None, &mut tally);
        let stall = tally.stalled_at.unwrap_or(tally.vertices) as f64;
        println!(
            "{name:20} stall {:.2} %, {} full of {:.2} children, {} partial of {:.2}, {} single, most {}, {} vertices left",
            100.0 * stall / input,
            tally.full,
            tally.full_children_mean(),
            tally.partial,
            tally.partial_children as f64 / tally.partial as f64,
            tally.single,
            tally.children_max,
            tally.vertices,
        );
        println!("{:20} {:?}", "", ended.refusals.iter().collect::<Vec<_>>());
    }
}

fn run(
    mesh: &Mesh<3>,
    operator: &impl Operator<3>,
    until_cells: Option<u32>,
    listener: &mut impl Listener<3>,
) -> Ended {
    let options = Options { until_cells, ..Options::default() };
    analyse(mesh, operator, &options, listener, &mut |_| true).expect("a manifold")
}

/// The largest measured error at a tenth and a hundredth of the triangles.
fn quality(mesh: &Mesh<3>) {
    let fan = FanMerge::PARTIAL;
    let measured = |name: &str, operator: &dyn Fn(&Options) -> (f32, usize)| {
        let shares = [5, 20, 100].map(|share| {
            let until_cells = Some((mesh.cell_count() / share) as u32);
            operator(&Options { until_cells, error_kind: ErrorKind::Measured, ..Options::default() })
        });
        let told = shares.map(|(error, cells)| format!("{:.3e} at {cells}", f64::from(error) / mesh.diagonal()));
        println!("{name:20} measured error, of the diagonal: {}", told.join(", "));
    };
    measured("full edge", &|options| worst(mesh, &EdgeCollapse::FULL, options));
    measured("half edge", &|options| worst(mesh, &EdgeCollapse::HALF, options));
    measured("fans, accumulated", &|options| worst(mesh, &fan, options));
    measured("fans, current", &|options| worst(mesh, &FanMerge { planes: Planes::Current, ..fan }, options));
    measured("fans, by degree", &|options| worst(mesh, &FanMerge { weigh_degree: true, ..fan }, options));
    measured("fans, then single", &|options| worst(mesh, &FanMerge::COLLAPSE, options));
}

fn worst(mesh: &Mesh<3>, operator: &impl Operator<3>, options: &Options) -> (f32, usize) {
    let model = simplify(mesh, operator, options, &mut |_| true).expect("a manifold").model;
    let error = (0..model.len()).map(|m| model.bound(NodeId(m)).error).fold(0.0, f32::max);
    (error, model.base_cells().len())
}

fn speed(mesh: &Mesh<3>, times: usize) {
    let mut tally = FanTally::new(mesh);
    run(mesh, &FanMerge::STOP, None, &mut tally);
    let at = (mesh.cell_count() as f64 * tally.vertices as f64 / mesh.vertex_count() as f64) as u32;
    let cases: [(&str, &dyn Fn() -> Stopped); 7] = [
        ("edge collapse to its base", &|| run(mesh, &EdgeCollapse::FULL, None, &mut Deaf).stopped),
        ("half edges to their base", &|| run(mesh, &EdgeCollapse::HALF, None, &mut Deaf).stopped),
        ("edge collapse to the stall", &|| run(mesh, &EdgeCollapse::FULL, Some(at), &mut Deaf).stopped),
        ("full fans to 1.02 of the stall", &|| run(mesh, &FanMerge::PARTIAL, Some(at + at / 50), &mut Deaf).stopped),
        ("full fans until none is left", &|| run(mesh, &FanMerge::STOP, None, &mut Deaf).stopped),
        ("fans to their base, partial", &|| run(mesh, &FanMerge::PARTIAL, None, &mut Deaf).stopped),
        ("fans to their base, single", &|| run(mesh, &FanMerge::COLLAPSE, None, &mut Deaf).stopped),
    ];
    // In turns, so that whatever else the machine does falls on all of them; the least of each counts.
    let mut seconds = [f64::INFINITY; 7];
    for _ in 0..times {
        for (least, (_, work)) in seconds.iter_mut().zip(cases) {
            let begun = Instant::now();
            work();
            *least = least.min(begun.elapsed().as_secs_f64());
        }
    }
    for ((name, _), time) in cases.iter().zip(seconds) {
        println!("{name:30} {time:.4} s, edge collapse takes {:.2} times that", seconds[0] / time);
    }
}
