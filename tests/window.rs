//! The window, driven by keys and mouse on a display that nobody sees: what is saved from it tells what it did.
//!
//! Wants `Xvfb`, `xdotool` and an adapter; says plainly where it does without. `MT_REQUIRE_GPU=1` makes them a must.

use multi_tessellation::mt_core::format::{Format, write};
use multi_tessellation::mt_core::{Mesh, generate};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A display of its own.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts one, if the programs are there.
    fn start() -> Option<Self> {
        let made = Self::try_start();
        if let Err(why) = &made {
            assert!(std::env::var_os("MT_REQUIRE_GPU").is_none_or(|value| value != "1"), "no display: {why}");
            println!("skipped: no display to test the window on: {why}");
        }
        made.ok()
    }

    fn try_start() -> Result<Self, String> {
        let missing = |name: &str, error: std::io::Error| format!("{name}: {error}");
        Command::new("xdotool").arg("version").output().map_err(|error| missing("xdotool", error))?;
        multi_tessellation::render::Stage::new().map_err(|error| error.to_string())?;
        // The server picks a free number and writes it.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1200x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| missing("Xvfb", error))?;
        let mut number = String::new();
        let out = server.stdout.take().expect("it is piped");
        BufReader::new(out).read_line(&mut number).map_err(|error| missing("Xvfb", error))?;
        Ok(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        _ = self.server.kill();
        _ = self.server.wait();
    }
}

/// A window on a model, and the folder in which it saves.
struct Window<'a> {
    display: &'a Display,
    folder: PathBuf,
    process: Child,
    id: String,
    /// Pictures saved so far.
    saved: u32,
    stem: &'static str,
}

fn mtess() -> Command {
    Command::new(env!("CARGO_BIN_EXE_mtess"))
}

impl<'a> Window<'a> {
    /// Opens `model.obj` of a folder, and waits for its first frame.
    fn open(display: &'a Display, folder: &Path, more: &[&str]) -> Self {
        let process = mtess()
            .args(["view", "model.obj"])
            .args(more)
            .current_dir(folder)
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_DATA_HOME", folder.join("data"))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command starts");
        let mut window =
            Self { display, folder: folder.to_owned(), process, id: String::new(), saved: 0, stem: "model-picture" };
        window.find();
        window
    }

    /// Finds the window and gives it the keyboard.
    fn find(&mut self) {
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            let found = self.tool(&["search", "--name", "mtess view"]);
            if let Some(id) = String::from_utf8_lossy(&found.stdout).lines().next() {
                self.id = id.to_owned();
                // Refused as long as it is not on the screen.
                if self.tool(&["windowfocus", &self.id]).status.success() {
                    return;
                }
            }
            assert_eq!(self.process.try_wait().expect("a process"), None, "it ended before there was a window");
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("no window came");
    }

    fn tool(&self, words: &[&str]) -> Output {
        Command::new("xdotool").args(words).env("DISPLAY", &self.display.name).output().expect("xdotool runs")
    }

    fn key(&self, key: &str) {
        assert!(self.tool(&["key", key]).status.success(), "{key}");
    }

    /// Holds a key down for some frames.
    fn hold(&self, key: &str) {
        self.tool(&["keydown", key]);
        std::thread::sleep(Duration::from_millis(600));
        self.tool(&["keyup", key]);
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Saves the picture and gives what is told of it. A key may come before the window hears any: then again.
    fn picture(&mut self) -> Value {
        self.saved += 1;
        let path = self.path("json");
        let begun = Instant::now();
        'again: while begun.elapsed() < PATIENCE {
            self.key("p");
            for _ in 0..60 {
                std::thread::sleep(Duration::from_millis(50));
                let text = std::fs::read(&path).ok();
                if let Some(told) = text.and_then(|text| serde_json::from_slice(&text).ok()) {
                    // The camera comes after it.
                    if !self.path("camera.json").exists() {
                        continue;
                    }
                    // Pictures that a second key made count as well.
                    while self.numbered(self.saved + 1, "json").exists() {
                        self.saved += 1;
                    }
                    return told;
                }
            }
            self.find();
            continue 'again;
        }
        panic!("no picture was saved");
    }

    /// Saves pictures until what is told of one is as it should be.
    fn picture_where(&mut self, holds: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let told = self.picture();
            if holds(&told) {
                return told;
            }
            assert!(begun.elapsed() < PATIENCE, "it never came to that: {told:#}");
        }
    }

    fn numbered(&self, number: u32, ending: &str) -> PathBuf {
        self.folder.join(format!("{}-{number:03}.{ending}", self.stem))
    }

    fn path(&self, ending: &str) -> PathBuf {
        self.numbered(self.saved, ending)
    }

    fn pixels(&self) -> (u32, u32, Vec<u8>) {
        read_png(&self.path("png"))
    }

    /// Closes it by its key; what it said.
    fn close(mut self) -> String {
        let begun = Instant::now();
        while self.process.try_wait().expect("a process").is_none() {
            assert!(begun.elapsed() < PATIENCE, "it does not close");
            self.key("shift+q");
            std::thread::sleep(Duration::from_millis(300));
        }
        let mut told = String::new();
        let out = self.process.stdout.take().expect("it is piped");
        BufReader::new(out).lines().map_while(Result::ok).for_each(|line| told.push_str(&line));
        assert!(self.process.wait().expect("a process").success());
        told
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        _ = self.process.kill();
        _ = self.process.wait();
    }
}

