//! What every reader is held to, whatever bytes it is given: it refuses or gives something that holds together, that can
//! be walked, and that comes back when it is written and read again. Fuzzers and plain tests call the same functions.

use mt_core::container::{self, Archive, Container, Meta, Storage};
use mt_core::format::{self, Format, LoadOptions};
use mt_core::hierarchy::Story;
use mt_core::log::Log;
use mt_core::model::{MultiTessellation, Step, take};
use mt_core::{Camera, Cell, Explicit, Front, Mesh, NodeId, Replay, Sequence, check, generate, history};

/// A mesh format: what is read is a mesh, and what is written of it is read as the same.
pub fn mesh(format: Format, bytes: &[u8]) {
    for weld in [true, false] {
        let options = LoadOptions { weld, ..LoadOptions::default() };
        let Ok((mesh, _)) = format::read(format, bytes, &options, &|_| None) else { continue };
        assert!(!mesh.cells.is_empty() && mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.cells.iter().flatten().all(|v| v.index() < mesh.vertex_count()));
        assert_eq!(mesh.compact(), mesh, "a vertex without a triangle");
        let Ok(written) = format::write(Format::Ply, &mesh) else { continue };
        let again = format::read(Format::Ply, &written, &options, &|_| None).expect("what was written can be read").0;
        assert_eq!(bits(&again), bits(&mesh), "PLY keeps meshes bit for bit");
    }
}

fn bits(mesh: &Mesh<3>) -> (Vec<[u32; 3]>, &[Cell<3>]) {
    (mesh.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect(), &mesh.cells)
}

/// The container, with checksums mended first: else no altered byte would get past them.
pub fn container(bytes: &[u8]) {
    for bytes in [bytes.to_vec(), resealed(bytes)] {
        piecemeal(&bytes);
        let Ok(opened) = container::open(&bytes) else { continue };
        match (&opened.meta().dependency, opened.meta().corners) {
            (Some(_), _) => story(opened),
            (None, 4) => model::<4>(&bytes),
            (None, _) => model::<3>(&bytes),
        }
    }
}

/// Section by section: what can be read whole can be read so.
fn piecemeal(bytes: &[u8]) {
    let whole = container::open(bytes).is_ok();
    let Ok(mut archive) = Archive::open(std::io::Cursor::new(bytes)) else { return assert!(!whole) };
    let sections: Vec<_> = archive.sections().collect();
    for section in sections {
        let Ok(name) = <[u8; 4]>::try_from(section.name.as_bytes()) else { continue };
        let read = archive.section(&name).map(|bytes| bytes.len() as u64);
        // Two sections may have one name, of which the first is meant.
        assert!(read.is_ok() || !whole || section.stored > 0, "{}: {read:?}", section.name);
    }
}

/// The story of a hierarchy: if it replays, there and back, and comes back when it is written.
fn story(opened: Container<'_>) {
    let Ok((story, meta)) = opened.story() else { return };
    let Ok(replay) = story.replay() else { return };
    let mut mesh = replay.reference_mesh();
    (0..replay.len()).for_each(|m| replay.coarsen(NodeId(m), &mut mesh, &mut ()));
    (0..replay.len()).rev().for_each(|m| replay.refine(NodeId(m), &mut mesh, &mut ()));
    assert!(mesh == replay.reference_mesh(), "there and back is somewhere else");
    for storage in [Storage::Plain, Storage::Packed] {
        let mut bytes = Vec::new();
        container::write_story(&story, "dual-piece", &meta, storage, &mut bytes).expect("memory takes it");
        let again = container::open(&bytes).and_then(Container::story).expect("what was written can be read").0;
        // By bytes, since positions may be numbers that differ from themselves.
        assert!(again.sequence.to_bytes() == story.sequence.to_bytes() && again.mesh.cells == story.mesh.cells);
    }
}

fn model<const N: usize>(bytes: &[u8]) {
    let Ok((model, meta)) = container::read::<N>(bytes) else { return };
    walk(&model);
    let written = written(&model, &meta);
    let (again, _) = container::read::<N>(&written).expect("what was written can be read");
    assert!(parts_bits(&again) == parts_bits(&model), "containers keep models bit for bit");
}

fn written<const N: usize>(model: &Explicit<N>, meta: &Meta) -> Vec<u8> {
    let mut bytes = Vec::new();
    container::write(model, meta, &mut bytes).expect("memory takes it");
    bytes
}

/// All there is of a model, as its container has it.
fn parts_bits<const N: usize>(model: &Explicit<N>) -> Vec<u8> {
    written(model, &Meta::default())
}

/// From the base mesh to the input and back; no step panics, and both ends are what they were.
fn walk<const N: usize>(model: &Explicit<N>) {
    let mut view = model.base_view();
    let base = view.clone();
    (0..model.len()).rev().for_each(|m| take(model, Step::refine(NodeId(m)), &mut view, &mut ()));
    assert_eq!(model.cell_count(&view.mesh), model.input_cell_count());
    (0..model.len()).for_each(|m| take(model, Step::coarsen(NodeId(m)), &mut view, &mut ()));
    assert!(view == base, "there and back is somewhere else");
}

