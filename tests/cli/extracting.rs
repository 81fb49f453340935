//! `mtess extract`: every criterion by every strategy, every format, and the promises of each.

use crate::kit::{Room, ball, ball_camera, ball_mesh};
use mt_core::generate;
use std::collections::HashMap;

const STRATEGIES: [&str; 3] = ["top-down", "priority", "incremental"];

fn count(room: &Room, criterion: &str, strategy: &str) -> u64 {
    let told = room.good(&format!("extract ball.mt {criterion} --strategy {strategy} -o out.ply --json")).json();
    let triangles = told["triangles"].as_u64().unwrap();
    assert_eq!(room.mesh("out.ply").cell_count() as u64, triangles);
    assert!(told["complete"] == true || criterion.contains("--cells"), "{criterion}: {told}");
    triangles
}

#[test]
fn every_strategy_gives_the_same_mesh() {
    let room = ball();
    room.write_camera("camera.json", &ball_camera());
    let criteria = [
        "--error 0.02",
        "--error 0",
        "--error 0.02 --cells 300",
        "--cells 400",
        "--camera camera.json --pixels 2",
        "--camera camera.json --cells 250",
        "--region -1,-1,0,1,1,1 --error 0.005",
        "--reference",
    ];
    let mut seen = HashMap::new();
    for criterion in criteria {
        let counts = STRATEGIES.map(|strategy| count(&room, criterion, strategy));
        assert!(counts.iter().all(|&n| n == counts[0]), "{criterion}: {counts:?}");
        seen.insert(criterion, counts[0]);
    }
    assert!(seen.values().all(|&n| n > 4), "{seen:?}");
    assert_eq!(seen["--reference"], 1280);
    assert!(seen["--error 0.02"] < 1280 && seen["--camera camera.json --pixels 2"] < 1280, "{seen:?}");
    // Half the ball is in the box: the other half costs less.
    let all = count(&room, "--error 0.005", "top-down");
    assert!(seen["--region -1,-1,0,1,1,1 --error 0.005"] < all, "{seen:?}, {all} everywhere");
}

#[test]
fn a_budget_is_never_overshot() {
    let room = ball();
    let base = room.model("ball.mt").0.base_cells().len() as u64;
    for budget in [base, base + 1, 57, 100, 333, 1279, 1280, 5000] {
        for strategy in STRATEGIES {
            let told = room.good(&format!("extract ball.mt --cells {budget} --strategy {strategy} -o out.obj --json"));
            let triangles = told.json()["triangles"].as_u64().unwrap();
            assert!(triangles <= budget, "{triangles} triangles of {budget} by {strategy}");
            assert!(triangles + 20 > budget.min(1280), "only {triangles} triangles of {budget} by {strategy}");
        }
    }
    let told = room.good("extract ball.mt --cells 1 -o out.obj");
    assert!(told.out.contains("no budget goes below"), "{}", told.out);
    assert_eq!(room.mesh("out.obj").cell_count() as u64, base);
}

#[test]
fn the_reference_is_the_input_bit_for_bit() {
    for operator in ["edge-collapse", "half-edge-collapse"] {
        for ending in ["obj", "ply", "stl", "glb"] {
            let room = Room::new();
            let input = format!("in.{ending}");
            room.put(&input, &ball_mesh());
            room.good(&format!("build {input} -o m.mt --operator {operator}"));
            for strategy in STRATEGIES {
                room.good(&format!("extract m.mt --reference --strategy {strategy} -o out.{ending}"));
                assert!(room.read(&format!("out.{ending}")) == room.read(&input), "{operator}, {ending}, {strategy}");
            }
        }
    }
}

#[test]
fn every_format_carries_the_same_mesh() {
    let room = ball();
    let meshes = ["obj", "ply", "stl", "glb"].map(|ending| {
        room.good(&format!("extract ball.mt --error 0.01 -o out.{ending}"));
        room.mesh(&format!("out.{ending}"))
    });
    let corners = |i: usize| -> Vec<_> {
        meshes[i].cells.iter().flatten().map(|v| meshes[i].positions[v.index()].to_array()).collect()
    };
    assert!(meshes[0].cell_count() > 20);
    assert!((1..4).all(|i| corners(i) == corners(0)));
    // The ending tells the format in capitals too.
    room.good("extract ball.mt --error 0.01 -o out2.PLY");
    assert!(room.read("out2.PLY") == room.read("out.ply"));
}

#[test]
fn single_cells_can_be_judged() {
    let room = ball();
    let told = |options: &str| {
        let json = room.good(&format!("extract ball.mt {options} -o out.ply --json")).json();
        json["triangles"].as_u64().unwrap()
    };
    let whole = told("--error 0.005");
    assert_eq!(told("--error 0.005 --per-cell strict"), told("--error 0.005 --per-cell loose"));
    assert!(told("--error 0.005 --per-cell strict") <= whole, "cells are judged more closely than spheres");
    let region = "--error 0.005 --region -1,-1,0,1,1,1";
    let (loose, strict) = (told(&format!("{region} --per-cell loose")), told(&format!("{region} --per-cell strict")));
    assert!(loose <= strict && strict <= told(region), "{loose}, {strict}");
    assert_eq!(told("--error 0 --per-cell strict"), told("--error 0"));
}

#[test]
fn a_time_limit_ends_with_a_mesh() {
    let room = Room::new();
    room.put("terrain.ply", &generate::terrain(60, 0.5, 3));
    room.good("build terrain.ply -o terrain.mt");
    for strategy in STRATEGIES {
        let told =
            room.good(&format!("extract terrain.mt --error 0 --time-ms 0 --strategy {strategy} -o o.ply --json"));
        assert!(told.json()["triangles"].as_u64().unwrap() >= 2);
        assert!(mt_core::format::census(&room.mesh("o.ply")).is_manifold(), "no crack, however early it stopped");
    }
}

#[test]
fn extracting_nothing_is_refused() {
    let room = ball();
    let line = room.refused("extract ball.mt -o out.ply", "--error");
    assert!(line.contains("--cells") && line.contains("--reference"), "{line}");
    room.refused("extract ball.mt --error nan -o out.ply", "--error");
    room.refused("extract ball.mt --error=-1 -o out.ply", "--error");
}
