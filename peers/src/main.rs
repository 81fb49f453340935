//! Our edge collapse to the base mesh, everything recorded, against the `meshopt` crate's simplify, which records
//! nothing: triangles removed per CPU second, and the errors of both at a tenth of the triangles.
//!
//! `cargo run --release --manifest-path peers/Cargo.toml -- [MESH ...]`; without a mesh, a generated surface of a million
//! triangles. The runs alternate, so that a noisy machine is noisy for both; ratios are of medians.

use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, typed_to_bytes};
use mt_core::analysis;
use mt_core::format::{Format, LoadOptions, read};
use mt_core::model::mesh_of;
use mt_core::{Mesh, VertexId, generate};
use operators::EdgeCollapse;
use papers::distance::{Sampling, Surface};
use selective::{Limits, Strategy, UniformError, extract};
use std::path::Path;

const RUNS: usize = 5;
/// The share of triangles at which errors are compared, and to which meshopt simplifies.
const SHARE: f64 = 0.1;

fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    if paths.is_empty() {
        compare("generated, genus 2", &generate::genus_surface(2, 100, 0.05, 7));
    }
    for path in paths {
        match load(Path::new(&path)) {
            Ok(mesh) => compare(&path, &mesh),
            Err(error) => {
                eprintln!("error: {path}: {error}");
                std::process::exit(1);
            }
        }
    }
}

fn load(path: &Path) -> Result<Mesh<3>, String> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let format = Format::from_extension(ending).ok_or("the ending tells no format")?;
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    Ok(read(format, &bytes, &LoadOptions::default(), &|_| None).map_err(|error| error.to_string())?.0)
}

fn compare(name: &str, mesh: &Mesh<3>) {
    let target = (mesh.cell_count() as f64 * SHARE) as usize;
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let mut meshes = None;
    for _ in 0..RUNS {
        let begun = cpu();
        let simplified = theirs_at(mesh, target);
        theirs.push((mesh.cell_count() - simplified.cell_count()) as f64 / (cpu() - begun));
        let begun = cpu();
        let analysis = analysis::simplify(mesh, &EdgeCollapse::FULL, &Default::default(), &mut |_| true);
        let model = match analysis {
            Ok(analysis) => analysis.model,
            Err(error) => return eprintln!("error: {name}: {error}"),
        };
        ours.push((mesh.cell_count() - model.base_cells().len()) as f64 / (cpu() - begun));
        meshes = Some((model, simplified));
    }
    let Some((model, simplified)) = meshes else { return };
    let limits = Limits { cells: Some(target as u32), time: None };
    let (state, _) = extract(&model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ());
    let extracted = mesh_of(&model, &state.view.mesh);
    let (ours, theirs) = (median(ours), median(theirs));
    println!("{name}: {} triangles", mesh.cell_count());
    println!(
        "  ours, to {:>8} and all recorded: {:>6.0} thousand triangles a CPU second",
        model.base_cells().len(),
        ours / 1e3
    );
    println!(
        "  meshopt, to {:>5}, nothing kept:  {:>6.0} thousand triangles a CPU second",
        simplified.cell_count(),
        theirs / 1e3
    );
    println!("  ratio {:.2}", ours / theirs);
    let Ok(surface) = Surface::new(mesh) else { return };
    for (who, other) in [("ours", &extracted), ("meshopt", &simplified)] {
        let Ok(other_surface) = Surface::new(other) else { continue };
        let apart = other_surface.distance(&surface, Sampling::default());
        let (rms, maximum) = (apart.rms() / mesh.diagonal(), apart.maximum() / mesh.diagonal());
        println!(
            "  {who:8} at {:>6} triangles: RMS {rms:.2e}, maximum {maximum:.2e} of the diagonal",
            other.cell_count()
        );
    }
}

fn theirs_at(mesh: &Mesh<3>, target: usize) -> Mesh<3> {
    let indices: Vec<u32> = mesh.cells.iter().flatten().map(|v| v.0).collect();
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let adapter = VertexDataAdapter::new(typed_to_bytes(&positions), 12, 0).expect("positions are 12 bytes each");
    let simplified = simplify(&indices, &adapter, target * 3, f32::MAX, SimplifyOptions::None, None);
    let cells = simplified.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(VertexId)).collect();
    Mesh { positions: mesh.positions.clone(), cells }.compact()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn cpu() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
