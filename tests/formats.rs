//! Formats: what is written reads back, real models have the counts they are known for, reports tell.
//!
//! Laws: writing then reading is the identity (up to what a format cannot say); reading drops only
//! what is no triangle; splitting makes a surface manifold and keeps its triangles. Real files
//! are looked for under `MT_DATA`, with their counts in `MANIFEST.tsv`.

use glam::Vec3;
use mt_core::format::{
    Census, Format, LoadOptions, LoadReport, NonManifold, ReadError, WriteError, census, read, split_non_manifold,
    write,
};
use mt_core::{Mesh, VertexId};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

const WRITTEN: [Format; 5] = [Format::Obj, Format::Off, Format::Ply, Format::Stl, Format::Glb];

fn load(format: Format, bytes: &[u8], options: &LoadOptions) -> Result<(Mesh<3>, LoadReport), ReadError> {
    read(format, bytes, options, &|_| None)
}

fn load_default(format: Format, bytes: &[u8]) -> (Mesh<3>, LoadReport) {
    load(format, bytes, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn as_is() -> LoadOptions {
    LoadOptions { weld: false, non_manifold: NonManifold::Keep }
}

fn refused(format: Format, bytes: &[u8]) -> String {
    load(format, bytes, &LoadOptions::default()).expect_err("this must be refused").to_string()
}

/// Triangles over up to 12 vertices at distinct positions, each three distinct corners, no two alike.
fn clean_soup() -> impl Strategy<Value = Mesh<3>> {
    let triangles = prop::collection::vec((0u32..12, 0u32..12, 0u32..12), 1..40);
    let scale = prop::sample::select(vec![1.0f32, 1e-30, 1e30, 0.1, 12345.678]);
    (triangles, scale, any::<[f32; 3]>().prop_filter("finite", |f| f.iter().all(|x| x.is_finite()))).prop_filter_map(
        "at least one triangle",
        |(triangles, scale, odd)| {
            let mut seen = BTreeSet::new();
            let mut cells: Vec<[u32; 3]> = Vec::new();
            for (a, b, c) in triangles {
                let mut sorted = [a, b, c];
                sorted.sort_unstable();
                if a != b && b != c && c != a && seen.insert(sorted) {
                    cells.push([a, b, c]);
                }
            }
            let mut positions: Vec<Vec3> =
                (0..12).map(|i| Vec3::new(i as f32, (i * i % 7) as f32, 1.0 / (i + 3) as f32) * scale).collect();
            positions[5] = Vec3::from_array(odd);
            let distinct: BTreeSet<[u32; 3]> =
                positions.iter().map(|p| p.to_array().map(|x| (x + 0.0).to_bits())).collect();
            (!cells.is_empty() && distinct.len() == 12).then(|| Mesh::from_indices(positions, &cells).compact())
        },
    )
}

/// Each triangle by its corners' positions, bit by bit.
fn by_position(mesh: &Mesh<3>) -> Vec<[[u32; 3]; 3]> {
    mesh.cells.iter().map(|cell| cell.map(|v| mesh.positions[v.index()].to_array().map(f32::to_bits))).collect()
}

/// The definition, without any of the tricks: edges by map, umbrellas by flooding.
fn is_manifold_slowly(mesh: &Mesh<3>) -> bool {
    let mut edges: BTreeMap<[VertexId; 2], Vec<usize>> = BTreeMap::new();
    let mut around: BTreeMap<VertexId, BTreeSet<usize>> = BTreeMap::new();
    for (t, cell) in mesh.cells.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (cell[k], cell[(k + 1) % 3]);
            edges.entry([a.min(b), a.max(b)]).or_default().push(t);
            around.entry(a).or_default().insert(t);
        }
    }
    let one_umbrella = |vertex: VertexId, triangles: &BTreeSet<usize>| {
        let mut reached: BTreeSet<usize> = triangles.iter().take(1).copied().collect();
        loop {
            let size = reached.len();
            for (_, run) in edges.iter().filter(|(ends, _)| ends.contains(&vertex)) {
                if run.iter().any(|t| reached.contains(t)) {
                    reached.extend(run);
                }
            }
            if reached.len() == size {
                return size == triangles.len();
            }
        }
    };
    edges.values().all(|run| run.len() <= 2) && around.iter().all(|(v, triangles)| one_umbrella(*v, triangles))
}

