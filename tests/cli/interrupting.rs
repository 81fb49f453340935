//! Ctrl-C: an exit code that says so, and nothing half-written left behind.
#![cfg(unix)]

use crate::kit::Room;
use mt_core::generate;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Starts `mtess`, interrupts it after each of these pauses, and gives its exit code (none if a signal ended it), its
/// errors and the seconds it took to end.
fn interrupted(room: &Room, arguments: &str, pauses: &[Duration]) -> (Option<i32>, String, f64) {
    let mut command = room.command(arguments);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    for &pause in pauses {
        std::thread::sleep(pause);
        // Not yet waited for, so the number is still its own even if it has ended.
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(sent.expect("there is a kill").success());
    }
    let begun = Instant::now();
    let output = child.wait_with_output().expect("it ends");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), errors, begun.elapsed().as_secs_f64())
}

#[test]
fn an_interrupted_build_leaves_nothing() {
    let room = Room::new();
    room.put("terrain.ply", &generate::terrain(316, 0.5, 3));
    // Undisturbed first, to know when it is busy with what.
    let told = room.good("build terrain.ply -o terrain.mt --json").json();
    std::fs::remove_file(room.path("terrain.mt")).unwrap();
    let [load, analysis] = ["load_s", "analysis_s"].map(|key| told[key].as_f64().unwrap());
    let coarsening = load + 0.4 * analysis;
    for pauses in [vec![coarsening], vec![load * 0.5], vec![coarsening, 0.001]] {
        let durations: Vec<_> = pauses.iter().copied().map(Duration::from_secs_f64).collect();
        let (code, errors, seconds) = interrupted(&room, "build terrain.ply -o terrain.mt --json", &durations);
        assert_ne!(code, Some(0), "after {pauses:?} s: {errors}");
        assert!(!errors.contains("panicked"), "{errors}");
        assert!(seconds < 5.0, "it took {seconds:.1} s to hear");
        assert_eq!(room.files(), ["terrain.ply"], "after {pauses:?} s: {errors}");
        if pauses == [coarsening] {
            assert_eq!((code, errors.trim()), (Some(1), "error: interrupted; nothing was written"));
        }
    }
}

#[test]
fn an_interrupted_study_leaves_nothing() {
    let room = Room::new();
    room.put("terrain.ply", &generate::terrain(200, 0.5, 4));
    let (code, errors, _) = interrupted(&room, "study terrain.ply -o report", &[Duration::from_millis(150)]);
    assert_ne!(code, Some(0), "{errors}");
    assert!(!errors.contains("panicked"), "{errors}");
    assert_eq!(room.files(), ["terrain.ply"], "{errors}");
}

#[test]
fn whenever_it_is_interrupted_no_part_is_left() {
    let room = Room::new();
    room.put("terrain.ply", &generate::terrain(150, 0.5, 4));
    room.good("build terrain.ply -o terrain.mt");
    // Early and late, so that some of them meet it while it writes.
    for step in 0..24 {
        let pause = [Duration::from_millis(4 * step)];
        let (code, errors, _) = interrupted(&room, "extract terrain.mt --reference -o out.obj --json", &pause);
        assert!(!errors.contains("panicked"), "{errors}");
        let whole = room.files().contains(&"out.obj".to_owned());
        assert!(whole || code != Some(0), "it says it went well, and nothing is there");
        let part = room.files().into_iter().find(|name| name.ends_with(".part"));
        assert_eq!(part, None, "interrupted after {} ms", 4 * step);
        if whole {
            assert_eq!(room.mesh("out.obj").cell_count(), 2 * 150 * 150, "whole or not at all");
            std::fs::remove_file(room.path("out.obj")).unwrap();
        }
    }
}
