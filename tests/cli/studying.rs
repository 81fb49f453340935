//! `mtess study`: a folder with every figure in it, and a page that needs nothing else.

use crate::kit::Room;
use mt_core::generate;
use std::collections::BTreeSet;

const HEADER: &str = "model,operator,dependency,criterion,strategy,frame,vertices,triangles,refined,coarsened,forced,\
    chain_p95,chain_max,fan_steps,edge_steps,changed,touched,folds,seconds";
/// What the tests choose where a few of each will do.
const SMALL: &str = "--frames 2 --operators edge-collapse,fan-merge --dependencies cells,implicit-ids \
    --criteria uniform,budget --strategies top-down,incremental";

#[test]
fn a_study_writes_its_report() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(3, 0.1, 5));
    let lists = "--operators edge-collapse,half-edge-collapse --dependencies cells,dual-piece";
    let told = room.good(&format!("study ball.ply --frames 3 -o report {lists}"));
    assert!(told.out.contains("index.html"), "{}", told.out);
    let csv = room.text("report/results.csv");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == HEADER.split(',').count()), "{csv}");
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<BTreeSet<_>>();
    assert_eq!(column(0), ["ball"].into());
    assert_eq!(column(1), ["edge-collapse", "half-edge-collapse"].into());
    assert_eq!(column(2), ["cells", "dual-piece"].into());
    assert_eq!(column(3), ["budget", "region", "screen", "uniform"].into());
    assert_eq!(column(4), ["incremental", "priority", "top-down"].into());
    assert_eq!(column(5), ["0", "1", "2"].into());
    // Four criteria by three strategies, but the budget by two; three frames, two operators, two dependencies.
    assert_eq!(rows.len(), 11 * 3 * 2 * 2);
    same_counts(&rows);

    let json: serde_json::Value = serde_json::from_slice(&room.read("report/results.json")).unwrap();
    assert_eq!(json["observations"].as_array().unwrap().len(), rows.len());
    assert_eq!(json["frames"], 3);
    stands_alone(&room.text("report/index.html"));
    let report = std::fs::read_dir(room.path("report")).unwrap();
    let left = report.filter(|entry| entry.as_ref().unwrap().path().to_string_lossy().ends_with(".part")).count();
    assert_eq!(left, 0);
    assert_eq!(room.files(), ["ball.ply", "report"]);
}

/// Whatever the strategy, a criterion has one answer.
fn same_counts(rows: &[Vec<&str>]) {
    for one in rows {
        for other in rows {
            if (one[1], one[2], one[3], one[5]) == (other[1], other[2], other[3], other[5]) {
                assert_eq!(one[7], other[7], "{one:?} {other:?}");
            }
        }
    }
}

/// Nothing in the page is loaded from elsewhere: not from the network, and not from beside it.
fn stands_alone(page: &str) {
    assert!(page.contains("<html") && page.contains("</html>"), "a whole page");
    for mark in ["src=", "href=", "url("] {
        for (at, _) in page.match_indices(mark) {
            let value = page[at + mark.len()..].trim_start_matches(['"', '\'']);
            let inside = value.starts_with("data:") || value.starts_with('#');
            assert!(inside, "{mark}{}", &value[..value.len().min(60)]);
        }
    }
    // A namespace is a name that looks like an address; nobody goes there.
    let names = page.replace("http://www.w3.org/2000/svg", "").replace("http://www.w3.org/1999/xlink", "");
    for mark in ["http:", "https:", "@import", "<link", "<iframe"] {
        assert!(!names.contains(mark), "{mark} in the page");
    }
}

#[test]
fn what_cannot_be_studied_is_refused_before_anything_is_written() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 5));
    room.write("bad.ply", "ply\nnothing");
    room.refused("study bad.ply -o report", "bad.ply");
    room.refused("study missing.ply -o report", "missing.ply");
    std::fs::create_dir(room.path("other")).unwrap();
    room.put("other/ball.ply", &generate::triangle());
    let told = room.run("study ball.ply other/ball.ply -o report");
    assert_eq!(told.code, Some(1), "{told:?}");
    assert!(told.err.lines().last().unwrap().starts_with("error: other/ball.ply"), "{told:?}");
    assert_eq!(room.files(), ["bad.ply", "ball.ply", "other"]);

    // Taken for a folder, but a file is there.
    let told = room.run("study ball.ply -o bad.ply --frames 1");
    assert_eq!(told.code, Some(1));
    assert!(told.err.lines().last().unwrap().starts_with("error: bad.ply"), "{told:?}");
}

