//! `mtess verify`: exit 0 where the laws hold, exit 1 with a counterexample where one is broken.

use crate::kit::{Room, ball};
use mt_core::container::{self, Meta};
use mt_core::explicit::Parts;
use mt_core::{ErrorKind, Explicit, Mesh, MultiTessellation, Recorder, VertexId, generate};

#[test]
fn the_laws_hold_for_what_is_built() {
    let room = ball();
    room.put("terrain.ply", &generate::terrain(16, 0.5, 3));
    room.good("build terrain.ply -o terrain.mt --operator half-edge-collapse");
    for model in ["ball.mt", "terrain.mt"] {
        let told = room.good(&format!("verify {model} --fronts 20 --seed 7"));
        assert!(told.out.contains("every law holds over 20 random fronts (seed 7)"), "{}", told.out);
        let json = room.good(&format!("verify {model} --fronts 20 --json")).json();
        assert_eq!(json["holds"], true);
        let checks = json["checks"].as_object().unwrap();
        assert!(checks.len() >= 8 && checks.values().all(|count| count.as_u64() > Some(0)), "{json}");
    }
    assert!(room.files().iter().all(|name| !name.contains("counterexample")));
}

#[test]
fn a_model_of_tetrahedra_is_told_and_verified_but_not_drawn() {
    let mesh: Mesh<4> = generate::tetrahedral_box(1);
    let model = Recorder::new(&mesh).unwrap().finish(ErrorKind::Measured).unwrap();
    let mut bytes = Vec::new();
    container::write(&model, &Meta::default(), &mut bytes).unwrap();
    let room = Room::new();
    room.write("box.mt", bytes);
    assert_eq!(room.good("info box.mt --json").json()["corners"], 4);
    room.good("verify box.mt --fronts 3");
    room.good("history box.mt -o box.jsonl");
    room.refused("extract box.mt --reference -o box.ply", "box.mt");
    room.refused("render box.mt --reference -o box.png", "box.mt");
}

/// Writes `broken.mt`: the ball with its arrays altered, under checksums that fit.
fn broken(room: &Room, alter: impl FnOnce(&mut Parts<3>)) {
    let (model, meta) = room.model("ball.mt");
    let mut parts = model.parts().clone();
    alter(&mut parts);
    let model = Explicit::from_parts(parts).expect("arrays that fit each other");
    room.write_model("broken.mt", &model, &meta);
}

/// Verifies `broken.mt`, which must end with this law and a counterexample in a folder of its own.
fn found(room: &Room, law: &str) -> String {
    std::fs::create_dir_all(room.path("found")).unwrap();
    let told = room.run("verify broken.mt --counterexample found --fronts 20");
    assert_eq!(told.code, Some(1), "{told:?}");
    assert!(told.err.starts_with("error: broken.mt: ") && told.err.contains(law), "{law}: {told:?}");
    assert!(!told.err.contains("panicked"), "{told:?}");
    let log = room.text("found/broken-counterexample.txt");
    assert!(log.contains("model: broken.mt") && log.contains("front, finest first:"), "{log}");
    assert!(room.text("found/broken-counterexample.obj").contains("\nf "), "a mesh to look at");
    let json = room.run("verify broken.mt --counterexample found --fronts 20 --json").json();
    assert_eq!(json["holds"], false);
    assert_eq!(json["law"], law);
    log
}

#[test]
fn a_cell_turned_over_is_found() {
    let room = ball();
    broken(&room, |parts| parts.corners.last_mut().unwrap().swap(0, 1));
    let log = found(&room, "conformity");
    assert!(log.contains("replaces, when refined:") && log.contains("\n  - ") && log.contains("\n  + "), "{log}");
}

