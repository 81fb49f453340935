//! `mtess build`, `history` and `info`: what goes into a model, and what is told about it.

use crate::kit::{Room, ball, ball_mesh};
use mt_core::format::{Census, census};
use mt_core::{Mesh, MultiTessellation, VertexId, generate};
use operators::AnyOperator;

/// What `build --json` tells at least; numbers all of them.
const FIGURES: [&str; 9] = [
    "vertices_in",
    "triangles_in",
    "triangles_base",
    "modifications",
    "load_s",
    "analysis_s",
    "analysis_cpu_s",
    "write_s",
    "bytes",
];

#[test]
fn both_operators_build_and_tell_their_figures() {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    for operator in ["edge-collapse", "half-edge-collapse"] {
        let told = room.good(&format!("build ball.ply -o ball.mt --operator {operator} --json"));
        assert_eq!(told.err, "", "a run with --json says nothing besides");
        let figures = told.json();
        for key in FIGURES {
            assert!(figures[key].as_f64().is_some_and(|value| value >= 0.0), "{key} of {figures}");
        }
        assert!(figures.get("peak_bytes").is_some(), "{figures}");
        if cfg!(target_os = "linux") {
            assert!(figures["peak_bytes"].as_u64().unwrap() > 1 << 20);
        }
        assert_eq!(figures["vertices_in"], 642);
        assert_eq!(figures["triangles_in"], 1280);
        let (model, meta) = room.model("ball.mt");
        assert_eq!(meta.operator, operator);
        assert_eq!(meta.source, "ball.ply");
        assert_eq!(figures["modifications"], model.len());
        assert_eq!(figures["triangles_base"], model.base_cells().len());
        assert!(model.base_cells().len() < 20, "a ball goes down to a handful of triangles");
        assert_eq!(model.reference(), ball_mesh());
    }
    assert_eq!(room.files(), ["ball.mt", "ball.ply"]);
}

#[test]
fn regions_build_the_same_bytes_on_any_number_of_threads() {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    let bytes = |options: &str| {
        room.good(&format!("build ball.ply -o ball.mt {options}"));
        std::fs::read(room.path("ball.mt")).unwrap()
    };
    let one = bytes("--regions 60 --threads 1");
    assert!(one == bytes("--regions 60 --threads 3") && one == bytes("--regions 60"));
    room.good("verify ball.mt --fronts 20");
    assert_eq!(room.model("ball.mt").1.region_vertices, 60);
    // Small meshes are coarsened as a whole, unless something else is said.
    let whole = bytes("");
    assert!(whole == bytes("--regions 0") && whole != one);
    // Operators that cannot do otherwise are not troubled by threads, nor are measured errors.
    bytes("--operator fan-merge --threads 2");
    bytes("--errors measured --threads 2");
}

#[test]
fn every_operator_builds_a_model_that_knows_its_name() {
    let room = Room::new();
    room.put("terrain.ply", &generate::terrain(14, 0.5, 3));
    let metrics = ["quadric-attributes", "lindstrom-turk", "edge-length"];
    let with_metrics = metrics.iter().flat_map(|metric| {
        ["edge-collapse", "half-edge-collapse", "vertex-pair"].map(|operator| format!("{operator}/{metric}"))
    });
    for operator in AnyOperator::NAMES.map(str::to_owned).into_iter().chain(with_metrics) {
        room.good(&format!("build terrain.ply -o terrain.mt --operator {operator}"));
        let facts = room.good("info terrain.mt --json").json();
        assert_eq!(facts["operator"], operator);
        let (model, _) = room.model("terrain.mt");
        assert!(model.base_cells().len() * 4 < 392, "{operator} leaves {}", model.base_cells().len());
        room.good("verify terrain.mt --fronts 3");
        room.good("extract terrain.mt --cells 100 -o out.ply");
        assert!(room.mesh("out.ply").cell_count() <= 100.max(model.base_cells().len()), "{operator}");
    }
}

