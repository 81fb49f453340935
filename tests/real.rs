//! The laws on real models, a thousand random fronts each (`MT_FRONTS` says another number).

use mt_core::format::{Format, LoadOptions, NonManifold, read};
use mt_core::{Mesh, check};
use mt_tests::{model_of, real_files};
use multi_tessellation::verify;
use operators::EdgeCollapse;
use std::path::Path;

fn load(path: &Path, non_manifold: NonManifold) -> Mesh<3> {
    let bytes = std::fs::read(path).expect("the file is there");
    let format = Format::from_extension(path.extension().and_then(|e| e.to_str()).unwrap_or("")).expect("a mesh");
    read(format, &bytes, &LoadOptions { non_manifold, ..LoadOptions::default() }, &|_| None)
        .expect("the file is good")
        .0
}

fn fronts() -> u32 {
    std::env::var("MT_FRONTS").ok().and_then(|n| n.parse().ok()).unwrap_or(1000)
}

fn laws_hold(names: &[&str], operator: &EdgeCollapse) {
    for path in real_files("surfaces", names) {
        let mesh = load(&path, NonManifold::Split);
        let model = model_of(&mesh, operator);
        check::ends(&model, &mesh).unwrap_or_else(|breach| panic!("{}: {breach}", path.display()));
        let begun = std::time::Instant::now();
        let options = verify::Options { fronts: fronts(), seed: 2, ..verify::Options::default() };
        let summary = verify::explicit(&model, &options, &mut |_| true);
        let summary = summary.unwrap_or_else(|found| panic!("{}: {}", path.display(), found.breach));
        println!(
            "{}: {} checks in {:.1} s",
            path.display(),
            summary.values().sum::<u64>(),
            begun.elapsed().as_secs_f64()
        );
    }
}

// One test each of about the same length, so that two cores share them.

#[test]
fn laws_on_armadillo() {
    laws_hold(&["armadillo.obj"], &EdgeCollapse::FULL);
}

#[test]
fn laws_on_bunny_and_fandisk() {
    laws_hold(&["stanford-bunny.obj", "fandisk.obj"], &EdgeCollapse::FULL);
}

#[test]
fn laws_on_horse_and_teapot() {
    laws_hold(&["horse.ply", "teapot.obj"], &EdgeCollapse::FULL);
}

#[test]
fn laws_on_genus_and_boundary() {
    laws_hold(&["rocker-arm.obj", "fertility.off", "camelhead.off"], &EdgeCollapse::FULL);
}

#[test]
fn laws_on_half_edge_histories() {
    laws_hold(&["rocker-arm.obj", "camelhead.off", "fandisk.obj"], &EdgeCollapse::HALF);
}