#[test]
fn a_bound_that_does_not_contain_is_found() {
    let room = ball();
    // The last node is a root of the discovery forest, so what hangs under it sticks out.
    broken(&room, |parts| {
        let m = parts.parents.iter().rev().find(|parent| !parent.is_none()).unwrap().index();
        parts.bounds[m].radius = 0.0;
        parts.bounds[m].error = 0.0;
    });
    found(&room, "saturation");
}

#[test]
fn a_corner_moved_elsewhere_is_found() {
    let room = ball();
    broken(&room, |parts| {
        let made = parts.corners.len() - 1;
        let elsewhere = (0..parts.positions.len() as u32).map(VertexId).find(|v| !parts.corners[made].contains(v));
        parts.corners[made][2] = elsewhere.unwrap();
    });
    found(&room, "conformity");
}

#[test]
fn models_that_change_topology_are_judged_by_what_they_claim() {
    let room = Room::new();
    room.put("boxes.ply", &generate::components(&[generate::torus(9, 6), generate::octahedron()]));
    for (operator, topology) in [("vertex-pair", "coarsened"), ("vertex-pair/edge-length", "coarsened")]
        .into_iter()
        .chain([("edge-collapse", "kept"), ("fan-merge", "kept")])
    {
        room.good(&format!("build boxes.ply -o boxes.mt --operator {operator}"));
        let told = room.good("verify boxes.mt --fronts 20 --json").json();
        assert_eq!((&told["holds"], &told["topology"]), (&true.into(), &topology.into()), "{operator}: {told}");
    }
    // Under another name it claims to keep what it changes, and is found out.
    room.good("build boxes.ply -o pairs.mt --operator vertex-pair");
    let (model, meta) = room.model("pairs.mt");
    room.write_model("broken.mt", &model, &Meta { operator: "edge-collapse".into(), ..meta });
    let log = found(&room, "crack-free");
    assert!(log.contains("the input is a manifold"), "{log}");
}

#[test]
fn the_hierarchies_of_a_mesh_are_verified_under_every_scheme() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 5));
    for operator in ["edge-collapse", "half-edge-collapse/lindstrom-turk", "fan-merge", "vertex-pair"] {
        let told = room.good(&format!("verify ball.ply --operator {operator} --fronts 6 --json")).json();
        assert_eq!((&told["holds"], &told["operator"]), (&true.into(), &operator.into()), "{told}");
        let schemes = told["schemes"].as_array().unwrap();
        assert_eq!(schemes.len(), 8);
        for scheme in schemes {
            // Dynamic rules are also judged at what the engine makes of a wish.
            let checks = scheme["checks"]["quotient"].as_u64().is_some_and(|count| count == 6 || count == 18);
            let unfit = scheme["unfit"].as_str().is_some_and(|why| why.contains("does not take this sequence"));
            let may_be_unfit = operator == "vertex-pair" || scheme["dependency"] == "implicit-ids-stored";
            assert!(checks || may_be_unfit && unfit, "{scheme}");
        }
    }
    let told = room.good("verify ball.ply --dependency dual-piece --fronts 9 --seed 4").out;
    assert!(told.starts_with("edge-collapse, dual-piece: every law holds over 9 random fronts (seed 4)"), "{told}");
    assert!(told.contains("\n  partition: checked 9 times"), "{told}");
    assert_eq!(
        room.good("verify ball.ply --dependency all --fronts 1").out.matches(" holds over 1 random fronts").count(),
        8
    );
    let told = room.good("verify ball.ply --operator vertex-pair --fronts 1").out;
    assert!(told.contains("dual-piece-free does not take this sequence"), "{told}");
    assert_eq!(room.files(), ["ball.ply"]);
}

