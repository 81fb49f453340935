//! `mtess render`: a picture of an extracted mesh, in pixels or in lines.

use super::{CommandError, print_text};
use crate::files::{self, Model};
use crate::selection::Selection;
use crate::subject::Subject;
use clap::{Args, ValueEnum};
use glam::Vec3;
use mt_core::hierarchy::Dependency;
use mt_core::model::cells_of;
use mt_core::{Camera, Hierarchy, Mesh, NodeId, VertexId};
use operators::order::{Scheme, Visit};
use render::{Drawing, Easel, Edges, Finish, Index, Inspect, Prefer, RenderError, Scene, Seen, Tint};
use selective::{Criterion, State};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub struct Render {
    #[command(flatten)]
    subject: Subject,
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
    /// With --look-from: draw the frustum of --camera
    #[arg(long, requires_all = ["camera", "look_from"])]
    frustum: bool,
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
    /// Colour by level: the longest chain of modifications down to a triangle
    Level,
    /// Black by edges, dark grey by fans, light grey where the base mesh is
    Operations,
    /// Red where nobody asked for what others needed
    Forced,
    /// Blue around whole fans, orange around partial ones; of vertex hierarchies
    Fans,
    /// Colour by normal
    Normals,
    /// The dual pieces of the mesh's vertices over the input; of vertex hierarchies
    Pieces,
    /// Edges of one triangle, blue, of more than two, violet, and cracks, red
    Boundary,
    /// The outline as the camera sees it
    Outline,
}

impl Overlay {
    /// Whether it colours triangles, which only one overlay can.
    fn colours(self) -> bool {
        self == Self::Pieces || self.tint().is_some()
    }

    fn tint(self) -> Option<Tint> {
        Some(match self {
            Self::Error => Tint::Error,
            Self::Level => Tint::Level,
            Self::Operations => Tint::Operations,
            Self::Forced => Tint::Forced,
            Self::Fans => Tint::Fans,
            Self::Normals => Tint::Normals,
            Self::Wireframe | Self::Pieces | Self::Boundary | Self::Outline => return None,
        })
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
            return Err(CommandError::Other(
                "colours show one thing: error, level, normals, operations, forced, fans or pieces".into(),
            ));
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
        if let Some(camera) = camera.as_ref().filter(|_| self.from_outside || self.frustum) {
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
        let Selected { mesh, boundary, .. } = selected;
        let mut scene = selected.scene.clone();
        if self.shows(Overlay::Outline) {
            scene.add_edges(&mesh.positions, &mesh.cells, Edges::Outline(eye));
        }
        if self.shows(Overlay::Boundary) {
            let which = boundary.as_ref().map_or(Edges::Boundary, Edges::Cracks);
            scene.add_edges(&mesh.positions, &mesh.cells, which);
        }
        scene
    }

    /// Draws and writes; by whom.
    fn write(&self, form: Form, scene: &Scene, from: &Camera, selected: &Selected) -> Result<String, CommandError> {
        let wrong = |error: RenderError| {
            files::FileError::new(self.subject.path(), format!("the picture cannot be drawn: {error}"))
        };
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
        let name = self.subject.path().file_name().unwrap_or_default().to_string_lossy();
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

    /// Extracts what is to be drawn, and what colours it.
    fn selected(&self, camera: Option<&Camera>) -> Result<Selected, CommandError> {
        match self.subject.load()? {
            Model::Triangles(_) if self.shows(Overlay::Pieces) || self.shows(Overlay::Fans) => {
                let what = "is an explicit model; pieces and partial fans are of a vertex hierarchy (build it with --dependency)";
                Err(files::FileError::new(self.subject.path(), what).into())
            }
            Model::Triangles(model) => {
                let state = match self.selection.per_cell {
                    Some(per_cell) => self.selection.run_per_cell(&model, per_cell).0,
                    None => self.selection.run(&*model, camera)?.0,
                };
                self.told_of(&*model, &state, camera, "cells")
            }
            Model::Hierarchy { .. } if self.selection.per_cell.is_some() => {
                let what = "is a vertex hierarchy, which keeps no errors of single cells: an explicit model does";
                Err(files::FileError::new(self.subject.path(), what).into())
            }
            Model::Hierarchy { replay, scheme } => scheme
                .visit(&replay, Take { render: self, camera, scheme })
                .map_err(|error| files::FileError::new(self.subject.path(), error))?,
            Model::Tetrahedra(_) => Err(files::no_triangles(self.subject.path()).into()),
        }
    }

    /// What is to be drawn of a state.
    fn told_of<M: Inspect>(
        &self,
        model: &M,
        state: &State<3, M, ()>,
        camera: Option<&Camera>,
        scheme: &'static str,
    ) -> Result<Selected, CommandError> {
        let (front, index) = (state.front(), Index::of(model));
        let wish = self.selection.asked(camera)?.wish();
        let tint = self.overlay.iter().find_map(|overlay| overlay.tint()).unwrap_or_default();
        let cells = cells_of(model, &state.view.mesh);
        let asks = |m: NodeId| wish.asks(&model.bound(m), true);
        let seen = Seen { model, index: &index, front, asks: &asks, steps: &state.steps };
        let input = model.input();
        let extent = input.bounding_box().unwrap_or_default();
        let pieces = if self.shows(Overlay::Pieces) { model.pieces(front) } else { None };
        let scene = match &pieces {
            Some(above) => render::dual_pieces(&input, (extent.0 + extent.1) * 0.5, |v| above[v.index()]),
            None => seen.encode(tint, &cells, self.shows(Overlay::Wireframe)),
        };
        let boundary = if self.shows(Overlay::Boundary) { index.boundary_at(model, front) } else { None };
        // Numbered as in the model, for the boundary's sake.
        let cells = cells.into_iter().map(|(_, corners)| corners).collect();
        let mesh = Mesh { positions: model.positions().to_vec(), cells };
        Ok(Selected { scene, mesh, boundary, scheme, extent, cells_in: input.cell_count() })
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
    /// All but lines that depend on the eye.
    scene: Scene,
    /// The mesh, numbered as in the model.
    mesh: Mesh<3>,
    /// Where the boundary must be, if that is shown.
    boundary: Option<HashSet<[VertexId; 2]>>,
    /// What steps wait for.
    scheme: &'static str,
    /// Of the input.
    extent: (Vec3, Vec3),
    cells_in: usize,
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
        self.render.told_of(model, &state, self.camera, self.scheme.name())
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
