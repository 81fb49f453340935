//! `mtess render`: a picture of an extracted mesh, in pixels or in lines.

use super::{CommandError, print_text};
use crate::files::{self, Model};
use crate::selection::Selection;
use clap::{Args, ValueEnum};
use glam::Vec3;
use mt_core::check::active_ancestors;
use mt_core::hierarchy::Dependency;
use mt_core::model::mesh_of;
use mt_core::{Camera, Hierarchy, Mesh, VertexId};
use operators::order::{Scheme, Visit};
use papers::study::{cell_errors, cell_levels};
use render::{Drawing, Easel, Edges, Finish, Look, Overlay as Colours, Prefer, RenderError, Scene};
use std::path::{Path, PathBuf};
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
    /// No ground behind the mesh (png)
    #[arg(long)]
    transparent: bool,
    /// Average so many pixels along each side to one (png)
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    finer: u32,
    /// The line of text below (svg, pdf); if not set, model, scheme, criterion and counts; empty for none
    #[arg(long, value_name = "TEXT")]
    caption: Option<String>,
    /// Where to write the picture: png, or svg and pdf for the lines that can be seen
    #[arg(short, long, value_name = "OUT.png|svg|pdf")]
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
    /// Colour by normal
    Normals,
    /// The dual pieces of the mesh's vertices over the input; of vertex hierarchies
    Pieces,
    /// Edges of one triangle, blue, and of more than two, red
    Boundary,
    /// The outline as the camera sees it
    Outline,
}

impl Overlay {
    /// Whether it colours triangles, which only one overlay can.
    fn colours(self) -> bool {
        matches!(self, Self::Error | Self::Level | Self::Normals | Self::Pieces)
    }
}

#[derive(ValueEnum, Clone, Copy)]
enum Painter {
    /// The GPU, or else the CPU
    Any,
    Gpu,
    Cpu,
}

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed
        .filter(|(w, h)| (1..=16_384).contains(w) && (1..=16_384).contains(h))
        .ok_or("a size is WIDTHxHEIGHT, 1 to 16384 each".into())
}

