//! Bad input: one line that starts with `error:` and names the file, exit code 1, and nothing left behind.

use crate::kit::{Room, ball, ball_camera};
use mt_core::check::Random;
use mt_core::generate;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The endings of meshes that can be read.
const ENDINGS: [&str; 6] = ["obj", "ply", "stl", "off", "gltf", "glb"];

/// Every command that reads a model, but for the name of it.
const READERS: [&str; 5] = [
    "info {}",
    "verify {} --fronts 2",
    "history {} -o out.jsonl",
    "extract {} --error 0.1 -o out.ply",
    "render {} --error 0.1 --painter cpu -o out.png",
];

/// Every command that reads the model `bad` refuses it. Gives one of the lines.
fn no_model(room: &Room, bad: &str) -> String {
    READERS.map(|command| room.refused(&command.replace("{}", bad), bad)).into_iter().next().expect("five lines")
}

#[test]
fn what_is_not_there_is_named() {
    let room = ball();
    std::fs::create_dir(room.path("folder")).unwrap();
    std::fs::create_dir(room.path("folder.ply")).unwrap();
    room.write("empty.mt", "");
    for bad in ["missing.mt", "folder", "empty.mt"] {
        no_model(&room, bad);
    }
    for ending in ENDINGS {
        room.write(&format!("empty.{ending}"), "");
        let line = room.refused(&format!("build empty.{ending} -o out.mt"), &format!("empty.{ending}"));
        assert!(line.contains("empty"), "{line}");
        let line = room.refused(&format!("build missing.{ending} -o out.mt"), &format!("missing.{ending}"));
        assert!(line.contains("no such file"), "{line}");
    }
    assert!(room.refused("build folder -o out.mt", "folder").contains("is a folder"));
    assert!(room.refused("build folder.ply -o out.mt", "folder.ply").contains("is a folder"));
    assert!(room.refused("build ball.ply/x.ply -o out.mt", "ball.ply/x.ply").contains("error"));
    for camera in ["missing.json", "folder", "empty.mt"] {
        room.refused(&format!("extract ball.mt --camera {camera} -o out.ply"), camera);
    }
    room.refused("build ball.ply --history missing.jsonl -o out.mt", "missing.jsonl");
    room.refused("build ball.ply --history folder -o out.mt", "folder");
    room.refused("build ball.ply --history empty.mt -o out.mt --json", "empty.mt");
}

#[test]
fn an_output_has_its_folder_and_its_ending() {
    let room = ball();
    std::fs::create_dir(room.path("folder.mt")).unwrap();
    std::fs::create_dir(room.path("folder.ply")).unwrap();
    let commands = [
        ("build ball.ply -o nowhere/out.mt", "nowhere/out.mt"),
        ("build ball.ply -o ball.ply/out.mt", "ball.ply/out.mt"),
        ("build ball.ply -o folder.mt", "folder.mt"),
        ("build ball.ply -o out.ply", "out.ply"),
        ("build ball.ply -o out", "out"),
        ("history ball.mt -o nowhere/out.jsonl", "nowhere/out.jsonl"),
        ("history ball.mt -o out.mt", "out.mt"),
        ("extract ball.mt --error 0.1 -o nowhere/out.ply", "nowhere/out.ply"),
        ("extract ball.mt --error 0.1 -o folder.ply", "folder.ply"),
        ("extract ball.mt --error 0.1 -o out.gltf", "out.gltf"),
        ("extract ball.mt --error 0.1 -o out.gltf", "out.gltf"),
        ("extract ball.mt --error 0.1 -o out.mt", "out.mt"),
        ("extract ball.mt --error 0.1 -o out", "out"),
        ("render ball.mt --error 0.1 -o nowhere/out.png", "nowhere/out.png"),
        ("render ball.mt --error 0.1 -o out.ply", "out.ply"),
    ];
    for (command, names) in commands {
        room.refused(command, names);
    }
    // Before the work, not after it: the input is not even looked at.
    room.refused("build missing.ply -o nowhere/out.mt", "nowhere/out.mt");
}

