//! Vertex hierarchies as files, packed files, and what every command makes of them.

use crate::kit::{Room, ball_mesh};
use mt_core::container::{self, Container};
use serde_json::Value;

fn room() -> Room {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    room
}

/// Runs `mtess`, which must refuse with a last line that names `names`, after what it found on loading. Gives the line.
fn refused_at_last(room: &Room, arguments: &str, names: &str) -> String {
    let told = room.run(arguments);
    let line = told.err.lines().last().unwrap_or_default().to_owned();
    assert!(told.code == Some(1) && line.starts_with("error: ") && line.contains(names), "mtess {arguments}: {told:?}");
    line
}

#[test]
fn a_hierarchy_is_built_told_and_extracted_from() {
    let room = room();
    for scheme in ["dual-piece", "four-face", "one-ring", "implicit-ids"] {
        let told = room.good(&format!("build ball.ply -o ball.mt --dependency {scheme} --json")).json();
        assert_eq!((&told["dependency"], &told["triangles_in"]), (&Value::from(scheme), &Value::from(1280)));
        let info = room.good("info ball.mt --json").json();
        for key in ["modifications", "triangles_base", "bytes"] {
            let other = if key == "triangles_base" { "cells_base" } else { key };
            assert_eq!(told[key], info[other], "{key}");
        }
        assert_eq!((&info["dependency"], &info["vertices_in"]), (&Value::from(scheme), &Value::from(642)));
        let text = room.good("info ball.mt").out;
        assert!(text.contains(&format!("a vertex hierarchy under {scheme}")) && text.contains("CHIL"), "{text}");
        room.good("extract ball.mt --reference -o all.ply");
        assert_eq!(room.mesh("all.ply").cell_count(), 1280);
        let told = room.good("extract ball.mt --cells 200 -o some.ply --json").json();
        assert!(told["triangles"].as_u64().is_some_and(|cells| (150..=200).contains(&cells)), "{told}");
        room.good("verify ball.mt --fronts 5");
    }
    let story = container::open(&room.read("ball.mt")).and_then(Container::story).unwrap().0;
    assert_eq!(story.mesh.cell_count(), 1280);
}

#[test]
fn fronts_of_a_hierarchy_are_the_same_top_down_and_incrementally() {
    let room = room();
    for scheme in ["dual-piece", "explicit"] {
        room.good(&format!("build ball.ply -o ball.mt --dependency {scheme}"));
        let nodes = |strategy: &str| {
            let options = format!("--error 0.01 --strategy {strategy} -o {strategy}.ply --json");
            room.good(&format!("extract ball.mt {options}")).json()["nodes"].clone()
        };
        assert_eq!(nodes("top-down"), nodes("incremental"));
        assert_eq!(nodes("top-down"), nodes("priority"));
    }
}

#[test]
fn a_packed_model_is_smaller_and_gives_the_same() {
    let room = room();
    for how in ["", "--dependency dual-piece"] {
        room.good(&format!("build ball.ply -o plain.mt {how}"));
        room.good(&format!("build ball.ply -o packed.mt --packed {how}"));
        assert!(room.read("packed.mt").len() < room.read("plain.mt").len());
        for name in ["plain", "packed"] {
            room.good(&format!("extract {name}.mt --error 0.01 -o {name}.ply"));
        }
        assert_eq!(room.read("plain.ply"), room.read("packed.ply"));
        let text = room.good("info packed.mt").out;
        assert!(text.contains("unpacked"), "{text}");
    }
}

#[test]
fn a_model_on_a_grid_is_smaller_and_near() {
    let room = room();
    room.good("build ball.ply -o packed.mt --packed --dependency dual-piece");
    let told = room.good("build ball.ply -o grid.mt --packed --dependency dual-piece --quantise 12 --json").json();
    let step = told["grid_step"].as_f64().unwrap();
    assert!(step.log2().fract() == 0.0 && step <= 4.0 / 4096.0, "{step}");
    assert!(room.read("grid.mt").len() * 4 < room.read("packed.mt").len() * 3);
    // Without packing it is a file like any other, with whole numbers in it.
    room.good("build ball.ply -o plain.mt --dependency dual-piece --quantise 12");
    for name in ["packed", "grid", "plain"] {
        room.good(&format!("extract {name}.mt --reference -o {name}.ply"));
    }
    assert_eq!(room.read("plain.ply"), room.read("grid.ply"));
    let [exact, near] = ["packed.ply", "grid.ply"].map(|name| room.mesh(name));
    assert_eq!((exact.cells == near.cells, exact.vertex_count()), (true, near.vertex_count()));
    let moved = exact.positions.iter().zip(&near.positions).map(|(p, q)| (*p - *q).abs().max_element());
    assert!(f64::from(moved.fold(0.0, f32::max)) <= step / 2.0);
    room.good("verify grid.mt --fronts 10");
    assert!(room.good("info grid.mt").out.contains("model units a step"));
    assert_eq!(room.run("build ball.ply -o x.mt --quantise 12").code, Some(2), "a grid is for hierarchies");
    assert_eq!(room.run("build ball.ply -o x.mt --dependency dual-piece --quantise 3").code, Some(2));
    room.put(
        "far.ply",
        &mt_core::Mesh { positions: ball_mesh().positions.iter().map(|p| *p + 1e7).collect(), ..ball_mesh() },
    );
    refused_at_last(&room, "build far.ply --no-weld -o x.mt --dependency dual-piece --quantise 24", "far.ply");
}

