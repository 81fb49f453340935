//! Draws the laws for the guide (`mt_core::guide`): each drawing is made of a real model, and what is wrong in it is a
//! planted fault. `cargo run --example laws` writes the drawings into `mt-core/src/guide`.

mod cells;
mod orders;
mod pen;
mod steps;
mod subject;
mod vertices;

use pen::Drawing;
use std::path::PathBuf;
use subject::Subject;

/// The drawings, by the names of the laws.
fn drawings() -> Vec<(&'static str, Drawing)> {
    let subject = Subject::new();
    vec![
        ("model", cells::model(&subject)),
        ("conformity", cells::conformity(&subject)),
        ("cells", cells::cells(&subject)),
        ("crack-freeness", cells::crack_freeness(&subject)),
        ("inverse", steps::inverse(&subject)),
        ("front-determines-mesh", steps::front_determines_mesh(&subject)),
        ("ends", steps::ends(&subject)),
        ("determinism", steps::determinism(&subject)),
        ("conduct", steps::conduct(&subject)),
        ("order", orders::order(&subject)),
        ("closure", orders::closure(&subject)),
        ("minimality", orders::minimality(&subject)),
        ("saturation", vertices::saturation(&subject)),
        ("quotient", vertices::quotient(&subject)),
        ("partition", vertices::partition(&subject)),
        ("counterexample", cells::counterexample()),
    ]
}

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/mt-core/src/guide"))
}

fn main() -> std::io::Result<()> {
    for (name, drawing) in drawings() {
        std::fs::write(folder().join(format!("{name}.svg")), drawing.svg())?;
    }
    Ok(())
}

#[test]
fn the_guide_has_these_drawings() {
    for (name, drawing) in drawings() {
        let known = std::fs::read_to_string(folder().join(format!("{name}.svg"))).unwrap_or_default();
        assert!(known == drawing.svg(), "{name}.svg is stale: run `cargo run --example laws`");
    }
}