#[test]
fn an_input_has_its_ending() {
    let room = ball();
    room.write("ball.xyz", room.read("ball.ply"));
    room.write("ball", room.read("ball.ply"));
    room.write("mesh.mt", room.read("ball.ply"));
    for bad in ["ball.xyz", "ball", "ball.mt"] {
        room.refused(&format!("build {bad} -o out.mt"), bad);
        room.refused(&format!("study {bad} -o report"), bad);
    }
    assert!(room.refused("build ball.mt -o out.mt", "ball.mt").contains("is a model"));
    assert!(no_model(&room, "mesh.mt").contains("not a .mt file"));
    // These take a mesh and coarsen it themselves.
    let takes_meshes = |command: &&&str| ["verify", "render", "movie"].iter().any(|name| command.starts_with(name));
    for command in READERS.iter().filter(|command| !takes_meshes(command)) {
        assert!(room.refused(&command.replace("{}", "ball.ply"), "ball.ply").contains("not a .mt file"));
    }
}

#[test]
fn a_damaged_model_is_refused() {
    let room = ball();
    let good = room.read("ball.mt");
    for length in [1, 7, 8, 23, 24, 100, good.len() / 2, good.len() - 64, good.len() - 1] {
        room.write("cut.mt", &good[..length]);
        let line = no_model(&room, "cut.mt");
        assert!(length < 8 || line.contains("truncated"), "{length} bytes: {line}");
    }
    for at in [12, 16, 30, 300, good.len() / 2, good.len() - 70] {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        room.write("flipped.mt", bytes);
        no_model(&room, "flipped.mt");
    }
    room.write("longer.mt", [good.as_slice(), b"more"].concat());
    no_model(&room, "longer.mt");
    let mut bytes = good.clone();
    bytes[8] = 9;
    room.write("newer.mt", bytes);
    assert!(no_model(&room, "newer.mt").contains("version 9 is newer"), "say what to do");
}

#[test]
fn a_camera_that_cannot_be_is_refused() {
    let room = ball();
    room.write_camera("good.json", &ball_camera());
    room.good("extract ball.mt --camera good.json -o good.ply");
    let changes = [
        ("\"near\"", "\"nearest\"", "nearest"),
        ("\"near\":", "\"zoom\":2,\"near\":", "zoom"),
        ("\"eye\":[", "\"eye\":[NaN,", ""),
        ("\"eye\":[", "\"eye\":[0.0,", ""),
        ("\"far\":", "\"far\":1e39,\"was\":", ""),
        ("\"far\":", "\"far\":null,\"was\":", ""),
        ("}", "", ""),
        ("{", "[", ""),
    ];
    let good = room.text("good.json");
    for (from, to, says) in changes {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from}");
        room.write("bad.json", bad);
        let line = no_camera(&room);
        assert!(line.contains(says), "{says}: {line}");
    }
    let camera = ball_camera();
    let cameras = [
        mt_core::Camera { target: camera.eye, ..camera },
        mt_core::Camera { up: camera.direction(), ..camera },
        mt_core::Camera { up: glam::Vec3::ZERO, ..camera },
        mt_core::Camera { fov_y_degrees: 180.0, ..camera },
        mt_core::Camera { near: -1.0, ..camera },
        mt_core::Camera { far: camera.near, ..camera },
        mt_core::Camera { width_px: 0, ..camera },
        mt_core::Camera { height_px: 1 << 20, ..camera },
    ];
    for camera in cameras {
        room.write_camera("bad.json", &camera);
        no_camera(&room);
    }
    room.write("bad.json", good.replacen("\"eye\":[", "\"eye\":[1e39,0,0],\"was\":[", 1).replace("\"was\"", "\"up\""));
    no_camera(&room);
}

fn no_camera(room: &Room) -> String {
    room.refused("render ball.mt --camera bad.json --painter cpu -o out.png", "bad.json");
    room.refused("extract ball.mt --camera bad.json -o out.ply", "bad.json")
}