fn read_png(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a png");
    let mut pixels = vec![0; reader.output_buffer_size().expect("it has a size")];
    let info = reader.next_frame(&mut pixels).expect("a frame");
    (info.width, info.height, pixels)
}

fn folder_with(mesh: &Mesh<3>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = write(Format::Obj, mesh).expect("a mesh");
    std::fs::write(folder.path().join("model.obj"), bytes).expect("it can be written");
    folder
}

#[test]
fn a_visit() {
    let Some(display) = Display::start() else { return };
    let folder = folder_with(&generate::genus_surface(2, 14, 0.02, 7));
    let mut window = Window::open(&display, folder.path(), &["--pixels", "2"]);

    let first = window.picture();
    let before = window.pixels();
    assert!(first["triangles"].as_u64() > Some(100) && first["triangles"].as_u64() < first["triangles_in"].as_u64());
    assert_eq!((&first["dependency"], &first["frozen"]), (&"dual-piece".into(), &false.into()));

    // Orbit, and what the window shows is what the command draws.
    window.hold("Left");
    let turned = window.picture();
    assert_ne!(turned["camera"]["eye"], first["camera"]["eye"]);
    assert_ne!(window.pixels().2, before.2);
    same_as_command(&window, &turned);

    freeze_and_come_back(&mut window, &turned);
    other_views(&mut window, &turned);

    let told = window.close();
    assert!(told.contains("closed at"), "{told}");
    let remembered = std::fs::read_dir(folder.path().join("data/mtess")).expect("the window is remembered");
    assert!(remembered.count() > 0);
}

/// Freeze, and leave: the eye and the mesh stay. All overlays are those of the command.
fn freeze_and_come_back(window: &mut Window<'_>, turned: &Value) {
    window.key("f");
    window.hold("Up");
    let frozen = window.picture_where(|told| told["frozen"] == true);
    assert_ne!(frozen["camera"]["eye"], turned["camera"]["eye"]);
    assert_eq!((&frozen["eye"]["eye"], &frozen["triangles"]), (&turned["camera"]["eye"], &turned["triangles"]));
    window.key("shift+w");
    window.key("o");
    let wired = window.picture_where(|told| told["shown"]["wireframe"] == true && told["shown"]["outline"] == true);
    same_as_command(window, &wired);
    window.key("u");
    let pieces = window.picture_where(|told| told["shown"]["pieces"] == true);
    same_as_command(window, &pieces);
    window.key("u");
    window.key("o");
    window.key("t");
    let errors = window.picture_where(|told| told["shown"]["tint"] == "error" && told["shown"]["pieces"] == false);
    same_as_command(window, &errors);
    window.key("f");
    let back = window.picture_where(|told| told["frozen"] == false);
    assert_eq!(back["camera"]["eye"], turned["camera"]["eye"]);
}

/// Another scheme on the same model, seen from the same place; a step in time; what is pointed at; another size.
fn other_views(window: &mut Window<'_>, turned: &Value) {
    window.key("n");
    let other = window.picture_where(|told| told["dependency"] != "dual-piece");
    assert_eq!(other["camera"], turned["camera"]);
    assert_eq!(other["triangles_in"], turned["triangles_in"]);

    // One step back in time, and to the present again.
    assert_eq!(other["steps_taken"], other["steps_in_log"]);
    window.key("comma");
    let past = window.picture_where(|told| told["steps_taken"] != told["steps_in_log"]);
    assert_eq!(past["steps_taken"].as_u64(), other["steps_in_log"].as_u64().map(|steps| steps - 1));
    assert_ne!(past["triangles"], other["triangles"]);
    window.key("Return");
    window.picture_where(|told| told["steps_taken"] == told["steps_in_log"]);

    // Point at what is in the middle of the picture.
    let [width, height] = ["width_px", "height_px"].map(|side| other["camera"][side].as_u64().expect("a size"));
    window.tool(&["mousemove", "--window", &window.id, &(286 + width / 4).to_string(), &(height / 2).to_string()]);
    let mut hits = (1..9).map(|eighth| {
        let x = (290 + width * eighth / 9).to_string();
        window.tool(&["mousemove", "--window", &window.id, &x, &(height / 2).to_string(), "click", "1"]);
        std::thread::sleep(Duration::from_millis(400));
        let told = window.picture();
        told["picked"]["cell"].is_u64() && told["picked"]["refined_by"].is_u64()
    });
    assert!(hits.any(|hit| hit), "nothing was hit");
    drop(hits);

    // A smaller window has smaller pictures.
    window.tool(&["windowsize", "--sync", &window.id, "800", "600"]);
    window.picture_where(|told| told["camera"]["width_px"].as_u64() < Some(width));
}