#[test]
fn the_head_is_told_without_the_rest() {
    let room = room();
    room.good("build ball.ply -o ball.mt --packed");
    let whole = room.good("info ball.mt --head").out;
    assert!(whole.contains("ball.ply by edge-collapse: an explicit model") && whole.contains("CORN"), "{whole}");
    // Damage behind the head is not seen by who reads the head alone.
    let mut bytes = room.read("ball.mt");
    let last = bytes.len() - 100;
    bytes[last] ^= 1;
    room.write("ball.mt", bytes);
    assert_eq!(room.good("info ball.mt --head").out, whole);
    room.refused("info ball.mt", "ball.mt");
}

#[test]
fn what_a_hierarchy_has_not_is_refused() {
    let room = room();
    room.good("build ball.ply -o ball.mt --dependency dual-piece");
    room.refused("history ball.mt -o h.jsonl", "ball.mt: is a vertex hierarchy");
    room.refused("extract ball.mt --error 0.1 --per-cell strict -o x.ply", "ball.mt: is a vertex hierarchy");
    room.refused("render ball.mt --error 0.1 --per-cell strict -o x.png", "ball.mt: is a vertex hierarchy");
    room.refused("verify ball.mt --operator fan-merge", "ball.mt");
    room.refused("build ball.ply -o y.mt --dependency dual-piece --errors measured", "--errors measured");
    // A scheme that does not take the merges is refused before anything is written.
    refused_at_last(&room, "build ball.ply -o y.mt --operator vertex-pair --dependency four-face", "four-face");
    assert!(!room.files().contains(&"y.mt".to_owned()));
}

#[test]
fn a_hierarchy_is_drawn_certified_and_walked() {
    let room = room();
    room.good("build ball.ply -o ball.mt --dependency dual-piece");
    room.good("render ball.mt --error 0.01 --overlay wireframe --painter cpu --size 64x64 -o ball.png");
    for overlay in ["error", "level", "normals", "operations", "forced", "fans", "pieces", "boundary"] {
        let command =
            format!("render ball.mt --error 0.01 --overlay {overlay} --painter cpu --size 64x64 -o {overlay}.png");
        room.good(&command);
        assert!(overlay == "boundary" || room.read(&format!("{overlay}.png")) != room.read("ball.png"), "{overlay}");
    }
    room.good("build ball.ply -o cells.mt --operator fan-merge");
    for overlay in ["fans", "pieces"] {
        let command = format!("render cells.mt --error 0.01 --overlay {overlay} -o none.png");
        room.refused(&command, "cells.mt: is an explicit model");
    }
    room.good("extract ball.mt --error 0.01 -o x.ply --certificate why.json");
    room.good("verify ball.mt --certificate why.json");
    room.good("bisect ball.mt --frames 4");
    // Another scheme on the same merges.
    room.good("bisect ball.mt --frames 4 --dependency one-ring");
    // What has no order has no least front, and says so.
    room.good("build ball.ply -o free.mt --dependency implicit-ids");
    let line = room.refused("extract free.mt --error 0.01 -o y.ply --certificate y.json", "no certificate");
    assert!(line.contains("no least front"), "{line}");
    room.refused("verify free.mt --certificate why.json", "why.json");
    let info = room.good("info free.mt").out;
    assert!(info.contains("under a rule that looks at the mesh"), "{info}");
    let all = room.good("verify ball.mt --dependency all --fronts 2 --json").json();
    assert!(all["schemes"].as_array().is_some_and(|schemes| schemes.len() == 8), "{all}");
}