/// Three pages of a book: its back is an edge of three sheets.
fn book() -> Mesh<3> {
    let page = generate::bumpy_grid(6, 6, 0.0, 1);
    let low = page.bounding_box().unwrap().0;
    let mut book = Mesh { positions: Vec::new(), cells: Vec::new() };
    for angle in [0.0f32, 2.0, 4.0] {
        let before = book.positions.len() as u32;
        book.positions.extend(page.positions.iter().map(|p| {
            let far = p.y - low.y;
            glam::vec3(p.x, far * angle.cos(), far * angle.sin())
        }));
        book.cells.extend(page.cells.iter().map(|cell| cell.map(|v| VertexId(v.0 + before))));
    }
    book
}

#[test]
fn vertex_pairs_take_what_is_no_manifold() {
    let room = Room::new();
    room.put("book.obj", &book());
    for operator in ["edge-collapse", "half-edge-collapse", "fan-merge"] {
        let told = room.run(&format!("build book.obj -o book.mt --operator {operator}"));
        let line = told.err.lines().last().unwrap_or("").to_owned();
        assert!(told.code == Some(1) && line.starts_with("error: book.obj: "), "{told:?}");
        assert!(line.contains("--non-manifold split") && line.contains("--operator vertex-pair"), "{line}");
    }
    assert_eq!(room.files(), ["book.obj"]);
    for preference in ["geometry-first", "equal"] {
        room.good(&format!("build book.obj -o book.mt --operator vertex-pair --preference {preference}"));
        let (model, _) = room.model("book.mt");
        assert_eq!(model.input_cell_count(), 216);
        assert!(census(&model.reference()).non_manifold_edges.count > 0 && model.base_cells().len() < 60);
        room.good("verify book.mt --fronts 20");
    }
}

#[test]
fn every_format_builds_the_same_model() {
    let room = Room::new();
    let mut models = Vec::new();
    for ending in ["obj", "ply", "stl", "glb"] {
        room.put(&format!("ball.{ending}"), &ball_mesh());
        room.good(&format!("build ball.{ending} -o {ending}.mt"));
        models.push(room.model(&format!("{ending}.mt")).0);
    }
    // STL has no vertices, so theirs are numbered as they are met.
    let stl = models.remove(2);
    assert_eq!((stl.input_vertex_count(), stl.input_cell_count()), (642, 1280));
    assert!(models.iter().all(|model| *model == models[0]));
}

#[test]
fn a_build_stops_where_it_is_told() {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    let told = room.good("build ball.ply -o ball.mt --until-cells 500 --json").json();
    let base = told["triangles_base"].as_u64().unwrap();
    assert!((498..=500).contains(&base), "{base} triangles");

    let told = room.good("build ball.ply -o ball.mt --until-error 0.01 --json").json();
    let (model, _) = room.model("ball.mt");
    let largest = model.parts().bounds.iter().map(|bound| bound.error).fold(0.0, f32::max);
    assert!(largest <= 0.01, "an error of {largest}");
    assert!(told["triangles_base"].as_u64().unwrap() > 20, "the limit must bite");
}

#[test]
fn errors_are_measured_when_asked() {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    assert_eq!(room.good("build ball.ply -o e.mt --json").json()["error_kind"], "estimate");
    assert_eq!(room.good("build ball.ply -o m.mt --errors measured --json").json()["error_kind"], "measured");
    assert_eq!(room.good("info m.mt --json").json()["error_kind"], "measured");
    assert_ne!(room.model("e.mt").0.parts().bounds, room.model("m.mt").0.parts().bounds);
}

#[test]
fn a_locked_boundary_stays() {
    let room = Room::new();
    let mesh = generate::terrain(20, 0.5, 3);
    room.put("terrain.ply", &mesh);
    room.good("build terrain.ply -o locked.mt --boundary locked");
    room.good("build terrain.ply -o weighted.mt --boundary weighted");
    let census_of = |name: &str| -> Census {
        room.good(&format!("extract {name}.mt --error 1e30 -o {name}.ply"));
        census(&room.mesh(&format!("{name}.ply")))
    };
    assert_eq!(census_of("locked").boundary_edges, census(&mesh).boundary_edges);
    assert!(census_of("weighted").boundary_edges < 20, "a boundary that may go goes");
}