#[test]
fn a_mesh_without_a_hierarchy_is_refused_with_the_reason() {
    let room = ball();
    room.put("fan3.obj", &generate::fan3());
    room.put("one.obj", &generate::triangle());
    let line = room.refused("verify fan3.obj --json", "fan3.obj");
    assert!(line.contains("--operator vertex-pair"), "{line}");
    room.good("verify fan3.obj --operator vertex-pair --fronts 3");
    room.good("verify one.obj --fronts 3");
    let line = room.refused("verify ball.ply --operator vertex-pair --dependency cut-pair --json", "ball.ply");
    assert!(line.contains("cut-pair does not take this sequence"), "{line}");
    // A model is what it is.
    for option in ["--operator edge-collapse", "--dependency all"] {
        let line = room.refused(&format!("verify ball.mt {option}"), "ball.mt");
        assert!(line.contains(&option[..10]) && line.contains("is for meshes"), "{line}");
    }
}

#[test]
fn a_counterexample_needs_its_folder() {
    let room = ball();
    room.refused("verify ball.mt --counterexample nowhere", "nowhere");
    room.refused("verify ball.mt --counterexample ball.ply", "ball.ply");
}

#[test]
fn a_model_without_modifications_is_a_model() {
    let room = Room::new();
    room.put("one.obj", &generate::triangle());
    room.good("build one.obj -o one.mt");
    assert!(room.model("one.mt").0.is_empty());
    for command in ["info one.mt", "verify one.mt", "history one.mt -o one.jsonl", "extract one.mt --error 0 -o o.ply"]
    {
        room.good(command);
    }
    room.good("build one.obj -o again.mt --history one.jsonl");
    room.good("render one.mt --reference --size 32x32 --painter cpu -o one.png");
}

#[test]
fn a_certificate_proves_a_front_the_least() {
    let room = ball();
    room.write_camera("camera.json", &crate::kit::ball_camera());
    for asked in ["--error 0.01", "--camera camera.json --pixels 2", "--error 0 --region 0,0,0,2,2,2", "--reference"] {
        room.good(&format!("extract ball.mt {asked} -o part.ply --certificate why.json"));
        let told = room.good("verify ball.mt --certificate why.json");
        assert!(told.out.contains("asked for or needed"), "{}", told.out);
    }
    room.good("extract ball.mt --error 0.01 -o part.ply --certificate why.json");
    let why: serde_json::Value = serde_json::from_str(&room.text("why.json")).unwrap();
    let nodes = room.good("verify ball.mt --certificate why.json --json").json()["nodes"].as_u64().unwrap() as usize;
    assert!(nodes > 20 && why["entries"]["entries"].as_array().unwrap().len() == nodes);
    // A node less, a reason that is none, another wish, another model: each proves nothing.
    let altered = |alter: &dyn Fn(&mut serde_json::Value), says: &str| {
        let mut other = why.clone();
        alter(&mut other);
        room.write("other.json", other.to_string());
        room.refused("verify ball.mt --certificate other.json", says);
    };
    altered(&|v| _ = v["entries"]["entries"].as_array_mut().unwrap().pop(), "proves nothing");
    altered(&|v| v["entries"]["entries"][0][1] = serde_json::json!({ "needed-by": 1 }), "proves nothing");
    altered(&|v| v["entries"]["entries"][0][0] = serde_json::json!(1_000_000), "proves nothing");
    altered(&|v| v["wish"]["uniform"]["error_max"] = serde_json::json!(0.001), "proves nothing");
    altered(&|v| v["nodes"] = serde_json::json!(7), "7 modifications");
    altered(&|v| v["certificate"] = serde_json::json!(2), "version 2");
    room.refused("verify ball.ply --certificate why.json", "ball.ply");
    assert_eq!(room.run("extract ball.mt --cells 90 -o part.ply --certificate why.json").code, Some(2));
}

#[test]
fn models_of_any_size_are_verified() {
    let room = ball();
    // Squares of such lengths are beyond single precision, and so are sums of some.
    let mut large = generate::octahedron();
    large.positions.iter_mut().for_each(|p| *p *= 4e18);
    room.put("large.ply", &large);
    for seed in 1..4 {
        room.good(&format!("verify large.ply --dependency dual-piece --fronts 100 --seed {seed}"));
    }
}
