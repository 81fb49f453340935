//! Every metric with full and half-edge collapse: how far the mesh of a tenth of the triangles is from the input.
//!
//! `cargo run --release -p mt-papers --example metrics -- FILE [SHARE]`: any mesh file that can be read. Distances are in
//! diagonals; `stated` is the largest error recorded up to there.

use mt_core::analysis::{Options, simplify};
use mt_core::format::{Format, LoadOptions, read};
use mt_core::model::mesh_of;
use mt_core::{Mesh, MultiTessellation, NodeId};
use mt_papers::distance::{Sampling, Surface};
use operators::EdgeCollapse;
use operators::metric::{AnyMetric, Metric};
use std::path::Path;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first().map(Path::new) else {
        eprintln!("usage: metrics FILE [SHARE]");
        std::process::exit(2);
    };
    let share: f64 = arguments.get(1).and_then(|text| text.parse().ok()).unwrap_or(0.1);
    let format = path.extension().and_then(|e| e.to_str()).and_then(Format::from_extension).expect("a known ending");
    let bytes = std::fs::read(path).expect("a file");
    let mesh = read(format, &bytes, &LoadOptions::default(), &|_| None).expect("a mesh").0;
    let surface = Surface::new(&mesh).expect("triangles");
    println!("{} triangles", mesh.cell_count());
    for (kind, operator) in [("full", EdgeCollapse::FULL), ("half", EdgeCollapse::HALF)] {
        for metric in AnyMetric::ALL {
            tell(&mesh, &surface, kind, &operator.with(metric.clone()), share);
        }
    }
}

fn tell(mesh: &Mesh<3>, surface: &Surface, kind: &str, operator: &EdgeCollapse<AnyMetric>, share: f64) {
    let target = (mesh.cell_count() as f64 * share) as u32;
    let begun = Instant::now();
    let options = Options { until_cells: Some(target), ..Options::default() };
    let model = simplify(mesh, operator, &options, &mut |_| true).expect("a manifold").model;
    let seconds = begun.elapsed().as_secs_f64();
    let coarse = mesh_of(&model, &model.base());
    let stated = (0..model.len()).map(|m| model.bound(NodeId(m)).error).fold(0.0, f32::max);
    let apart = Surface::new(&coarse).expect("triangles").distance(surface, Sampling::default());
    println!(
        "{kind} {:20} {:7} triangles in {seconds:5.2} s: RMS {:.2e}, maximum {:.2e}, stated {:.2e}",
        operator.metric.name(),
        coarse.cell_count(),
        apart.rms() / mesh.diagonal(),
        apart.maximum() / mesh.diagonal(),
        f64::from(stated) / mesh.diagonal()
    );
}
