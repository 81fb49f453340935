//! What the tests of the command share: a folder that goes away by itself, and the program run inside it.

use mt_core::container::{self, Meta};
use mt_core::format::{self, Format, LoadOptions};
use mt_core::{Camera, Explicit, Mesh, generate};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// What a run of the program said.
#[derive(Debug)]
pub struct Told {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Told {
    /// The JSON on standard output of a run that went well.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// A folder to run the program in, so that commands name files as they are.
pub struct Room(TempDir);

impl Room {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs `mtess` with these arguments, which are parted by spaces.
    pub fn run(&self, arguments: &str) -> Told {
        let output = self.command(arguments).output().expect("the program starts");
        Told {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("output is text"),
            err: String::from_utf8(output.stderr).expect("errors are text"),
        }
    }

    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mtess"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command
    }

    /// Runs `mtess`, which must go well.
    pub fn good(&self, arguments: &str) -> Told {
        let told = self.run(arguments);
        assert_eq!(told.code, Some(0), "mtess {arguments}: {told:?}");
        told
    }

    /// Runs `mtess`, which must refuse in exactly one line that names `names`, with exit code 1, and leave no file
    /// that was not there. Gives the line.
    pub fn refused(&self, arguments: &str, names: &str) -> String {
        let before = self.files();
        let told = self.run(arguments);
        assert_eq!(told.code, Some(1), "mtess {arguments}: {told:?}");
        assert_eq!(told.out, "", "mtess {arguments}");
        let line = told.err.strip_suffix('\n').unwrap_or(&told.err);
        let one = line.starts_with("error: ") && !line.contains(['\n', '\r']);
        assert!(one, "mtess {arguments}: not one line of error: {told:?}");
        assert!(line.contains(names), "mtess {arguments}: {names} is not named: {line}");
        assert!(!line.contains("panicked"), "{line}");
        assert_eq!(self.files(), before, "mtess {arguments} left a file");
        line.to_owned()
    }

    /// The names of everything in the folder, sorted; hidden files too.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder is there");
        let mut names: Vec<_> = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into()).collect();
        names.sort();
        names
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("the folder takes files");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("the file is text")
    }

    /// Writes a mesh in the format of the name's ending.
    pub fn put(&self, name: &str, mesh: &Mesh<3>) {
        self.write(name, format::write(format_of(name), mesh).expect("the mesh can be written"));
    }

    /// Loads a mesh that the program wrote, as it stands in the file but for STL, which has no vertices to share.
    pub fn mesh(&self, name: &str) -> Mesh<3> {
        let weld = format_of(name) == Format::Stl;
        let options = LoadOptions { weld, ..LoadOptions::default() };
        format::read(format_of(name), &self.read(name), &options, &|_| None).expect("a mesh").0
    }

    pub fn model(&self, name: &str) -> (Explicit<3>, Meta) {
        container::read(&self.read(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn write_model(&self, name: &str, model: &Explicit<3>, meta: &Meta) {
        let mut bytes = Vec::new();
        container::write(model, meta, &mut bytes).expect("writing to memory cannot fail");
        self.write(name, bytes);
    }

    pub fn write_camera(&self, name: &str, camera: &Camera) {
        self.write(name, serde_json::to_vec(camera).expect("a camera is JSON"));
    }
}

/// A folder with `ball.ply`, a closed surface of 1,280 triangles, and its model `ball.mt`.
pub fn ball() -> Room {
    let room = Room::new();
    room.put("ball.ply", &ball_mesh());
    room.good("build ball.ply -o ball.mt");
    room
}

pub fn ball_mesh() -> Mesh<3> {
    generate::bumpy_sphere(3, 0.1, 5)
}

/// A camera close to the ball, which sees a part of it.
pub fn ball_camera() -> Camera {
    let around = Camera::around(glam::Vec3::splat(-1.0), glam::Vec3::ONE, glam::vec3(0.3, 0.2, 1.0));
    Camera { fov_y_degrees: 20.0, width_px: 320, height_px: 240, ..around }
}

fn format_of(name: &str) -> Format {
    let ending = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or("");
    Format::from_extension(ending).expect("the ending of a mesh")
}