proptest! {
    #[test]
    fn written_then_read_is_the_same(mesh in clean_soup()) {
        for format in WRITTEN {
            let bytes = write(format, &mesh).unwrap();
            let (back, report) = load_default(format, &bytes);
            prop_assert_eq!(by_position(&back), by_position(&mesh), "{}", format);
            if format != Format::Stl {
                prop_assert_eq!(&back, &mesh, "{}", format);
                prop_assert!(report.is_untouched(), "{}", report);
            }
        }
    }

    #[test]
    fn splitting_makes_a_manifold_of_anything(mesh in clean_soup()) {
        let mut split = mesh.clone();
        let counts = split_non_manifold(&mut split);
        let found = census(&split);
        prop_assert!(found.is_manifold(), "{:?}", split);
        prop_assert!(is_manifold_slowly(&split));
        prop_assert_eq!(by_position(&split), by_position(&mesh));
        prop_assert_eq!(split.positions.len(), mesh.positions.len() + counts.copies);
        prop_assert_eq!(counts.edges, census(&mesh).non_manifold_edges.count);
        // A second time there is nothing left to do, and a manifold is never touched.
        let again = split.clone();
        prop_assert_eq!(split_non_manifold(&mut split).copies, 0);
        prop_assert_eq!(&split, &again);
        if is_manifold_slowly(&mesh) {
            prop_assert_eq!(counts.copies, 0);
        }
    }

    #[test]
    fn the_census_knows_a_manifold(mesh in clean_soup()) {
        prop_assert_eq!(census(&mesh).is_manifold(), is_manifold_slowly(&mesh));
    }

    #[test]
    fn every_float_survives_text(bits in any::<[u32; 9]>()) {
        let floats = bits.map(|b| { let x = f32::from_bits(b); if x.is_finite() { x } else { 1.5 } });
        let positions = floats.chunks(3).map(Vec3::from_slice).collect();
        let mesh = Mesh::from_indices(positions, &[[0, 1, 2]]);
        for format in WRITTEN {
            let (back, _) = load(format, &write(format, &mesh).unwrap(), &as_is()).unwrap();
            prop_assert_eq!(by_position(&back), by_position(&mesh));
        }
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let triangle = Mesh::from_indices(vec![Vec3::X, Vec3::Y, Vec3::Z], &[[0, 1, 2]]);
    assert_eq!(write(Format::Gltf, &triangle), Err(WriteError::NotWritten(Format::Gltf, Format::Glb)));
    for format in WRITTEN {
        assert_eq!(write(format, &Mesh::default()), Err(WriteError::NoTriangles));
        let outside = Mesh::from_indices(vec![Vec3::X], &[[0, 0, 1]]);
        assert_eq!(write(format, &outside), Err(WriteError::IndexOutOfRange(0)));
        let nowhere = Mesh::from_indices(vec![Vec3::NAN; 3], &[[0, 1, 2]]);
        assert_eq!(write(format, &nowhere), Err(WriteError::NotFinite(0)));
    }
}

#[test]
fn extensions_name_formats() {
    assert_eq!(Format::from_extension("PLY"), Some(Format::Ply));
    assert_eq!(Format::from_extension("step"), None);
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn obj_traps() {
    let plain = load_default(Format::Obj, format!("{SQUARE}f 1 2 3 4\n").as_bytes()).0;
    let same = [
        ("byte order mark", format!("\u{FEFF}{SQUARE}f 1 2 3 4\n")),
        ("CR LF", format!("{SQUARE}f 1 2 3 4\n").replace('\n', "\r\n")),
        ("CR only", format!("{SQUARE}f 1 2 3 4\n").replace('\n', "\r")),
        ("continued", format!("{SQUARE}f 1 \\\n2 3\\\r\n 4")),
        ("groups cut nothing", format!("{SQUARE}g a\nf 1 2 3\nusemtl red\ng b\nf 1 3 4\n")),
        ("negative", format!("{SQUARE}f -4 -3 -2 -1\n")),
        ("texture and normals are not looked at", format!("{SQUARE}f 1/7/9 2//4 3/1 4\n")),
        ("a fourth coordinate is ignored", format!("v 0 0 0 2\n{}f 1 2 3 4 # quad\n", &SQUARE[8..])),
        ("colours", format!("v 0 0 0 nan nan nan\n{}f 1 2 3 4\n", &SQUARE[8..])),
        ("faces before vertices", format!("f 1 2 3 4\n{SQUARE}")),
        ("comment that is continued to no one", format!("# C:\\temp\\\n{SQUARE}f 1 2 3 4\n")),
    ];
    for (name, text) in same {
        assert_eq!(load_default(Format::Obj, text.as_bytes()).0, plain, "{name}");
    }
    let mut latin = format!("{SQUARE}f 1 2 3 4\n# caf").into_bytes();
    latin.extend_from_slice(b"\xE9\n");
    assert_eq!(load_default(Format::Obj, &latin).0, plain);
}

#[test]
fn obj_keeps_the_order_of_vertices() {
    let text = "v 0 0 0\nv 1 0 0\nv 5 5 5\nv 1 1 0\nv 0 1 0\nl 1 2\nf 5 2 1\nf 4\nf 5 4 2\n";
    let (mesh, report) = load_default(Format::Obj, text.as_bytes());
    let expected = [[3, 1, 0], [3, 2, 1]];
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    assert_eq!(mesh, Mesh::from_indices(positions, &expected));
    assert_eq!((report.vertices_written, report.faces_written, report.unused_vertices), (5, 3, 1));
    assert_eq!((report.left_out.short_faces, report.left_out.other_elements), (1, 1));
}

#[test]
fn obj_errors_name_lines() {
    let cases = [
        ("v 0 0 0\nv 1 0\nf 1 1 1\n", "OBJ, line 2: \"v 1 0\" is not a vertex of three numbers"),
        ("v 0 0 0\r\nv 1 0 0\r\n\r\nf 1 2 x\r\n", "OBJ, line 4: \"f 1 2 x\" is not a face"),
        ("v 0 0 0\nf 1 1 4\n", "OBJ, line 2: vertex index 4 is out of range (1 vertices)"),
        ("v 0 0 0\n#\\\nf 1 0 1\n", "OBJ, line 3: vertex index 0 is out of range (1 vertices)"),
        ("v 0 0 0\nf -1 -2 -1\n", "OBJ, line 2: vertex index -2 is out of range (1 vertices)"),
        ("v 0 0 0\nf 1 /2 1\n", "OBJ, line 2: \"/2\" names no vertex"),
        ("v 0 0 0\nv 1 nan 0\nv 0 1 1\nf 1 2 3\n", "OBJ, line 2: a position is not finite: 1 NaN 0"),
        ("v 0 0 0\nv 1 1e39 0\nv 0 1 1\nf 1 2 3\n", "OBJ, line 2: a position is not finite: 1 inf 0"),
        ("", "OBJ: the file is empty"),
        ("v 0 0 0\n", "OBJ: the file has no triangles (1 vertices, 0 faces, of which none is a proper triangle)"),
    ];
    for (text, expected) in cases {
        assert_eq!(refused(Format::Obj, text.as_bytes()), expected, "{text:?}");
    }
}

#[test]
fn repairs_are_reported() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 0\nv nan 0 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\nf 1 1 2\nf 4 2 1\nf 1 2 6\n";
    let (mesh, report) = load_default(Format::Obj, text.as_bytes());
    assert_eq!((mesh.positions.len(), mesh.cells.len()), (4, 2));
    assert_eq!(report.welded_vertices, 1);
    assert_eq!((report.degenerate_triangles.count, report.degenerate_triangles.first_faces.clone()), (2, vec![2, 3]));
    assert_eq!((report.duplicate_triangles.count, report.duplicate_triangles.first_faces.clone()), (1, vec![1]));
    assert_eq!((report.unused_vertices, report.unused_not_finite), (1, 1));
    assert_eq!(report.census.inconsistent_edges.count, 1);
    let text = report.to_string();
    for part in
        ["1 vertices merged", "faces 2, 3)", "dropped as duplicates", "(1 not finite)", "disagree in orientation"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn off_variants() {
    let plain = load_default(Format::Off, b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n").0;
    let same = [
        "# a comment\nOFF # here too\n\n4 2 0\n0 0 0\n# between\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 0.5 1\n",
        "OFF 4 1 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3\r\n",
        "COFF\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 1 2 3 4\n1 1 0 1 2 3 4\n0 1 0 1 2 3 4\n3 0 1 2\n3 0 2 3",
        "STNOFF\n4 2\n0 0 0 0 0 1 .5 .5\n1 0 0 0 0 1 0 0\n1 1 0 0 0 1 1 1\n0 1 0 0 0 1 1 1\n3 0 1 2\n3 0 2 3\n",
        "4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    ];
    for text in same {
        assert_eq!(load_default(Format::Off, text.as_bytes()).0, plain, "{text}");
    }
    assert_eq!(
        refused(Format::Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"),
        "OFF, line 6: vertex index 3 is out of range (3 vertices)"
    );
    assert_eq!(
        refused(Format::Off, b"OFF\n3 1 0\n0.0 0.0 0.0\n1.0 0.0 0.0\n"),
        "OFF, line 4: the file ends in the middle of a vertex"
    );
    assert!(refused(Format::Off, b"4OFF\n3 1 0\n").contains("not supported"));
}

#[test]
fn stl_text_and_binary() {
    let text = "solid two words\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid two words\n";
    let (mesh, report) = load_default(Format::Stl, text.as_bytes());
    assert_eq!((mesh.cells.len(), report.faces_written), (1, 1));
    let mut binary = write(Format::Stl, &mesh).unwrap();
    binary[..5].copy_from_slice(b"solid");
    assert_eq!(load_default(Format::Stl, &binary).0, mesh);
    binary.truncate(100);
    binary[..5].copy_from_slice(b"other");
    assert!(refused(Format::Stl, &binary).contains("1 triangles are declared"));
    assert_eq!(
        refused(Format::Stl, text.replace("1 0 0\n", "1 0 zero\n").as_bytes()),
        "STL, line 5: \"zero\" is not a number that can stand here"
    );
}

#[test]
fn ply_layouts() {
    let expected = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let text = "ply\r\nformat ascii 1.0\r\ncomment hello\r\nelement extra 2\r\nproperty list uchar float values\r\nproperty int64 \r\n";
    assert!(refused(Format::Ply, text.as_bytes()).starts_with("PLY, line 6"));
    let text = "ply\nformat ascii 1.0\nelement extra 2\nproperty list uchar float values\nelement face 1\nproperty uchar red\nproperty list uint8 uint32 vertex_index\nelement vertex 3\nproperty double z\nproperty float32 x\nproperty list char short other\nproperty double y\nend_header\n2 0.5 0.25\n0\n7 3 0 1 2\n0 0 0 0\n0 1 2 5 6 0\n0 0 0 1\n";
    let (mesh, report) = load_default(Format::Ply, text.as_bytes());
    assert_eq!(mesh.positions, expected);
    assert_eq!(report.left_out.other_elements, 2);
    for big in [false, true] {
        let name = if big { "big" } else { "little" };
        let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\nelement vertex 3\nproperty double x\nproperty short y\nproperty uchar flag\nproperty int8 z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n").into_bytes();
        let order = |mut bytes: Vec<u8>| {
            if big {
                bytes.reverse()
            }
            bytes
        };
        for p in &expected {
            bytes.extend(order(f64::from(p.x).to_le_bytes().to_vec()));
            bytes.extend(order((p.y as i16).to_le_bytes().to_vec()));
            bytes.extend([9, p.z as i8 as u8]);
        }
        for value in [5i32, 0, 1, 2, -1, 1] {
            bytes.extend(order(value.to_le_bytes().to_vec()));
        }
        assert_eq!(load_default(Format::Ply, &bytes).0, mesh, "{name}");
    }
}

#[test]
fn gltf_world_positions_and_refusals() {
    let mesh = Mesh::from_indices(vec![Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]]);
    let glb = write(Format::Glb, &mesh).unwrap();
    let json_length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    let json = String::from_utf8(glb[20..20 + json_length].to_vec()).unwrap();
    let buffer = glb[28 + json_length..].to_vec();
    let beside = json.replace("\"buffers\":[{", "\"buffers\":[{\"uri\":\"a%20b.bin\",");
    let resolve = |name: &str| (name == "a b.bin").then(|| buffer.clone());
    let gltf = |text: &str| read(Format::Gltf, text.as_bytes(), &LoadOptions::default(), &resolve);
    assert_eq!(gltf(&beside).unwrap().0, mesh);
    assert!(load(Format::Gltf, beside.as_bytes(), &as_is()).unwrap_err().to_string().contains("cannot be found"));
    let nodes = "\"nodes\":[{\"children\":[1],\"translation\":[1,2,3]},{\"mesh\":0,\"scale\":[-1,2,2]}]";
    let (placed, _) = gltf(&beside.replace("\"nodes\":[{\"mesh\":0}]", nodes)).unwrap();
    assert_eq!(placed.positions, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 2.0, 3.0), Vec3::new(1.0, 4.0, 3.0)]);
    assert_eq!(placed.cells, [[0, 2, 1].map(VertexId)]);
    let cycle = beside.replace("\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"children\":[0]}]");
    assert!(gltf(&cycle).unwrap_err().to_string().contains("node 0"));
    let draco = beside.replacen('{', "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],", 1);
    assert!(gltf(&draco).unwrap_err().to_string().contains("KHR_draco_mesh_compression"));
    let fan = beside.replace("\"indices\":1", "\"mode\":6");
    assert_eq!(gltf(&fan).unwrap().0, mesh);
    let lines = beside.replace("\"indices\":1", "\"mode\":1");
    assert!(gltf(&lines).unwrap_err().to_string().contains("no triangles"));
}

/// The folder that `MT_DATA` names, or a plain word that the test did not run.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("MT_DATA").map(PathBuf::from);
    if folder.is_none() {
        println!("MT_DATA not set: skipped the test on real files");
    }
    folder
}

struct Known {
    path: String,
    columns: BTreeMap<String, String>,
}

impl Known {
    fn number(&self, column: &str) -> Option<usize> {
        self.columns.get(column)?.parse().ok()
    }
}

fn manifest(data: &std::path::Path, folder: &str) -> Vec<Known> {
    let text = std::fs::read_to_string(data.join("MANIFEST.tsv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    let rows = lines.map(|line| {
        names.iter().map(|n| n.to_string()).zip(line.split('\t').map(str::to_string)).collect::<BTreeMap<_, _>>()
    });
    rows.map(|columns| Known { path: columns["path"].clone(), columns })
        .filter(|known| known.path.starts_with(folder))
        .collect()
}

fn format_of(path: &str) -> Option<Format> {
    Format::from_extension(path.rsplit('.').next()?)
}

fn load_file(data: &std::path::Path, path: &str, options: &LoadOptions) -> Result<(Mesh<3>, LoadReport), ReadError> {
    let bytes = std::fs::read(data.join(path)).unwrap();
    let folder = data.join(path).parent().unwrap().to_path_buf();
    read(format_of(path).unwrap(), &bytes, options, &|name| std::fs::read(folder.join(name)).ok())
}

#[test]
fn real_surfaces_have_their_known_counts() {
    let Some(data) = data() else { return };
    for known in manifest(&data, "surfaces/") {
        let (mesh, report) = load_file(&data, &known.path, &as_is()).unwrap_or_else(|e| panic!("{}: {e}", known.path));
        println!("{}\n{report}", known.path);
        compare(&known, &report);
        let (_, split) =
            load_file(&data, &known.path, &LoadOptions { weld: true, non_manifold: NonManifold::Split }).unwrap();
        assert!(split.census.is_manifold(), "{}", known.path);
        assert_eq!(census(&mesh), report.census);
    }
}

/// Counts that the manifest gives. Its edges leave out faces that repeat a vertex and count duplicates,
/// its polygons are whole, so not all of them apply to every file.
fn compare(known: &Known, report: &LoadReport) {
    let path = &known.path;
    let Census { components, boundary_edges, boundary_loops, genus, .. } = &report.census;
    if !path.ends_with(".glb") {
        assert_eq!(Some(report.vertices_written), known.number("vertices"), "{path}");
        assert_eq!(Some(report.faces_written), known.number("faces"), "{path}");
        assert_eq!(Some(*components), known.number("components"), "{path}");
        assert_eq!(Some(report.duplicate_triangles.count), known.number("duplicate_faces"), "{path}");
    }
    if report.degenerate_triangles.count + report.duplicate_triangles.count == 0 && known.number("components").is_some()
    {
        assert_eq!(Some(report.unused_vertices), known.number("unused_vertices"), "{path}");
        assert_eq!(Some(*boundary_edges), known.number("boundary_edges"), "{path}");
        assert_eq!(Some(*boundary_loops), known.number("boundary_loops"), "{path}");
        assert_eq!(Some(report.census.non_manifold_edges.count), known.number("nonmanifold_edges"), "{path}");
        assert_eq!(Some(report.census.non_manifold_vertices.count), known.number("nonmanifold_vertices"), "{path}");
        assert_eq!(genus.map(|g| g as usize), known.number("genus"), "{path}");
    }
}
