//! `mtess render`: a picture of an extracted mesh.

use super::{CommandError, print_text};
use crate::files::{self, Model};
use crate::selection::Selection;
use clap::{Args, ValueEnum};
use glam::Vec3;
use mt_core::hierarchy::Dependency;
use mt_core::model::mesh_of;
use mt_core::{Camera, Hierarchy, Mesh};
use operators::order::Visit;
use papers::study::{cell_errors, cell_levels};
use render::{Look, Overlay as Colours, Prefer};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct Render {
    /// The model
    model: PathBuf,
    #[command(flatten)]
    selection: Selection,
    /// What to draw over the shading
    #[arg(long, value_enum)]
    overlay: Vec<Overlay>,
    /// See the camera's frustum and the mesh from outside; needs --camera
    #[arg(long, requires = "camera")]
    from_outside: bool,
    /// Look from here instead, without changing what is extracted
    #[arg(long, value_name = "FILE.json", conflicts_with = "from_outside")]
    look_from: Option<PathBuf>,
    /// Size of the picture
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// What draws
    #[arg(long, value_enum, default_value_t = Painter::Any)]
    painter: Painter,
    /// Where to write the picture
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
}

#[derive(ValueEnum, Clone, Copy, PartialEq, Eq)]
enum Overlay {
    /// The triangles' edges
    Wireframe,
    /// Colour by error, in model units
    Error,
    /// Colour by level
    Level,
}

#[derive(ValueEnum, Clone, Copy)]
enum Painter {
    /// The GPU, or else the CPU
    Any,
    Gpu,
    Cpu,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed
        .filter(|(w, h)| (1..=16_384).contains(w) && (1..=16_384).contains(h))
        .ok_or("a size is WIDTHxHEIGHT, 1 to 16384 each".into())
}

impl Render {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        files::check_output(&self.output, "a picture", "png")?;
        if self.overlay.contains(&Overlay::Error) && self.overlay.contains(&Overlay::Level) {
            return Err(CommandError::Other("colours show either error or level, not both".into()));
        }
        if self.from_outside && self.selection.camera.is_none() {
            return Err(CommandError::Other("--from-outside shows the frustum of --camera, which is missing".into()));
        }
        let camera = self.selection.load_camera()?;
        let Selected { mesh, values, extent: (low, high), cells_in } = self.selected(camera.as_ref())?;
        let range = Colours::range_of(&values);
        let overlay = match () {
            () if self.overlay.contains(&Overlay::Error) => Colours::Error { values: &values, range },
            () if self.overlay.contains(&Overlay::Level) => Colours::Level { values: &values, range },
            () => Colours::None,
        };
        let look = Look { wireframe: self.overlay.contains(&Overlay::Wireframe), overlay, ..Look::default() };
        let mut scene = render::encode(&mesh, &look);
        if let Some(camera) = camera.as_ref().filter(|_| self.from_outside) {
            scene.add_frustum(camera, low, high);
        }
        let from = self.viewpoint(camera, low, high)?;
        let prefer = match self.painter {
            Painter::Any => Prefer::Any,
            Painter::Gpu => Prefer::Gpu,
            Painter::Cpu => Prefer::Cpu,
        };
        let drawn = render::paint(&scene, &from, prefer);
        let (picture, painter) = drawn
            .map_err(|error| files::FileError::new(&self.model, format!("the picture cannot be drawn: {error}")))?;
        files::write_bytes(&self.output, &picture.to_png())?;
        print_text(&format!(
            "{}: {} of {} triangles, drawn by {painter}",
            self.output.display(),
            mesh.cell_count(),
            cells_in
        ));
        Ok(ExitCode::SUCCESS)
    }

    /// Extracts what is to be drawn, and the values that colour it.
    fn selected(&self, camera: Option<&Camera>) -> Result<Selected, CommandError> {
        let coloured = self.overlay.contains(&Overlay::Error) || self.overlay.contains(&Overlay::Level);
        match files::load_model(&self.model)?.0 {
            Model::Triangles(model) => {
                let state = match self.selection.per_cell {
                    Some(per_cell) => self.selection.run_per_cell(&model, per_cell).0,
                    None => self.selection.run(&*model, camera)?.0,
                };
                let values = if self.overlay.contains(&Overlay::Error) {
                    cell_errors(&model, &state.view.mesh)
                } else if coloured {
                    cell_levels(&model, &state.view.mesh)
                } else {
                    Vec::new()
                };
                Ok(Selected::of(mesh_of(&*model, &state.view.mesh), values, &model.reference()))
            }
            Model::Hierarchy { .. } if coloured || self.selection.per_cell.is_some() => {
                let what =
                    "is a vertex hierarchy, which keeps no errors and levels of single cells: an explicit model does";
                Err(files::FileError::new(&self.model, what).into())
            }
            Model::Hierarchy { replay, scheme } => scheme
                .visit(&replay, Take { selection: &self.selection, camera })
                .map_err(|error| files::FileError::new(&self.model, error))?,
            Model::Tetrahedra(_) => Err(files::no_triangles(&self.model).into()),
        }
    }

    fn viewpoint(&self, camera: Option<Camera>, low: Vec3, high: Vec3) -> Result<Camera, CommandError> {
        let mut from = match (&self.look_from, camera) {
            (Some(path), _) => {
                let other: Camera = files::load_json(path)?;
                other.check().map_err(|error| files::FileError::new(path, error))?;
                other
            }
            (None, Some(camera)) if self.from_outside => render::outside(&camera, low, high),
            (None, Some(camera)) => camera,
            (None, None) => Camera::around(low, high, Vec3::new(0.6, 0.5, 1.0)),
        };
        if let Some((width, height)) = self.size {
            (from.width_px, from.height_px) = (width, height);
        }
        Ok(from)
    }
}

/// What is to be drawn.
struct Selected {
    mesh: Mesh<3>,
    /// Of each triangle, where colours show something.
    values: Vec<f32>,
    /// Of the input.
    extent: (Vec3, Vec3),
    cells_in: usize,
}

impl Selected {
    fn of(mesh: Mesh<3>, values: Vec<f32>, input: &Mesh<3>) -> Self {
        Self { mesh, values, extent: input.bounding_box().unwrap_or_default(), cells_in: input.cell_count() }
    }
}

/// Extracts from a hierarchy, whatever its dependencies.
struct Take<'a> {
    selection: &'a Selection,
    camera: Option<&'a Camera>,
}

impl Visit for Take<'_> {
    type Output = Result<Selected, CommandError>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        let (state, _) = self.selection.run(model, self.camera)?;
        Ok(Selected::of(mesh_of(model, &state.view.mesh), Vec::new(), &model.replay.reference()))
    }
}