/// The bytes with every checksum that fits what they are: sections that the table has, and the head.
pub fn resealed(bytes: &[u8]) -> Vec<u8> {
    const HEAD: usize = 24;
    let mut bytes = bytes.to_vec();
    let word = |bytes: &[u8], at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes(b.try_into().expect("four")));
    let long =
        |bytes: &[u8], at: usize| bytes.get(at..at + 8).map(|b| u64::from_le_bytes(b.try_into().expect("eight")));
    let Some(count) = word(&bytes, 12).filter(|&count| count <= 64) else { return bytes };
    let entry_len = if word(&bytes, 8) == Some(1) { 24 } else { 40 };
    for i in 0..count as usize {
        let entry = HEAD + entry_len * i;
        let (Some(from), Some(length)) = (long(&bytes, entry + 8), long(&bytes, entry + 16)) else { return bytes };
        let end = from.checked_add(length).filter(|&end| end <= bytes.len() as u64);
        if let Some(end) = end {
            let sum = crc32fast::hash(&bytes[from as usize..end as usize]);
            bytes[entry + 4..entry + 8].copy_from_slice(&sum.to_le_bytes());
        }
    }
    let table_end = HEAD + entry_len * count as usize;
    if bytes.len() >= table_end + 4 {
        let sum = crc32fast::hash(&bytes[..table_end]);
        bytes[table_end..table_end + 4].copy_from_slice(&sum.to_le_bytes());
    }
    bytes
}

/// A history of a mesh, as text: of a few meshes, since the first line says how large the mesh is.
pub fn history(bytes: &[u8]) {
    for mesh in [generate::octahedron(), generate::strip(4), generate::grid(3, 3)] {
        let Ok(model) = history::read(&mesh, bytes) else { continue };
        walk(&model);
        let mut text = Vec::new();
        history::write(&model, &mut text).expect("memory takes it");
        let again = history::read(&mesh, text.as_slice()).expect("what was written can be read");
        assert!(parts_bits(&again) == parts_bits(&model), "text keeps models");
    }
    if let Ok(model) = history::read(&generate::tetrahedral_box(1), bytes) {
        walk(&model);
    }
}

/// The steps of a view, as text: what is read is written the same, and a model follows it or says why not.
pub fn log(bytes: &[u8]) {
    let Ok(log) = Log::read(bytes) else { return };
    let mut text = Vec::new();
    log.write(&mut text).expect("memory takes it");
    assert_eq!(Log::read(text.as_slice()).expect("what was written can be read"), log);
    let model = crate::model_of(&generate::octahedron(), &operators::EdgeCollapse::FULL);
    if log.follow(&model).is_ok() {
        let mut timeline = mt_core::log::Timeline::new(&model, &log.steps);
        timeline.seek(log.steps.len(), &mut ());
        timeline.seek(0, &mut ());
        assert!(*timeline.view() == model.base_view());
    }
}

/// Merges as bytes, with the checksum mended: what is a sequence of a mesh replays as the quotient says.
pub fn sequence(bytes: &[u8]) {
    for bytes in [bytes.to_vec(), summed(bytes)] {
        let Ok(sequence) = Sequence::from_bytes(&bytes) else { continue };
        let again = Sequence::from_bytes(&sequence.to_bytes()).expect("what was written can be read");
        assert_eq!(again.to_bytes(), sequence.to_bytes());
        // Vertices of the input come from the mesh, so a large number of them is for the mesh to have.
        let mesh = match sequence.input_vertex_count {
            3..=64 => generate::strip(sequence.input_vertex_count as usize - 2),
            _ => continue,
        };
        let Ok(replay) = Replay::new(&mesh, &[], &sequence) else { continue };
        let mut mesh = replay.reference_mesh();
        let mut front = Front::reference(replay.len());
        for m in (0..replay.len()).map(NodeId) {
            replay.coarsen(m, &mut mesh, &mut ());
            front.set(m, false);
            let cells: Vec<_> = mesh.faces.cells().map(|(slot, cell)| (mt_core::CellId(slot), *cell)).collect();
            assert_eq!(cells, check::quotient(&replay, &front), "after node {m}");
        }
        (0..replay.len()).rev().for_each(|m| replay.refine(NodeId(m), &mut mesh, &mut ()));
        assert!(mesh == replay.reference_mesh(), "there and back is somewhere else");
    }
}

/// The bytes of a sequence with the checksum that fits what they are.
pub fn summed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if let Some(end) = bytes.len().checked_sub(4) {
        let sum = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
    }
    bytes
}