#[test]
fn sheets_are_refused_by_file_with_a_way_out_or_split() {
    let room = Room::new();
    room.put("fan3.obj", &generate::fan3());
    let told = room.run("study fan3.obj --frames 1 -o report");
    let errors: Vec<_> = told.err.lines().filter(|line| line.starts_with("error:")).collect();
    assert_eq!((told.code, errors.len()), (Some(1), 1), "{told:?}");
    assert!(errors[0].contains("fan3.obj") && errors[0].contains("--split-non-manifold"), "{told:?}");
    assert_eq!(room.files(), ["fan3.obj"]);
    room.good("study fan3.obj --frames 1 -o report --split-non-manifold");
}

/// The rows of a report without the last column, which tells seconds.
fn numbers(room: &Room) -> Vec<String> {
    let csv = room.text("report/results.csv");
    csv.lines().map(|line| line.rsplit_once(',').expect("columns").0.to_owned()).collect()
}

#[test]
fn a_study_combines_its_lists() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 5));
    room.good(&format!("study ball.ply -o report {SMALL}"));
    let rows = numbers(&room);
    let column = |i: usize| {
        rows[1..].iter().map(|row| row.split(',').nth(i).expect("a column").to_owned()).collect::<BTreeSet<_>>()
    };
    let wanted = [
        (1, ["edge-collapse", "fan-merge"]),
        (2, ["cells", "implicit-ids"]),
        (3, ["budget", "uniform"]),
        (4, ["incremental", "top-down"]),
        (5, ["0", "1"]),
    ];
    for (i, names) in wanted {
        assert_eq!(column(i), names.map(str::to_owned).into());
    }
    // A name given twice counts once.
    room.good(&format!("study ball.ply -o report {}", SMALL.replace("uniform,budget", "uniform,budget,uniform")));
    assert_eq!(numbers(&room), rows);
}

#[test]
fn a_second_study_finds_what_the_first_has_built() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 5));
    let study = |more: &str| room.good(&format!("study ball.ply -o report {SMALL} {more}")).out;
    let found = |told: &str| told.matches("(built before)").count();
    assert_eq!(found(&study("")), 0);
    let first = numbers(&room);
    assert_eq!(found(&study("")), 2);
    assert_eq!(numbers(&room), first);
    assert_eq!(found(&study("--no-cache")), 0);
    assert_eq!(numbers(&room), first);
    // Another mesh under the same name is another model.
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 6));
    assert_eq!(found(&study("")), 0);
    assert_ne!(numbers(&room), first);
}

#[test]
fn what_was_built_and_is_damaged_is_built_again() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(2, 0.1, 5));
    let study = || room.good(&format!("study ball.ply -o report {SMALL}")).out.matches("(built before)").count();
    assert_eq!(study(), 0);
    let first = numbers(&room);
    let built = std::fs::read_dir(room.path("report/built")).expect("a folder of what was built");
    let path = built.map(|entry| entry.expect("an entry").path()).min().expect("two files");
    let name = path.strip_prefix(room.path("")).expect("below the room").to_string_lossy().into_owned();
    let good = room.read(&name);
    let flipped = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    let longer = [good.as_slice(), b"more"].concat();
    let damaged = [vec![], b"{}".to_vec(), good[..good.len() / 2].to_vec(), good[..good.len() - 1].to_vec(), longer];
    let places = [0, good.len() / 4, good.len() / 2, good.len() - 200, good.len() - 1];
    for bytes in damaged.into_iter().chain(places.map(flipped)) {
        room.write(&name, bytes);
        assert_eq!(study(), 1, "one of two is damaged");
        assert_eq!(numbers(&room), first);
        assert_eq!(study(), 2, "and was made good");
    }
}

/// What the report says of a picture makes that picture.
#[test]
fn the_command_of_a_picture_makes_it() {
    let room = Room::new();
    room.put("ball.ply", &generate::bumpy_sphere(3, 0.1, 5));
    for folder in ["report", "other"] {
        room.good(&format!("study ball.ply -o {folder} {SMALL}"));
    }
    let json: serde_json::Value = serde_json::from_slice(&room.read("report/results.json")).unwrap();
    let pictures = json["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 4);
    for picture in pictures {
        let name = picture["name"].as_str().unwrap();
        let command = picture["command"].as_str().unwrap();
        assert!(room.text("report/index.html").contains("mtess render ball.mt --"), "the page has it");
        for line in command.lines() {
            // The command is for somebody in the folder of the report.
            let line = line.strip_prefix("mtess ").unwrap();
            let told = room.command(line).current_dir(room.path("report")).output().unwrap();
            assert!(told.status.success(), "{line}: {}", String::from_utf8_lossy(&told.stderr));
        }
        let again = room.read(&format!("report/{name}"));
        assert!(again == room.read(&format!("other/{name}")), "{name} by {command}");
    }
}