#[test]
fn a_history_with_a_bad_line_is_refused() {
    let room = Room::new();
    room.put("grid.ply", &generate::grid(4, 4));
    room.good("build grid.ply -o grid.mt");
    room.good("history grid.mt -o grid.jsonl");
    let good = room.text("grid.jsonl");
    let lines: Vec<&str> = good.lines().collect();
    assert!(lines.len() > 4);
    let with = |at: usize, line: &str| {
        let mut lines = lines.clone();
        lines[at] = line;
        lines.join("\n")
    };
    let bad = [
        (with(2, "{"), "line 3"),
        (with(2, "not JSON"), "line 3"),
        (with(2, "[]"), "line 3"),
        (with(2, &lines[2].replace("\"kill\"", "\"slay\"")), "line 3"),
        (with(2, &lines[2].replace("\"error\":", "\"error\":-1")), "line 3"),
        (with(2, &lines[2].replace("\"kill\":[", "\"kill\":[9999,")), "line 3"),
        (with(2, lines[1]), "line 3"),
        (with(0, lines[1]), "line 1"),
        (with(0, &lines[0].replace("\"history\":1", "\"history\":2")), "line 1"),
        (with(0, &lines[0].replace("\"cells\":32", "\"cells\":31")), "32 cells"),
        (lines[1..].join("\n"), "line 1"),
        ("\n\n".to_owned(), "line 1"),
        // It reads well, and leaves a hole.
        (format!("{}\n{}", lines[0], r#"{"kill":[0],"make":[],"error":0.1}"#), "modification 1"),
    ];
    for (text, says) in bad {
        room.write("bad.jsonl", &text);
        let line = room.refused("build grid.ply --history bad.jsonl -o out.mt --json", "bad.jsonl");
        assert!(line.contains(says), "{says}: {line}");
    }
    room.write("bad.jsonl", [lines[0].as_bytes(), b"\n\xff\xfe\x00"].concat());
    room.refused("build grid.ply --history bad.jsonl -o out.mt --json", "bad.jsonl");
}

#[test]
fn garbage_is_refused() {
    let room = Room::new();
    let mut random = Random::new(11);
    for ending in ENDINGS {
        let bad = format!("bad.{ending}");
        for case in 0..6 {
            let noise: Vec<u8> = (0..200 * (case + 1)).map(|_| random.bits() as u8).collect();
            room.write(&bad, noise);
            room.refused(&format!("build {bad} -o out.mt"), &bad);
        }
        for text in
            ["\n", "\0\0\0\0", "hello\nthere\n", "{}", "<html></html>", "\u{feff}", "ply", "solid", "OFF", "glTF"]
        {
            room.write(&bad, text);
            room.refused(&format!("build {bad} -o out.mt"), &bad);
        }
    }
    let texts = [
        ("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
        ("obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
        ("obj", "v 0 0 0\nv 1 0 0\nv 0 1e99 0\nf 1 2 3\n"),
        ("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n"),
        ("obj", "f -1 -2 -3\n"),
        ("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        ("off", "OFF\n4000000000 4000000000 0\n0 0 0\n"),
        ("ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n"),
        (
            "ply",
            "ply\nformat binary_little_endian 1.0\nelement face 99999999999\nproperty list int int vertex_indices\nend_header\n",
        ),
        ("gltf", r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":99999999999999,"uri":"missing.bin"}]}"#),
        ("gltf", r#"{"asset":{"version":"9.9"}}"#),
    ];
    for (ending, text) in texts {
        let bad = format!("bad.{ending}");
        room.write(&bad, text);
        room.refused(&format!("build {bad} -o out.mt"), &bad);
        room.refused(&format!("build {bad} -o out.mt --json --non-manifold split --no-weld"), &bad);
    }
    room.write("bad.stl", [[0u8; 80].as_slice(), &u32::MAX.to_le_bytes(), &[0; 50]].concat());
    room.refused("build bad.stl -o out.mt", "bad.stl");
}

#[test]
fn a_gltf_reads_no_file_from_elsewhere() {
    let room = Room::new();
    std::fs::create_dir(room.path("inside")).unwrap();
    let mut bytes: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.resize(36, 0);
    room.write("outside.bin", &bytes);
    room.write("inside/beside.bin", &bytes);
    let gltf = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        )
    };
    room.write("inside/good.gltf", gltf("beside.bin"));
    room.good("build inside/good.gltf -o good.mt");
    let absolute = room.path("outside.bin").to_string_lossy().replace('\\', "/");
    for uri in
        ["../outside.bin", "%2e%2e/outside.bin", "./../outside.bin", "missing.bin", "line%0Abreak.bin", &absolute]
    {
        room.write("inside/bad.gltf", gltf(uri));
        room.refused("build inside/bad.gltf -o out.mt", "inside/bad.gltf");
    }
}

#[test]
fn an_unknown_name_is_told_with_those_there_are() {
    let room = ball();
    for (command, says) in [
        ("build ball.ply -o out.mt --operator grow", "no operator `grow`; there are edge-collapse, half-edge-collapse"),
        ("build ball.ply -o out.mt --operator edge-collapse/taste", "no metric \"taste\"; there are quadric"),
        ("build ball.ply -o out.mt --operator fan-merge/quadric", "fan-merge brings its own metric"),
        ("verify ball.ply --operator grow", "no operator `grow`; there are edge-collapse, half-edge-collapse"),
        ("verify ball.ply --dependency hope", "no dependency scheme `hope`; there are explicit, one-ring"),
    ] {
        let told = room.run(command);
        assert_eq!(told.code, Some(2), "mtess {command}: {told:?}");
        let line = told.err.lines().next().unwrap_or("");
        assert!(line.starts_with("error: ") && line.contains(says), "mtess {command}: {line}");
    }
    for (option, says) in [
        ("--operators edge-collapse,grow", "no operator `grow`; there are edge-collapse, half-edge-collapse"),
        ("--operators vertex-pair/taste", "no metric \"taste\"; there are quadric"),
        ("--dependencies hope", "no dependency `hope`; there are cells, explicit, one-ring"),
        ("--criteria uniform,whim", "no criterion `whim`; there are uniform, region"),
        ("--strategies luck,top-down", "no strategy `luck`; there are top-down, priority"),
        ("--strategies all,luck", "no strategy `luck`; there are top-down, priority"),
    ] {
        room.refused(&format!("study ball.ply -o report {option}"), says);
    }
}

#[test]
fn an_option_of_another_operator_is_refused() {
    let room = ball();
    for (options, says) in [
        ("--below-stall stop", "--below-stall is for fan-merge, not for edge-collapse"),
        ("--operator vertex-pair --below-stall collapse", "--below-stall is for fan-merge, not for vertex-pair"),
        ("--operator fan-merge --preference equal", "--preference is for vertex-pair, not for fan-merge"),
        ("--operator vertex-pair --boundary locked", "--boundary locked is not for vertex-pair"),
        ("--operator fan-merge --regions 500", "--regions is for collapses of edges, not for fan-merge"),
        ("--regions 7", "16 at least"),
        ("--errors measured --regions 500", "--errors measured needs the mesh as a whole"),
    ] {
        room.refused(&format!("build ball.ply -o out.mt --json {options}"), says);
    }
    for stall in ["partial", "collapse", "stop"] {
        room.good(&format!("build ball.ply -o out.mt --operator fan-merge --below-stall {stall}"));
    }
}

#[test]
fn names_that_are_no_options_are_told_by_the_parser() {
    let room = ball();
    for command in
        ["", "fly", "build", "extract ball.mt -o", "extract ball.mt --error x -o o.ply", "render ball.mt --size 0x9"]
    {
        let told = room.run(command);
        assert_eq!(told.code, Some(2), "mtess {command}: {told:?}");
        assert!(!told.err.contains("panicked") && !told.err.is_empty(), "{told:?}");
    }
    assert_eq!(room.good("--help").err, "");
    assert_eq!(room.files(), ["ball.mt", "ball.ply"]);
}

/// Real files that other programs choke on; `MT_DATA` names the folder that holds `bad/`.
#[test]
fn real_bad_files_build_or_are_refused() {
    let Some(root) = std::env::var_os("MT_DATA") else {
        println!("MT_DATA not set: skipped the bad files");
        return;
    };
    let folder = std::fs::read_dir(PathBuf::from(root).join("bad")).expect("MT_DATA has a folder bad");
    let mut paths: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        let room = Room::new();
        let begun = Instant::now();
        let output = room.command("build -o out.mt").arg(&path).output().expect("the program starts");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(begun.elapsed() < Duration::from_secs(10), "{} took {:?}", path.display(), begun.elapsed());
        assert!(!errors.contains("panicked"), "{errors}");
        let lines: Vec<_> = errors.lines().filter(|line| line.starts_with("error:")).collect();
        println!("{}: {:?} {lines:?}", path.display(), output.status.code());
        if output.status.success() {
            assert_eq!(lines.len(), 0, "{errors}");
            room.good("verify out.mt --fronts 3");
            continue;
        }
        assert_eq!((output.status.code(), lines.len()), (Some(1), 1), "{}: {errors}", path.display());
        assert!(lines[0].contains(&path.display().to_string()), "{errors}");
        assert_eq!(errors.lines().last(), Some(lines[0]), "the error comes last");
        assert_eq!(room.files(), [""; 0]);
    }
}