#[test]
fn sheets_are_refused_with_a_way_out_or_split() {
    let room = Room::new();
    // The bow tie is larger than the generator's, so that there is something to coarsen once it is split.
    for (name, mesh) in [("hourglass", generate::hourglass()), ("fan3", generate::fan3()), ("tie", bow_tie())] {
        room.put(&format!("{name}.obj"), &mesh);
        let before = room.files();
        let told = room.run(&format!("build {name}.obj -o {name}.mt"));
        let errors: Vec<_> = told.err.lines().filter(|line| line.starts_with("error:")).collect();
        assert_eq!((told.code, errors.len()), (Some(1), 1), "{told:?}");
        assert!(errors[0].contains(&format!("{name}.obj")) && errors[0].contains("--non-manifold split"), "{told:?}");
        assert_eq!(room.files(), before);
        room.refused(&format!("build {name}.obj -o {name}.mt --json"), &format!("{name}.obj"));

        let figures = room.good(&format!("build {name}.obj -o {name}.mt --non-manifold split --json")).json();
        assert!(!figures["load_report"]["split"].is_null(), "{figures}");
        room.good(&format!("verify {name}.mt --fronts 5"));
        let figures = room.good(&format!("info {name}.mt --json")).json();
        let report = figures["load_report"].to_string();
        assert!(report.contains("split") || report.contains("separated"), "{report}");
    }
}

/// Two balls that share one vertex.
fn bow_tie() -> Mesh<3> {
    let ball = generate::sphere(2);
    let mut tie = generate::components(&[ball.clone(), ball]);
    let shared = |from: u32| {
        let own = from * tie.vertex_count() as u32 / 2;
        mt_core::VertexId(own)
    };
    let (first, second) = (shared(0), shared(1));
    tie.cells.iter_mut().flatten().filter(|corner| **corner == second).for_each(|corner| *corner = first);
    tie.compact()
}

#[test]
fn a_history_goes_out_and_comes_back() {
    for operator in ["edge-collapse", "half-edge-collapse"] {
        let room = Room::new();
        room.put("ball.ply", &ball_mesh());
        room.good(&format!("build ball.ply -o ball.mt --errors measured --operator {operator}"));
        room.good("history ball.mt -o ball.jsonl");
        room.good("build ball.ply -o again.mt --history ball.jsonl");
        let ((model, _), (again, meta)) = (room.model("ball.mt"), room.model("again.mt"));
        assert!(again == model, "{operator}: the history tells another model");
        assert_eq!(meta.operator, "history");
        assert_eq!(room.text("ball.jsonl").lines().count(), 1 + model.len() as usize);
        room.good("history again.mt -o again.jsonl");
        assert!(room.read("again.jsonl") == room.read("ball.jsonl"));
    }
}

#[test]
fn info_tells_what_is_in_a_model() {
    let room = ball();
    let (model, _) = room.model("ball.mt");
    let facts = room.good("info ball.mt --json").json();
    assert_eq!(facts["source"], "ball.ply");
    assert_eq!(facts["operator"], "edge-collapse");
    assert_eq!(facts["corners"], 3);
    assert_eq!(facts["vertices_in"], 642);
    assert_eq!(facts["cells_in"], 1280);
    assert_eq!(facts["cells_base"], model.base_cells().len());
    assert_eq!(facts["modifications"], model.len());
    assert_eq!(facts["arcs"], model.order().arc_count());
    let parts: u64 = facts["bytes_by_part"].as_object().unwrap().values().map(|bytes| bytes.as_u64().unwrap()).sum();
    assert_eq!(facts["bytes"], parts, "the parts make the whole");
    let text = room.good("info ball.mt").out;
    for fact in ["ball.ply", "edge-collapse", "642", "1280", "modifications", "errors", "memory"] {
        assert!(text.contains(fact), "{fact} is not in:\n{text}");
    }
}

#[test]
fn an_output_is_replaced_whole_and_an_input_never() {
    let room = ball();
    let before = room.read("ball.mt");
    room.good("build ball.ply -o ball.mt --operator half-edge-collapse");
    assert!(room.read("ball.mt") != before);
    // A slip that would cost somebody the only copy.
    let mesh = room.read("ball.ply");
    room.refused("build ball.ply -o ball.ply", "ball.ply");
    room.refused("history ball.mt -o ball.mt", "ball.mt");
    assert!(room.read("ball.ply") == mesh);
}
