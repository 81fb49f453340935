//! What the benches run on: a generated terrain, and the meshes that `MT_BENCH_FILES` names. Each is loaded, built and
//! written once, and only when a bench asks for it.

use mt_core::analysis::{Options, simplify};
use mt_core::container::{self, Meta};
use mt_core::format::{self, Format, LoadOptions, NonManifold};
use mt_core::{Explicit, Mesh, generate};
use operators::EdgeCollapse;
use std::path::Path;
use std::sync::{LazyLock, OnceLock};

/// A mesh, with its model by edge collapse and that model as a file.
pub struct Subject {
    pub name: String,
    pub mesh: Mesh<3>,
    model: OnceLock<Explicit<3>>,
    container: OnceLock<Vec<u8>>,
}

impl Subject {
    fn new(name: String, mesh: Mesh<3>) -> Self {
        Self { name, mesh, model: OnceLock::new(), container: OnceLock::new() }
    }

    pub fn model(&self) -> &Explicit<3> {
        self.model.get_or_init(|| {
            let analysis = simplify(&self.mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true);
            analysis.unwrap_or_else(|error| panic!("{}: {error}", self.name)).model
        })
    }

    pub fn container(&self) -> &[u8] {
        self.container.get_or_init(|| {
            let mut bytes = Vec::new();
            container::write(self.model(), &Meta::default(), &mut bytes).expect("writing to memory cannot fail");
            bytes
        })
    }
}

/// All subjects, in the order in which they are named.
pub fn subjects() -> &'static [Subject] {
    static SUBJECTS: LazyLock<Vec<Subject>> = LazyLock::new(|| {
        let files = std::env::var("MT_BENCH_FILES").unwrap_or_default();
        let files = files.split(':').filter(|name| !name.is_empty()).map(|name| load(Path::new(name)));
        terrain().into_iter().chain(files).collect()
    });
    &SUBJECTS
}

fn terrain() -> Option<Subject> {
    let told = std::env::var("MT_BENCH_TRIANGLES").ok();
    let triangles: usize = told.map_or(1_000_000, |text| text.parse().expect("MT_BENCH_TRIANGLES is a number"));
    let side = (triangles as f64 / 2.0).sqrt().round() as usize;
    let terrain = || Subject::new(format!("terrain-{}", 2 * side * side), generate::terrain(side, 0.55, 7));
    (triangles > 0).then(terrain)
}

fn load(path: &Path) -> Subject {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let format = Format::from_extension(ending).unwrap_or_else(|| panic!("{}: not a mesh", path.display()));
    let wrong = |error: &dyn std::fmt::Display| -> ! { panic!("{}: {error}", path.display()) };
    let bytes = std::fs::read(path).unwrap_or_else(|error| wrong(&error));
    let options = LoadOptions { non_manifold: NonManifold::Split, ..LoadOptions::default() };
    let (mesh, _) = format::read(format, &bytes, &options, &|_| None).unwrap_or_else(|error| wrong(&error));
    Subject::new(path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), mesh)
}
