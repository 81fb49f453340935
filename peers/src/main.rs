//! Our edge collapse to the base mesh, everything recorded, against the `meshopt` crate's simplify, which records
//! nothing: triangles removed per CPU second, and the errors of both at a tenth of the triangles.
//!
//! `cargo run --release --manifest-path peers/Cargo.toml -- [MESH ...]`; without a mesh, a generated surface of a million
//! triangles. The runs alternate, so that a noisy machine is noisy for both; ratios are of medians.

use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, typed_to_bytes};
use mt_core::analysis::{RegionListener, Regions, analyse, analyse_by_regions};
use mt_core::format::{Format, LoadOptions, read};
use mt_core::model::mesh_of;
use mt_core::{ErrorKind, Explicit, Mesh, NodeId, Recorder, Replay, Sequence, VertexId, generate};
use operators::EdgeCollapse;
use operators::order::Stored;
use papers::distance::{Sampling, Surface};
use selective::{Limits, Strategy, UniformError, extract};
use std::error::Error;
use std::path::Path;

const RUNS: usize = 5;
/// The share of triangles at which errors are compared, and to which meshopt simplifies.
const SHARE: f64 = 0.1;

fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let named = |path: &str| load(Path::new(path)).and_then(|mesh| compare(path, &mesh));
    let told = |path: &str, told: Result<(), Box<dyn Error>>| {
        if let Err(error) = told {
            eprintln!("error: {path}: {error}");
            std::process::exit(1);
        }
    };
    if paths.is_empty() {
        told("generated", compare("generated, genus 2", &generate::genus_surface(2, 100, 0.05, 7)));
    }
    paths.iter().for_each(|path| told(path, named(path)));
}

fn load(path: &Path) -> Result<Mesh<3>, Box<dyn Error>> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let format = Format::from_extension(ending).ok_or("the ending tells no format")?;
    Ok(read(format, &std::fs::read(path)?, &LoadOptions::default(), &|_| None)?.0)
}

/// A way to make all of it, timed: the triangles that were removed.
type Way = (&'static str, fn(&Mesh<3>) -> Result<usize, Box<dyn Error>>);

/// The hierarchy is replay and dual-piece order; cells are the explicit model with its order and bounds.
const WAYS: [Way; 4] = [
    ("hierarchy", |mesh| hierarchy(mesh, None)),
    ("hierarchy, by regions", |mesh| hierarchy(mesh, Some(ONE_THREAD))),
    ("cells", |mesh| Ok(mesh.cell_count() - cells(mesh, None)?.base_cells().len())),
    ("cells, by regions", |mesh| Ok(mesh.cell_count() - cells(mesh, Some(ONE_THREAD))?.base_cells().len())),
];

const ONE_THREAD: Regions = Regions { vertices: 2048, threads: 1 };

fn coarsen(mesh: &Mesh<3>, regions: Option<Regions>, heard: &mut impl RegionListener<3>) -> Result<(), Box<dyn Error>> {
    let (operator, options) = (EdgeCollapse::FULL, Default::default());
    match regions {
        None => analyse(mesh, &operator, &options, heard, &mut |_| true)?,
        Some(regions) => analyse_by_regions(mesh, &operator, &options, &regions, heard, &mut |_| true)?,
    };
    Ok(())
}

fn hierarchy(mesh: &Mesh<3>, regions: Option<Regions>) -> Result<usize, Box<dyn Error>> {
    let mut sequence = Sequence::new(mesh);
    coarsen(mesh, regions, &mut sequence)?;
    let replay = Replay::new(mesh, &[], &sequence)?;
    Stored::dual_piece(&replay)?;
    Ok((0..replay.len()).map(|m| replay.born(NodeId(m)).len()).sum())
}

fn cells(mesh: &Mesh<3>, regions: Option<Regions>) -> Result<Explicit<3>, Box<dyn Error>> {
    let mut recorder = Recorder::new(mesh)?;
    coarsen(mesh, regions, &mut recorder)?;
    Ok(recorder.finish(ErrorKind::Estimate)?)
}

fn compare(name: &str, mesh: &Mesh<3>) -> Result<(), Box<dyn Error>> {
    let target = (mesh.cell_count() as f64 * SHARE) as usize;
    println!("{name}: {} triangles; thousands removed per CPU second, medians of {RUNS}", mesh.cell_count());
    let mut rates = vec![Vec::new(); WAYS.len() + 1];
    for _ in 0..RUNS {
        let begun = cpu();
        let left = theirs_at(mesh, target).cell_count();
        rates[WAYS.len()].push((mesh.cell_count() - left) as f64 / (cpu() - begun));
        for ((_, way), rates) in WAYS.iter().zip(&mut rates) {
            let begun = cpu();
            let removed = way(mesh)?;
            rates.push(removed as f64 / (cpu() - begun));
        }
    }
    let rates: Vec<f64> = rates.into_iter().map(median).collect();
    let theirs = rates[WAYS.len()];
    for ((title, _), rate) in WAYS.iter().zip(&rates) {
        println!("  {title:24} to the base, all recorded: {:>6.0}, {:.2} times meshopt", rate / 1e3, rate / theirs);
    }
    println!("  {:24} to a tenth, nothing kept:  {:>6.0}", "meshopt", theirs / 1e3);
    let surface = Surface::new(mesh)?;
    let tell = |who: &str, other: &Mesh<3>| -> Result<(), Box<dyn Error>> {
        let apart = Surface::new(other)?.distance(&surface, Sampling::default());
        let (rms, maximum) = (apart.rms() / mesh.diagonal(), apart.maximum() / mesh.diagonal());
        println!("  {who:24} {} triangles: RMS {rms:.2e}, maximum {maximum:.2e} of the diagonal", other.cell_count());
        Ok(())
    };
    tell("as a whole", &at(&cells(mesh, None)?, target))?;
    tell("by regions", &at(&cells(mesh, Some(ONE_THREAD))?, target))?;
    tell("meshopt", &theirs_at(mesh, target))
}

/// The mesh of least error with so many triangles.
fn at(model: &Explicit<3>, target: usize) -> Mesh<3> {
    let limits = Limits { cells: Some(target as u32), time: None };
    let (state, _) = extract(model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ());
    mesh_of(model, &state.view.mesh)
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