/// A camera, as JSON: one that passes its check asks of a model without a panic.
pub fn camera(bytes: &[u8]) {
    use selective::{Criterion, ScreenError};
    let Ok(camera) = serde_json::from_slice::<Camera>(bytes) else { return };
    if camera.check().is_err() {
        return;
    }
    let model = crate::model_of(&generate::octahedron(), &operators::EdgeCollapse::FULL);
    for error_px in [0.0, 1.0, f32::MAX] {
        let criterion = ScreenError::new(&camera, error_px);
        let excess = (0..model.len()).map(|m| criterion.excess(&model.bound(NodeId(m)), false));
        excess.for_each(|excess| assert!(!excess.is_nan(), "{camera:?} asks for no number"));
    }
}

/// Bytes that each of these takes, made from generated meshes: what fuzzers start from.
pub fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let mut seeds = Vec::new();
    for mesh in [generate::octahedron(), generate::strip(4), generate::fan3(), generate::hourglass()] {
        for (name, format) in [
            ("obj", Format::Obj),
            ("ply", Format::Ply),
            ("stl", Format::Stl),
            ("off", Format::Off),
            ("gltf", Format::Glb),
        ] {
            seeds.push((name, format::write(format, &mesh).expect("small meshes can be written")));
        }
    }
    for mesh in [generate::octahedron(), generate::strip(4), generate::grid(3, 3)] {
        let model = crate::model_of(&mesh, &operators::EdgeCollapse::HALF);
        seeds.push(("container", written(&model, &Meta { operator: "seed".into(), ..Meta::default() })));
        let mut packed = Vec::new();
        container::write_as(&model, &Meta::default(), Storage::Packed, &mut packed).expect("memory takes it");
        seeds.push(("container", packed));
        let mut text = Vec::new();
        history::write(&model, &mut text).expect("memory takes it");
        seeds.push(("history", text));
        let (_, replay) = crate::both_of(&mesh, &operators::EdgeCollapse::HALF);
        let mut sequence = Sequence::with_input(replay.leaf_count());
        for f in 0..replay.merge_count() {
            let (merge, nodes) = (replay.merge(f), replay.run_of(f));
            let children = nodes.clone().into_inner();
            let nodes = || (children.0.0..=children.1.0).map(NodeId);
            let made = replay.positions()[(replay.leaf_count() + f) as usize];
            let errors = nodes().map(|m| replay.node(m).error);
            sequence.push(merge.center, nodes().map(|m| replay.node(m).child), errors, made, replay.keeps_center(f));
        }
        seeds.push(("sequence", sequence.to_bytes()));
        let story = Story { mesh, links: Vec::new(), sequence };
        for storage in [Storage::Plain, Storage::Packed] {
            let mut bytes = Vec::new();
            container::write_story(&story, "dual-piece", &Meta::default(), storage, &mut bytes)
                .expect("memory takes it");
            seeds.push(("container", bytes));
        }
    }
    let (mesh, mut sequence) = (generate::octahedron(), Sequence::with_input(6));
    let [a, b, _] = mesh.cells[0];
    sequence.push(a, [b], [0.5], mesh.positions[a.index()], true);
    let story = Story { mesh, links: Vec::new(), sequence }.on_grid(0.25);
    let mut bytes = Vec::new();
    let meta = Meta { grid_step: Some(0.25), ..Meta::default() };
    container::write_story(&story, "one-ring", &meta, Storage::Packed, &mut bytes).expect("memory takes it");
    seeds.push(("container", bytes));
    let model = crate::model_of(&generate::octahedron(), &operators::EdgeCollapse::FULL);
    let mut log = Log::new(model.len());
    log.push(&(0..model.len()).rev().map(|m| Step::refine(NodeId(m))).collect::<Vec<_>>());
    log.push(&(0..model.len()).map(|m| Step::coarsen(NodeId(m))).collect::<Vec<_>>());
    let mut text = Vec::new();
    log.write(&mut text).expect("memory takes it");
    seeds.push(("log", text));
    let camera = Camera::around(glam::Vec3::ZERO, glam::Vec3::ONE, glam::Vec3::Z);
    seeds.push(("camera", serde_json::to_vec(&camera).expect("a camera is JSON")));
    seeds
}

/// The function of a target by its name.
pub fn by_name(name: &str) -> fn(&[u8]) {
    match name {
        "obj" => |bytes| mesh(Format::Obj, bytes),
        "ply" => |bytes| mesh(Format::Ply, bytes),
        "stl" => |bytes| mesh(Format::Stl, bytes),
        "off" => |bytes| mesh(Format::Off, bytes),
        "gltf" => |bytes| mesh(if bytes.starts_with(b"glTF") { Format::Glb } else { Format::Gltf }, bytes),
        "container" => container,
        "history" => history,
        "sequence" => sequence,
        "log" => log,
        "camera" => camera,
        _ => panic!("there is no target {name}"),
    }
}

/// The targets.
pub const TARGETS: [&str; 10] =
    ["obj", "ply", "stl", "off", "gltf", "container", "history", "sequence", "log", "camera"];
