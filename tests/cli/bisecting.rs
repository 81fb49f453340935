//! `mtess bisect`: the first step of a log or a camera path at which something goes wrong.

use crate::kit::{Room, ball, ball_camera};
use mt_core::log::{Log, Timeline};
use mt_core::{Explicit, NodeId, Step};

/// Writes `broken.mt`: the ball, with a cell turned over that is there at the end of the first frame, under checksums that
/// fit. Gives the node that brings it.
fn broken(room: &Room, log: &Log) -> NodeId {
    let (model, meta) = room.model("ball.mt");
    let mut timeline = Timeline::new(&model, &log.steps);
    timeline.seek(log.frame_ends[0], &mut ());
    let refined: Vec<NodeId> = timeline.view().front.finest_first().collect();
    let there = |&m: &NodeId| {
        let mut cells = model.fine_side(m).iter().copied();
        cells.find(|cell| timeline.view().mesh.contains(cell.0)).map(|cell| (m, cell))
    };
    let (node, cell) = refined.iter().find_map(there).expect("the finest nodes have their cells there");
    let mut parts = model.parts().clone();
    parts.corners[cell.index()].swap(0, 1);
    let model = Explicit::from_parts(parts).expect("arrays that fit each other");
    room.write_model("broken.mt", &model, &meta);
    node
}

fn recorded(room: &Room) -> Log {
    let told = room.good("bisect ball.mt --frames 12 --pixels 2 --record path.steps");
    assert!(told.out.contains("holds after every frame") && told.out.contains("in 12 frames"), "{}", told.out);
    Log::read(room.read("path.steps").as_slice()).unwrap()
}

#[test]
fn the_step_at_which_a_cell_turns_over_is_found() {
    let room = ball();
    let log = recorded(&room);
    // Within the first frame everything is refined for the first time.
    let node = broken(&room, &log);
    for every in ["", " --every"] {
        let told = room.run(&format!("bisect broken.mt --log path.steps -o step --json{every}"));
        assert_eq!(told.code, Some(1), "{told:?}");
        let json = told.json();
        assert_eq!((json["holds"].as_bool(), json["frame"].as_u64()), (Some(false), Some(0)), "{json}");
        if !every.is_empty() {
            assert_eq!((json["node"].as_u64(), json["refined"].as_bool()), (Some(u64::from(node.0)), Some(true)));
            assert_eq!(log.steps[json["at"].as_u64().unwrap() as usize - 1], Step::refine(node));
        }
        assert!(told.err.starts_with("error: broken.mt: step ") && told.err.contains("orientation"), "{}", told.err);
        let (before, after) = (room.mesh("step-before.obj"), room.mesh("step-after.obj"));
        assert!(before.cell_count() < after.cell_count());
    }
}

#[test]
fn a_number_of_cells_is_passed_at_one_step() {
    let room = ball();
    let log = recorded(&room);
    let told = room.run("bisect ball.mt --log path.steps --holds cells=40 --every --json -o step");
    let json = told.json();
    assert_eq!(told.code, Some(1));
    assert!(json["cells"].as_u64().unwrap() > 40 && room.mesh("step-before.obj").cell_count() <= 40, "{json}");
    assert_eq!(json["steps"].as_u64().unwrap() as usize, log.steps.len());
    room.good("bisect ball.mt --log path.steps --holds cells=2000");
    room.good("bisect ball.mt --log path.steps --holds law");
    room.good("bisect ball.mt --log path.steps --holds fold --every");
    assert_eq!(room.run("bisect ball.mt --log path.steps --holds fold=1").code, Some(1));
}

#[test]
fn hierarchies_of_meshes_and_cameras_of_ones_own() {
    let room = ball();
    let cameras = serde_json::to_vec(&[ball_camera(), ball_camera()]).unwrap();
    room.write("cameras.json", cameras);
    for dependency in ["dual-piece", "implicit-ids", "dual-piece-free"] {
        let arguments = format!("bisect ball.ply --dependency {dependency} --cameras cameras.json --pixels 4 --json");
        let json = room.good(&format!("{arguments} --record {dependency}.steps --every")).json();
        assert_eq!(json["frames"], 2);
        room.good(&format!("bisect ball.ply --dependency {dependency} --log {dependency}.steps --holds law"));
    }
}

#[test]
fn what_is_no_log_or_no_predicate_is_refused() {
    let room = ball();
    recorded(&room);
    room.write("other.steps", "{\"log\":1,\"nodes\":3}\n+2\n");
    room.refused("bisect ball.mt --log other.steps", "3 modifications");
    let (model, _) = room.model("ball.mt");
    let nodes = model.order().len();
    room.write("illegal.steps", format!("{{\"log\":1,\"nodes\":{nodes}}}\n+0\n"));
    room.refused("bisect ball.mt --log illegal.steps", "must go before it");
    room.write("twice.steps", format!("{{\"log\":1,\"nodes\":{nodes}}}\n-0\n"));
    room.refused("bisect ball.mt --log twice.steps", "already");
    room.write("text.steps", "hello");
    room.refused("bisect ball.mt --log text.steps", "line 1");
    room.refused("bisect ball.mt --log none.steps", "no such file");
    room.refused("bisect ball.mt --operator fan-merge", "for meshes");
    room.refused("bisect ball.mt --pixels=-1", "--pixels");
    for predicate in ["nothing", "cells=many", "fold=200", "fold=x"] {
        let told = room.run(&format!("bisect ball.mt --holds {predicate}"));
        assert_eq!(told.code, Some(2), "{told:?}");
    }
}