#[test]
fn what_takes_too_much_memory_is_refused_before_it_begins() {
    let room = room();
    let line = room.refused("build ball.ply -o ball.mt --memory-limit 1M", "ball.ply: loading it takes about");
    assert!(line.contains("--memory-limit allows 1.0 MB"), "{line}");
    let line =
        refused_at_last(&room, "build ball.ply -o ball.mt --memory-limit 17.1M", "coarsening 1280 triangles takes");
    assert!(line.contains("--memory-limit allows 17 MB"), "{line}");
    room.good("build ball.ply -o ball.mt --memory-limit 1G");
    room.refused("info ball.mt --memory-limit 900k", "ball.mt: loading it takes about");
    refused_at_last(&room, "study ball.ply --memory-limit 17.1M -o report", "ball.ply: studying it takes about");
    refused_at_last(&room, "bench ball.ply --memory-limit 2M -o report", "loading it takes about");
    refused_at_last(&room, "bench --triangles 4000000 --memory-limit 100M -o report", "terrain-4000000 takes about");
    let wrong = room.run("build ball.ply -o x.mt --memory-limit lots");
    assert!(wrong.code == Some(2) && wrong.err.contains("900M"), "{wrong:?}");
}

#[test]
#[cfg(unix)]
fn a_disk_that_is_full_leaves_the_old_file() {
    let room = room();
    room.good("build ball.ply -o ball.mt");
    let before = room.read("ball.mt");
    // No file of this shell may grow beyond 16 kB: to the program that is a disk that is full.
    let program = env!("CARGO_BIN_EXE_mtess");
    let script =
        format!("trap '' XFSZ; ulimit -f 32; exec {program} build ball.ply -o ball.mt --operator half-edge-collapse");
    let output = std::process::Command::new("sh").args(["-c", &script]).current_dir(room.path("")).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("error: ball.mt: cannot be written"), "{told}");
    assert_eq!(room.files(), ["ball.mt", "ball.ply"]);
    assert!(room.read("ball.mt") == before);
}

#[test]
fn the_benchmark_measures_every_row() {
    let room = room();
    let options = "--operators edge-collapse,fan-merge --frames 8 --samples 500 --runs 2 -o report";
    let told = room.good(&format!("bench ball.ply {options} --json")).json();
    let rows = told["rows"].as_array().unwrap();
    assert_eq!((rows.len(), told["notes"].as_array().map(Vec::len)), (8, Some(0)), "{told}");
    for row in rows {
        assert_eq!((&row["model"], &row["triangles"]), (&Value::from("ball"), &Value::from(1280)));
        for key in ["cpu_s", "bytes", "file_bytes", "load_s"] {
            assert!(row["built"][key].as_f64().is_some_and(|value| value > 0.0), "{key} of {row}");
        }
        assert!(row["steps"]["ns"].as_f64().is_some_and(|ns| ns > 0.0), "{row}");
        assert!(row["frames"]["triangles"].as_f64().is_some_and(|count| count > 4.0), "{row}");
        // 1 % is 12 triangles, which may be fewer than the base mesh has.
        let sizes = if row["base"].as_u64().is_some_and(|base| base <= 12) { 3 } else { 2 };
        assert_eq!(row["quality"].as_array().map(Vec::len), Some(sizes), "{row}");
    }
    let mut files = std::fs::read_dir(room.path("report")).unwrap().map(|e| e.unwrap().file_name()).collect::<Vec<_>>();
    files.sort();
    assert_eq!(files, ["bench.csv", "bench.json", "bench.md", "index.html"]);
    let table = room.text("report/bench.md");
    // Two runs of a row are told as one.
    assert_eq!(
        table.lines().filter(|line| line.starts_with("| ball | 1280 | fan-merge | cells |")).count(),
        4,
        "{table}"
    );
}

#[test]
fn what_cannot_be_measured_is_noted_and_the_rest_is_measured() {
    let room = room();
    let options = "--operators edge-collapse,vertex-pair --dependencies four-face --frames 0 --samples 0";
    let told = room.good(&format!("bench ball.ply {options} --json")).json();
    assert_eq!(told["rows"].as_array().map(Vec::len), Some(1), "{told}");
    assert!(
        told["notes"][0].as_str().is_some_and(|note| note.contains("vertex-pair") && note.contains("four-face")),
        "{told}"
    );
    for (wrong, names) in
        [("--operators no", "no operator `no`"), ("--shapes cube", "no shape `cube`"), ("missing.ply", "no such file")]
    {
        let told = room.run(&format!("bench {wrong} -o other"));
        assert!(told.code == Some(1) && told.err.contains(names), "{wrong}: {told:?}");
    }
}
