//! Orders compared on real models and terrain, as in Table 2 of the truly selective paper, and the laws on all of them.

use mt_core::check::Random;
use mt_core::format::{Format, LoadOptions, NonManifold, read};
use mt_core::hierarchy::Dependency;
use mt_core::{Hierarchy, Mesh, Replay, generate};
use mt_tests::{both_of, real_files};
use multi_tessellation::verify;
use operators::EdgeCollapse;
use operators::order::{DualPieceFree, ImplicitIds, Scheme};
use selective::{InRegion, Limits, Region, Strategy, extract};
use std::path::Path;
use std::sync::Arc;

fn load(path: &Path) -> Mesh<3> {
    let bytes = std::fs::read(path).expect("the file is there");
    let format = Format::from_extension(path.extension().and_then(|e| e.to_str()).unwrap_or("")).expect("a mesh");
    let options = LoadOptions { non_manifold: NonManifold::Split, ..LoadOptions::default() };
    read(format, &bytes, &options, &|_| None).expect("the file is good").0
}

/// Random fronts for each model and scheme. `MT_FRONTS` says another number; a long run is 1000.
fn fronts() -> u32 {
    std::env::var("MT_FRONTS").ok().and_then(|n| n.parse().ok()).unwrap_or(16)
}

fn judge<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D) {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let verdict = verify::hierarchy(
        &model,
        &verify::Options { fronts: fronts(), seed: 11, ..verify::Options::default() },
        &mut |_| true,
    );
    let summary = verdict.unwrap_or_else(|found| panic!("{name}: {} ({} nodes)", found.breach, found.front.len()));
    println!("{name}: {} checks", summary.values().sum::<u64>());
}

fn laws_hold(names: &[&str], operator: &EdgeCollapse) {
    for path in real_files("surfaces", names) {
        let (_, replay) = both_of(&load(&path), operator);
        for scheme in Scheme::ALL {
            let name = format!("{} {scheme}", path.display());
            if let Some(stored) = scheme.stored(&replay).expect("a manifold") {
                judge(&name, &replay, stored);
            }
        }
        judge(&format!("{} implicit-ids", path.display()), &replay, ImplicitIds);
        judge(&format!("{} dual-piece-free", path.display()), &replay, DualPieceFree::new(&replay).unwrap());
    }
}

#[test]
fn laws_under_every_scheme_on_scans() {
    laws_hold(&["stanford-bunny.obj", "horse.ply"], &EdgeCollapse::FULL);
}

#[test]
fn laws_under_every_scheme_on_boundaries_and_genus() {
    laws_hold(&["camelhead.off", "fertility.off", "teapot.obj", "fandisk.obj", "cow.obj"], &EdgeCollapse::FULL);
}

#[test]
fn laws_under_every_scheme_on_half_edge_histories() {
    laws_hold(&["rocker-arm.obj", "spot.obj", "suzanne.obj"], &EdgeCollapse::HALF);
}

/// Vertices of the mesh that is fine within a box, for each scheme.
fn vertices_in_region(replay: &Arc<Replay>, region: Region, scheme: Scheme) -> usize {
    let dependency = scheme.stored(replay).expect("a manifold").expect("a static scheme");
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let wish = InRegion { region, error_max: 0.0 };
    let (state, _) = extract(&model, &wish, &Limits::NONE, Strategy::TopDown, ());
    assert!(state.view.mesh.faces.cell_count() > 0);
    state.view.mesh.active.count() as usize
}

#[test]
fn the_schemes_come_in_the_order_of_the_paper() {
    let mut meshes = vec![("terrain".to_owned(), generate::terrain(100, 0.55, 7))];
    for path in real_files("surfaces", &["stanford-bunny.obj", "horse.ply"]) {
        meshes.push((path.display().to_string(), load(&path)));
    }
    let mut random = Random::new(4);
    for (name, mesh) in meshes {
        let (_, replay) = both_of(&mesh, &EdgeCollapse::FULL);
        let (low, high) = mesh.bounding_box().unwrap();
        let mut sums = [0; 3];
        for _ in 0..12 {
            let at = mesh.positions[random.below(mesh.positions.len())];
            let half = (high - low) * (0.03 + 0.1 * random.unit() as f32);
            let region = Region { low: at - half, high: at + half };
            let counts = [Scheme::OneRing, Scheme::FourFace, Scheme::DualPiece]
                .map(|scheme| vertices_in_region(&replay, region, scheme));
            assert!(counts[0] >= counts[1] && counts[1] >= counts[2], "{name}: {counts:?}");
            (0..3).for_each(|i| sums[i] += counts[i]);
        }
        let [ring, four, dual] = sums.map(|sum| sum as f64);
        println!("{name}: one-ring / dual-piece {:.3}, four-face / dual-piece {:.3}", ring / dual, four / dual);
        assert!(ring > four && four > dual, "{name}: {sums:?}");
    }
}
