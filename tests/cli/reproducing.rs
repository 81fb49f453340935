//! `mtess paper`: what there is, one item, a paper, and names that are none.

use crate::kit::Room;

#[test]
fn what_there_is_is_listed() {
    let told = Room::new().good("paper");
    for name in ["fan-hierarchy", "table-3", "truly-selective", "generalized", "multi-tessellation", "strips"] {
        assert!(told.out.contains(name), "{name}: {}", told.out);
    }
}

#[test]
fn an_item_is_text_tables_and_pictures() {
    let room = Room::new();
    let told = room.good("paper fan-hierarchy Fig.3 --small -o out");
    assert!(told.out.contains("read out/fan-hierarchy-figure-3.md"), "{}", told.out);
    let text = String::from_utf8(room.read("out/fan-hierarchy-figure-3.md")).unwrap();
    assert!(text.contains("| the paper says |") && text.contains("(fan-hierarchy-figure-3.svg)"), "{text}");
    assert!(room.read("out/fan-hierarchy-figure-3.csv").starts_with(b"\"vertices gone, %\""));
    assert!(room.read("out/fan-hierarchy-figure-3.svg").starts_with(b"<svg"));
    room.good("paper strips --small");
    assert!(room.path("paper/strips.md").is_file());
}

#[test]
fn wrong_names_and_places_are_refused() {
    let room = Room::new();
    room.refused("paper nobody --small", "nobody");
    room.refused("paper strips table-9 --small", "table-9");
    std::fs::write(room.path("file"), "").unwrap();
    room.refused("paper strips --small -o file", "file");
    std::fs::create_dir_all(room.path("taken/LEDGER.md")).unwrap();
    room.refused("paper --all --small -o taken", "LEDGER.md");
    let mut command = room.command("paper strips -o out");
    let output = command.env("MT_DATA", "nowhere").output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && told.starts_with("error: MT_DATA") && told.lines().count() == 1, "{told}");
}

/// A model without anything to coarsen is told of, and does not bring the program down.
#[test]
fn a_model_of_one_triangle_is_refused() {
    let room = Room::new();
    std::fs::create_dir_all(room.path("data/surfaces")).unwrap();
    std::fs::write(room.path("data/surfaces/cow.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let output = room.command("paper generalized implicit-ids -o out").env("MT_DATA", "data").output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("error: surfaces/cow.obj: there is nothing to coarsen in it"), "{told}");
}