impl Render {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        let form = Form::of(&self.output)?;
        if self.overlay.iter().filter(|overlay| overlay.colours()).count() > 1 {
            return Err(CommandError::Other("colours show one thing: error, level, normals or pieces".into()));
        }
        if form != Form::Pixels && (self.transparent || self.finer > 1) {
            return Err(CommandError::Other(
                "--transparent and --finer are for png: lines have no ground and no pixels".into(),
            ));
        }
        if form == Form::Pixels && self.caption.is_some() {
            return Err(CommandError::Other("--caption is for svg and pdf".into()));
        }
        if self.from_outside && self.selection.camera.is_none() {
            return Err(CommandError::Other("--from-outside shows the frustum of --camera, which is missing".into()));
        }
        let camera = self.selection.load_camera()?;
        let selected = self.selected(camera.as_ref())?;
        let (low, high) = selected.extent;
        let from = self.viewpoint(camera, low, high)?;
        let mut scene = self.scene(&selected, from.eye);
        if let Some(camera) = camera.as_ref().filter(|_| self.from_outside) {
            scene.add_frustum(camera, low, high);
        }
        let by = self.write(form, &scene, &from, &selected)?;
        let counts = format!("{} of {} triangles", selected.mesh.cell_count(), selected.cells_in);
        print_text(&format!("{}: {counts}, drawn {by}", self.output.display()));
        Ok(ExitCode::SUCCESS)
    }

    fn shows(&self, overlay: Overlay) -> bool {
        self.overlay.contains(&overlay)
    }

    /// What is drawn, for an eye.
    fn scene(&self, selected: &Selected, eye: Vec3) -> Scene {
        let Selected { mesh, values, .. } = selected;
        if let Some((input, above)) = &selected.pieces {
            // Lines as wide as pieces would hide them.
            let width_px = if mesh.cell_count() > 2000 { 0.5 } else { 1.2 };
            return render::dual_pieces(input, width_px, |v| above[v.index()]);
        }
        let range = Colours::range_of(values);
        let normals = if self.shows(Overlay::Normals) { render::normal_colours(mesh) } else { Vec::new() };
        let overlay = match () {
            () if self.shows(Overlay::Error) => Colours::Error { values, range },
            () if self.shows(Overlay::Level) => Colours::Level { values, range },
            () if self.shows(Overlay::Normals) => Colours::Colours(&normals),
            () => Colours::None,
        };
        let wireframe = self.shows(Overlay::Wireframe);
        let mut scene = render::encode(mesh, &Look { wireframe, overlay, ..Look::default() });
        if self.shows(Overlay::Outline) {
            scene.add_edges(&mesh.positions, &mesh.cells, Edges::Outline(eye));
        }
        if self.shows(Overlay::Boundary) {
            scene.add_edges(&mesh.positions, &mesh.cells, Edges::Boundary);
        }
        scene
    }

    /// Draws and writes; by whom.
    fn write(&self, form: Form, scene: &Scene, from: &Camera, selected: &Selected) -> Result<String, CommandError> {
        let wrong =
            |error: RenderError| files::FileError::new(&self.model, format!("the picture cannot be drawn: {error}"));
        if form == Form::Pixels {
            let prefer = match self.painter {
                Painter::Any => Prefer::Any,
                Painter::Gpu => Prefer::Gpu,
                Painter::Cpu => Prefer::Cpu,
            };
            let finish = Finish { finer: self.finer, transparent: self.transparent };
            let easel = Easel::new(prefer).map_err(wrong)?;
            let (picture, painter) = easel.paint_finished(scene, from, finish).map_err(wrong)?;
            files::write_bytes(&self.output, &picture.to_png())?;
            return Ok(format!("by {painter}"));
        }
        let caption = self.caption.clone().unwrap_or_else(|| self.told(selected));
        let drawing = Drawing::new(scene, from, &caption).map_err(wrong)?;
        let bytes = if form == Form::Svg { drawing.svg().into_bytes() } else { drawing.pdf() };
        files::write_bytes(&self.output, &bytes)?;
        Ok(format!("in {} lines", drawing.lines.len()))
    }

    /// Model, scheme, criterion and counts, as a line.
    fn told(&self, selected: &Selected) -> String {
        let name = self.model.file_name().unwrap_or_default().to_string_lossy();
        let Selection { error, cells, camera, region, .. } = &self.selection;
        let asked = [
            camera.as_ref().map(|_| format!("{} px on the screen", self.selection.pixels)),
            error.map(|error| format!("error {error}")),
            region.map(|_| "within a region".to_owned()),
            cells.map(|cells| format!("at most {cells} triangles")),
        ];
        let asked: Vec<String> = asked.into_iter().flatten().collect();
        let asked = if asked.is_empty() { "the input".to_owned() } else { asked.join(", ") };
        let counts = format!("{} of {} triangles", selected.mesh.cell_count(), selected.cells_in);
        format!("{name}, {}, {asked}: {counts}", selected.scheme)
    }

    /// Extracts what is to be drawn, and the values that colour it.
    fn selected(&self, camera: Option<&Camera>) -> Result<Selected, CommandError> {
        let coloured = self.shows(Overlay::Error) || self.shows(Overlay::Level);
        match files::load_model(&self.model)?.0 {
            Model::Triangles(_) if self.shows(Overlay::Pieces) => {
                let what = "is an explicit model; pieces are of a vertex hierarchy (build it with --dependency)";
                Err(files::FileError::new(&self.model, what).into())
            }
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
                Ok(Selected { values, ..Selected::of(mesh_of(&*model, &state.view.mesh), "cells", &model.reference()) })
            }
            Model::Hierarchy { .. } if coloured || self.selection.per_cell.is_some() => {
                let what =
                    "is a vertex hierarchy, which keeps no errors and levels of single cells: an explicit model does";
                Err(files::FileError::new(&self.model, what).into())
            }
            Model::Hierarchy { replay, scheme } => scheme
                .visit(&replay, Take { render: self, camera, scheme })
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
    /// Where dual pieces are shown: the input, and what stands above each of its vertices.
    pieces: Option<(Mesh<3>, Vec<VertexId>)>,
    /// What steps wait for.
    scheme: &'static str,
    /// Of the input.
    extent: (Vec3, Vec3),
    cells_in: usize,
}

impl Selected {
    fn of(mesh: Mesh<3>, scheme: &'static str, input: &Mesh<3>) -> Self {
        let extent = input.bounding_box().unwrap_or_default();
        Self { mesh, values: Vec::new(), pieces: None, scheme, extent, cells_in: input.cell_count() }
    }
}

/// Extracts from a hierarchy, whatever its dependencies.
struct Take<'a> {
    render: &'a Render,
    camera: Option<&'a Camera>,
    scheme: Scheme,
}

impl Visit for Take<'_> {
    type Output = Result<Selected, CommandError>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        let (state, _) = self.render.selection.run(model, self.camera)?;
        let input = model.replay.reference();
        let above = self.render.shows(Overlay::Pieces).then(|| active_ancestors(&model.replay, state.front()));
        let selected = Selected::of(mesh_of(model, &state.view.mesh), self.scheme.name(), &input);
        Ok(Selected { pieces: above.map(|above| (input, above)), ..selected })
    }
}

/// What kind of file a picture is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Pixels,
    Svg,
    Pdf,
}

impl Form {
    /// By the ending of the file, whose place is checked.
    fn of(path: &Path) -> Result<Self, files::FileError> {
        let form = match path.extension().and_then(|ending| ending.to_str()) {
            Some("png") => Self::Pixels,
            Some("svg") => Self::Svg,
            Some("pdf") => Self::Pdf,
            _ => return Err(files::FileError::new(path, "a picture is written with the ending png, svg or pdf")),
        };
        files::check_place(path).map(|()| form)
    }
}
