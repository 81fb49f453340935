//! Orders compared on real models and terrain, as in Table 2 of the truly selective paper, and the laws on all of them.

use mt_core::check::Random;
use mt_core::format::{Format, LoadOptions, NonManifold, read};
use mt_core::hierarchy::Dependency;
use mt_core::{Hierarchy, Mesh, Replay, generate};
use mt_tests::{both_of, real_files, replay_of};
use multi_tessellation::verify::{self, Topology};
use operators::EdgeCollapse;
use operators::order::{DualPieceFree, ImplicitIds, Scheme, Stored};
use selective::{InRegion, Limits, Region, Strategy, extract};
use std::path::Path;
use std::sync::Arc;

fn load(path: &Path) -> Mesh<3> {
    load_as(path, &LoadOptions { non_manifold: NonManifold::Split, ..LoadOptions::default() })
}

fn load_as(path: &Path, options: &LoadOptions) -> Mesh<3> {
    let bytes = std::fs::read(path).expect("the file is there");
    let format = Format::from_extension(path.extension().and_then(|e| e.to_str()).unwrap_or("")).expect("a mesh");
    read(format, &bytes, options, &|_| None).expect("the file is good").0
}

/// Random fronts for each model and scheme. `MT_FRONTS` says another number; a long run is 1000.
fn fronts() -> u32 {
    std::env::var("MT_FRONTS").ok().and_then(|n| n.parse().ok()).unwrap_or(16)
}

fn judge<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D, topology: Topology) {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let options = verify::Options { fronts: fronts(), seed: 11, topology };
    let verdict = verify::hierarchy(&model, &options, &mut |_| true);
    let summary = verdict.unwrap_or_else(|found| panic!("{name}: {} ({} nodes)", found.breach, found.front.len()));
    println!("{name}: {} checks", summary.values().sum::<u64>());
}

fn laws_hold(names: &[&str], operator: &EdgeCollapse) {
    for path in real_files("surfaces", names) {
        let (_, replay) = both_of(&load(&path), operator);
        for scheme in Scheme::ALL {
            let name = format!("{} {scheme}", path.display());
            if let Some(stored) = scheme.stored(&replay).expect("a manifold") {
                judge(&name, &replay, stored, Topology::Kept);
            }
        }
        judge(&format!("{} implicit-ids", path.display()), &replay, ImplicitIds, Topology::Kept);
        judge(
            &format!("{} dual-piece-free", path.display()),
            &replay,
            DualPieceFree::new(&replay).unwrap(),
            Topology::Kept,
        );
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

#[test]
fn laws_under_every_scheme_on_fans() {
    for path in real_files("surfaces", &["rocker-arm.obj", "camelhead.off", "fandisk.obj"]) {
        let replay = replay_of(&load(&path), &"fan-merge".parse().unwrap());
        for scheme in [Scheme::OneRing, Scheme::FourFace, Scheme::DualPiece] {
            let stored = scheme.stored(&replay).expect("a manifold").expect("a static scheme");
            judge(&format!("{} fans {scheme}", path.display()), &replay, stored, Topology::Kept);
        }
        judge(&format!("{} fans implicit-ids", path.display()), &replay, ImplicitIds, Topology::Kept);
    }
}

#[test]
fn laws_on_pairs_of_what_is_no_manifold() {
    for path in real_files("surfaces", &["truck.obj", "trumpet.obj", "cycloidal.ply", "teapot.obj"]) {
        let options = LoadOptions { non_manifold: NonManifold::Keep, ..LoadOptions::default() };
        let replay = replay_of(&load_as(&path, &options), &"vertex-pair".parse().unwrap());
        for stored in [Stored::explicit(&replay), Stored::one_ring(&replay)] {
            judge(&format!("{} pairs", path.display()), &replay, stored, Topology::Coarsened);
        }
        judge(&format!("{} pairs implicit-ids", path.display()), &replay, ImplicitIds, Topology::Coarsened);
        let refused = Stored::dual_piece(&replay).expect_err("pairs are refused").to_string();
        assert!(refused.contains("merges pairs"), "{refused}");
    }
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

#[test]
fn hierarchies_are_as_small_as_they_say() {
    let mesh = generate::bumpy_sphere(5, 0.1, 3);
    let vertices = mesh.vertex_count() as f64;
    let cones = 4.0;
    let edges = both_of(&mesh, &EdgeCollapse::FULL).1;
    let fans = replay_of(&mesh, &"fan-merge".parse().unwrap());
    for (name, replay, scheme, most) in [
        ("dual-piece", &edges, Scheme::DualPiece, 64.0),
        ("four-face", &edges, Scheme::FourFace, 72.0),
        ("fan", &fans, Scheme::DualPiece, 48.0),
    ] {
        let stored = scheme.stored(replay).unwrap().unwrap();
        let bytes = (replay.bytes() + stored.bytes()) as f64 / vertices;
        println!("{name}: {bytes:.2} bytes a vertex, normal cones included");
        assert!(bytes <= most + cones, "{name}: {bytes} bytes a vertex");
        // The table leaves nothing out.
        let table: usize = replay.bytes_table().iter().map(|(_, bytes)| bytes).sum();
        assert_eq!(table, replay.bytes());
    }
}