/// Runs the command that is told of a picture, and compares.
fn same_as_command(window: &Window<'_>, told: &Value) {
    let stem = format!("{}-{:03}", window.stem, window.saved);
    let command = told["command"].as_str().expect("a command");
    let words = command.split_whitespace().skip(1);
    let made = mtess().args(words).current_dir(&window.folder).output().expect("the command runs");
    assert!(made.status.success(), "{command}: {}", String::from_utf8_lossy(&made.stderr));
    let (ours, theirs) = (window.pixels(), read_png(&window.folder.join(format!("{stem}.again.png"))));
    assert_eq!((ours.0, ours.1), (theirs.0, theirs.1));
    let differs = |(a, b): (&[u8], &[u8])| (0..3).any(|c| a[c].abs_diff(b[c]) > 8);
    let count = ours.2.chunks_exact(4).zip(theirs.2.chunks_exact(4)).filter(|&pair| differs(pair)).count();
    assert!(count * 500 < ours.2.len() / 4, "{command}: {count} pixels differ");
}

#[test]
fn a_lost_device_is_replaced() {
    let Some(display) = Display::start() else { return };
    let folder = folder_with(&generate::sphere(3));
    let mut window = Window::open(&display, folder.path(), &["--lose-device-after", "40"]);
    let first = window.id.clone();
    let begun = Instant::now();
    while window.id == first {
        assert!(begun.elapsed() < PATIENCE, "no other window came");
        std::thread::sleep(Duration::from_millis(100));
        window.find();
    }
    let told = window.picture();
    assert!(told["triangles"].as_u64() > Some(10));
    let (_, _, pixels) = window.pixels();
    // The model is there, not the ground alone.
    let dark = pixels.chunks_exact(4).filter(|pixel| pixel[0] < 180).count();
    assert!(dark > 500, "{dark}");
    window.close();
}

#[test]
fn a_model_of_one_triangle_is_shown() {
    let Some(display) = Display::start() else { return };
    let folder = folder_with(&generate::triangle());
    let mut window = Window::open(&display, folder.path(), &[]);
    window.hold("Left");
    assert_eq!(window.picture()["triangles"], 1);
    ["t", "t", "b", "o", "u", "n", "c", "i"].iter().for_each(|key| window.key(key));
    window.picture();
    window.close();
}

/// What cannot be opened is refused in a line before there is a window.
#[test]
fn what_is_no_model_is_refused() {
    let folder = folder_with(&generate::triangle());
    std::fs::write(folder.path().join("none.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    std::fs::write(folder.path().join("cameras.json"), "[{\"eye\": [0, 0, null]}]").unwrap();
    let tries: [(&[&str], &str); 7] = [
        (&["none.obj"], "none.obj"),
        (&["missing.mt"], "missing.mt: no such file"),
        (&["model.obj", "--cameras", "cameras.json"], "cameras.json"),
        (&["model.obj", "--pixels", "0"], "--pixels"),
        (&["model.obj", "-o", "none.obj"], "none.obj"),
        (&["model.obj", "--dependency", "two-ring"], "two-ring"),
        (&["model.obj", "model.obj", "--beside", "cells"], "two panes"),
    ];
    for (words, says) in tries {
        let told = mtess().arg("view").args(words).current_dir(folder.path()).output().expect("the command runs");
        let text = String::from_utf8_lossy(&told.stderr).into_owned();
        assert!(!told.status.success() && text.contains(says) && !text.contains("panicked"), "{words:?}: {text}");
    }
}

#[test]
fn without_a_display_it_says_so() {
    let folder = folder_with(&generate::triangle());
    let mut command = mtess();
    command.args(["view", "model.obj"]).current_dir(folder.path());
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().for_each(|name| _ = command.env_remove(name));
    if cfg!(target_os = "linux") {
        let told = command.output().expect("the command runs");
        let text = String::from_utf8_lossy(&told.stderr).into_owned();
        let last = text.lines().last().unwrap_or_default();
        assert!(!told.status.success() && last.starts_with("error: no window can be opened: "), "{text}");
        assert!(last.contains("mtess render") && !last.contains(".rs:"), "{text}");
    }
}
