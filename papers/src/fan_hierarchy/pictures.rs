//! Figures 8, 9 and 10: where a camera's frames have changed the mesh by fans and where by edges.

use super::adapting::ERROR_PX;
use super::{ARMADILLO, DRAGON, TERRAIN, fans};
use crate::ledger::{Brush, Claim, Entry, Figure, LedgerError, Published, Role, Subject, Workshop};
use crate::study::camera_path;
use crate::table::Table;
use glam::Vec3;
use mt_core::hierarchy::VertexMesh;
use mt_core::model::{cells_of, mesh_of, take};
use mt_core::{Camera, Cell, CellId, Hierarchy, Mesh, Sink, View};
use operators::order::ImplicitIds;
use render::{Look, Overlay, Rgba, by_fans, encode, outside};
use selective::{Limits, OnPath, Path, ScreenError, State, adapt};

type Fans = Hierarchy<ImplicitIds>;

/// What changed a triangle last.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
enum By {
    #[default]
    Nothing,
    Fan,
    Edge,
}

impl By {
    /// As in the paper: light grey, dark grey, black.
    fn colour(self) -> Rgba {
        match self {
            By::Nothing => [214, 214, 214, 255],
            By::Fan => [118, 118, 118, 255],
            By::Edge => [24, 24, 24, 255],
        }
    }
}

/// Remembers of each triangle what changed it last.
struct Marks {
    by: By,
    of_cell: Vec<By>,
}

impl Sink<3> for Marks {
    fn kill(&mut self, _: CellId) {}
    fn make(&mut self, cell: CellId, _: Cell<3>) {
        self.of_cell[cell.index()] = self.by;
    }
    fn relabel(&mut self, cell: CellId, corners: Cell<3>) {
        self.make(cell, corners);
    }
}

/// A camera that is followed frame by frame, with what its steps did.
struct Flight<'a> {
    model: &'a Fans,
    state: State<3, Fans, ()>,
    marks: Marks,
    /// Of the last frame: fan steps and edge steps.
    last: [u32; 2],
    /// Nodes that changed since the marks were fresh: in fans, by edges.
    nodes: [u32; 2],
}

impl<'a> Flight<'a> {
    fn new(model: &'a Fans) -> Self {
        let marks = Marks { by: By::Nothing, of_cell: vec![By::Nothing; model.replay.cells().len()] };
        Self { model, state: State::new(model, ()), marks, last: [0, 0], nodes: [0, 0] }
    }

    /// Adapts to a camera at an error on the screen, and marks what changed.
    fn follow(&mut self, camera: &Camera, error_px: f32) {
        let before = self.state.view.clone();
        self.state.steps.clear();
        let criterion = OnPath { criterion: ScreenError::new(camera, error_px), path: Path::Difference };
        let outcome = adapt(self.model, &criterion, &Limits::NONE, &mut self.state);
        self.last = [outcome.runs, outcome.singles];
        self.mark(before);
    }

    fn mark(&mut self, mut view: View<VertexMesh>) {
        for (&step, by) in self.state.steps.iter().zip(by_fans(self.model, &self.state.steps)) {
            let by = if by { By::Fan } else { By::Edge };
            self.marks.by = by;
            take(self.model, step, &mut view, &mut self.marks);
            self.nodes[usize::from(by == By::Edge)] += 1;
        }
    }

    /// Forgets what was marked so far.
    fn fresh(&mut self) {
        self.marks.of_cell.fill(By::Nothing);
        self.nodes = [0, 0];
    }

    fn mesh(&self) -> Mesh<3> {
        mesh_of(self.model, &self.state.view.mesh)
    }

    /// What changed each triangle of the current mesh, in its order.
    fn changed(&self) -> Vec<By> {
        let cells = cells_of(self.model, &self.state.view.mesh);
        cells.into_iter().map(|(cell, _)| self.marks.of_cell[cell.index()]).collect()
    }
}

pub(super) fn figure_8(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    around(workshop, &ARMADILLO, entry)
}

pub(super) fn figure_9(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    around(workshop, &DRAGON, entry)
}

/// A tenth of the path, coming nearer, from outside: operations, wireframe, surface.
fn around(workshop: &mut Workshop<'_>, role: &Role, entry: &mut Entry) -> Result<(), LedgerError> {
    let (subject, model) = hierarchy(workshop, role, entry)?;
    let frames = workshop.pick(150, 24) as usize;
    let cameras = camera_path(&subject.mesh, frames as u32);
    // Coming nearer, where the path is at its steepest.
    let (from, to) = (frames * 3 / 10, frames * 4 / 10);
    let mut flight = Flight::new(&model);
    flight.follow(&cameras[from], ERROR_PX);
    flight.fresh();
    let mut steps = [0, 0];
    for camera in &cameras[from + 1..=to] {
        flight.follow(camera, ERROR_PX);
        steps = [steps[0] + flight.last[0], steps[1] + flight.last[1]];
    }
    let (mesh, changed) = (flight.mesh(), flight.changed());
    let bands = bands(&mesh, &changed, cameras[to].eye);
    entry.claims.push(Claim::check(
        "the vast majority of the adapt operations is performed nearby the viewer",
        bands.near() > 0.66,
        format!("{:.0} % of the triangles that changed are in the nearer half of the mesh", 100.0 * bands.near()),
        "an error on the screen changes far from the eye too, and at the frustum's sides whatever the distance",
    ));
    entry.measured.push(bands.table(&format!(
        "Measured: triangles of the mesh by their distance from the eye, a fifth of the mesh a row, after {} frames of {} fan \
         steps and {} edge steps.",
        to - from,
        steps[0],
        steps[1]
    )));
    entry.claims.push(Claim::check(
        "the density of fine changes is high near the viewer and low far away",
        bands.share(0, By::Edge) > bands.share(4, By::Edge),
        format!(
            "{:.1} % of the nearest fifth were changed by edges, {:.1} % of the farthest",
            100.0 * bands.share(0, By::Edge),
            100.0 * bands.share(4, By::Edge)
        ),
        "",
    ));
    let fans: Vec<f64> = (0..5).map(|band| bands.share(band, By::Fan)).collect();
    let densest = (0..5).max_by(|&a, &b| fans[a].total_cmp(&fans[b])).unwrap_or(0);
    entry.claims.push(Claim::check(
        "fan-merges are densest nearby but not very close, and fade out far away",
        (1..4).contains(&densest) && fans[4] < fans[densest],
        format!(
            "densest in fifth {} of 5 from the eye, {:.1} %; the farthest has {:.1} %",
            densest + 1,
            100.0 * fans[densest],
            100.0 * fans[4]
        ),
        "",
    ));
    let stem = format!("fan-hierarchy-{}", entry.id);
    draw(entry, &stem, &subject, &mesh, &changed, &cameras[to])?;
    entry.note(format!(
        "The printed figures are of other models ({}); ours are those of the tables. They were made by a view-dependent error \
         that is not given; ours by {ERROR_PX} px on the screen within the frustum.",
        if entry.id == "figure-8" { "armadillo of 320K triangles" } else { "dragon of 202K triangles, as many as ours" }
    ));
    Ok(())
}

fn hierarchy(
    workshop: &mut Workshop<'_>,
    role: &Role,
    entry: &mut Entry,
) -> Result<(std::sync::Arc<Subject>, Fans), LedgerError> {
    let subject = workshop.subject(role)?;
    let replay = workshop.sequence(&subject, &fans())?.replay;
    entry.models.push(subject.told());
    Ok((subject, Hierarchy { replay, dependency: ImplicitIds }))
}

/// The three pictures of a figure, from outside, with the frustum of the camera.
fn draw(
    entry: &mut Entry,
    stem: &str,
    subject: &Subject,
    mesh: &Mesh<3>,
    changed: &[By],
    camera: &Camera,
) -> Result<(), LedgerError> {
    let brush = Brush::new()?;
    let (low, high) = subject.mesh.bounding_box().unwrap_or_default();
    let colours: Vec<Rgba> = changed.iter().map(|by| by.colour()).collect();
    let overlay = Overlay::Colours(&colours);
    let looks = [
        (
            "a",
            "operations: black by edges, dark grey by fans, light grey untouched",
            Look { overlay, ..Look::default() },
        ),
        ("b", "wireframe", Look { wireframe: true, ..Look::default() }),
        ("c", "surface", Look { smooth: true, ..Look::default() }),
    ];
    for (part, what, look) in looks {
        let mut scene = encode(mesh, &look);
        scene.add_frustum(camera, low, high);
        let caption = format!(
            "{}, {} triangles, from outside with the camera's frustum; {what}",
            subject.name,
            mesh.cell_count()
        );
        entry.figures.push(brush.paint(&format!("{stem}{part}.png"), &caption, &scene, &outside(camera, low, high))?);
    }
    Ok(())
}

/// Triangles by distance from an eye, in fifths.
struct Bands([[u32; 3]; 5]);

fn bands(mesh: &Mesh<3>, changed: &[By], eye: Vec3) -> Bands {
    let middle = |cell: &Cell<3>| cell.iter().map(|v| mesh.positions[v.index()]).sum::<Vec3>() / 3.0;
    let mut all: Vec<(f32, By)> =
        mesh.cells.iter().zip(changed).map(|(cell, &by)| (middle(cell).distance(eye), by)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut counts = [[0; 3]; 5];
    for (i, (_, by)) in all.iter().enumerate() {
        counts[i * 5 / all.len()][*by as usize] += 1;
    }
    Bands(counts)
}

impl Bands {
    /// The share of what changed that is in the nearer half.
    fn near(&self) -> f64 {
        let changed = |band: usize| f64::from(self.0[band][1] + self.0[band][2]);
        let all: f64 = (0..5).map(changed).sum();
        (changed(0) + changed(1) + 0.5 * changed(2)) / all.max(1.0)
    }

    fn share(&self, band: usize, by: By) -> f64 {
        let all: u32 = self.0[band].iter().sum();
        f64::from(self.0[band][by as usize]) / f64::from(all.max(1))
    }

    fn table(&self, caption: &str) -> Table {
        let mut table =
            Table::new(caption, "fifth from the eye | #untouched | #by fans | #by edges | #by fans, % | #by edges, %");
        for (band, counts) in self.0.iter().enumerate() {
            let counts = counts.map(|count| count.to_string());
            let shares = [By::Fan, By::Edge].map(|by| format!("{:.1}", 100.0 * self.share(band, by)));
            table.row([(band + 1).to_string()].into_iter().chain(counts).chain(shares));
        }
        table
    }
}

/// Where a flight over a terrain is at a share of its way: from the lower left corner to the middle, looking ahead.
fn over(mesh: &Mesh<3>, share: f32) -> Camera {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let side = high - low;
    let middle = (low + high) * 0.5;
    let above = high.y + 0.05 * side.x.max(side.z);
    let corner = Vec3::new(low.x, above, high.z);
    let end = Vec3::new(middle.x, above, middle.z);
    let eye = corner.lerp(end, share);
    let ahead = (end - corner).normalize_or_zero() * side.length() * 0.25;
    Camera {
        eye,
        target: eye + ahead - Vec3::Y * side.length() * 0.08,
        up: Vec3::Y,
        fov_y_degrees: 45.0,
        near: side.length() * 0.002,
        far: side.length() * 2.0,
        width_px: 1024,
        height_px: 768,
    }
}

/// A flight of the figure, by its numbers.
struct Flown {
    frames: f64,
    error_px: f32,
    /// Fan steps and edge steps a frame, of the whole flight and of the frame half-way.
    steps: [f64; 2],
    there: [u32; 2],
    /// The share of nodes that changed in whole fans.
    in_fans: f64,
}

/// Flies, and shows `snapshot` the frame half-way.
fn fly(
    subject: &Subject,
    model: &Fans,
    frames: f64,
    error_px: f32,
    snapshot: &mut dyn FnMut(&Flight<'_>, &Camera) -> Result<(), LedgerError>,
) -> Result<Flown, LedgerError> {
    let mut flight = Flight::new(model);
    flight.follow(&over(&subject.mesh, 0.0), error_px);
    let (mut steps, mut nodes, mut there) = ([0.0; 2], [0.0; 2], [0, 0]);
    for frame in 1..=frames as usize {
        flight.fresh();
        let camera = over(&subject.mesh, frame as f32 / frames as f32);
        flight.follow(&camera, error_px);
        for kind in 0..2 {
            steps[kind] += f64::from(flight.last[kind]) / frames;
            nodes[kind] += f64::from(flight.nodes[kind]);
        }
        if frame == frames as usize / 2 {
            there = flight.last;
            snapshot(&flight, &camera)?;
        }
    }
    Ok(Flown { frames, error_px, steps, there, in_fans: nodes[0] / (nodes[0] + nodes[1]).max(1.0) })
}

pub(super) fn figure_10(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let (subject, model) = hierarchy(workshop, &TERRAIN, entry)?;
    let flights = published.table("figure-10")?.column("frames")?;
    let brush = Brush::new()?;
    let names = ["slow", "medium", "fast"];
    let mut table = Table::new(
        "Measured: steps a frame, mean of the flight and at the place of the snapshot, half-way.",
        "flight | #frames | #error, px | #fan steps | #edge steps | #there: fan steps | #edge steps | #nodes in fans, %",
    );
    let mut same = Vec::new();
    let mut growing = Vec::new();
    for (i, (&frames, name)) in flights.iter().zip(names).enumerate() {
        workshop.go_on(name)?;
        same.push(fly(&subject, &model, frames, ERROR_PX, &mut |_, _| Ok(()))?);
        // The tolerance is proportional to the speed of motion.
        let error_px = ERROR_PX * (flights[0] / frames) as f32;
        growing.push(fly(&subject, &model, frames, error_px, &mut |flight, camera| {
            snapshot(entry, &brush, flight, camera, ["b", "c", "d"][i], name)?;
            if i == 0 { surface(entry, &brush, flight, &subject, camera) } else { Ok(()) }
        })?);
    }
    for (kind, all) in [("one error", &same), ("error by speed", &growing)] {
        for (flown, name) in all.iter().zip(names) {
            let numbers = [
                flown.steps[0],
                flown.steps[1],
                f64::from(flown.there[0]),
                f64::from(flown.there[1]),
                100.0 * flown.in_fans,
            ];
            let head = [format!("{name}, {kind}"), format!("{}", flown.frames), format!("{}", flown.error_px)];
            table.row(head.into_iter().chain(numbers.map(|number| format!("{number:.1}"))));
        }
    }
    entry.measured.push(table);
    speed(entry, &same, &growing);
    Ok(())
}

/// What the paper says of speed, held against flights at one error and at an error by speed.
fn speed(entry: &mut Entry, same: &[Flown], growing: &[Flown]) {
    let told = |flights: &[Flown], of: &dyn Fn(&Flown) -> String| flights.iter().map(of).collect::<Vec<_>>().join(", ");
    entry.claims.push(Claim::check(
        "the number of edge collapses decreases as the speed of motion increases",
        growing.windows(2).all(|pair| pair[1].there[1] < pair[0].there[1]),
        format!(
            "at the place of the snapshot {} edge steps with an error by speed, {} with one error",
            told(growing, &|flown| flown.there[1].to_string()),
            told(same, &|flown| flown.there[1].to_string())
        ),
        "a faster frame has more of everything to change, edges too; an error that grows with the speed keeps their number \
         about as it is. What falls is their share",
    ));
    entry.claims.push(Claim::check(
        "the number of fan-merges increases with it",
        growing.windows(2).all(|pair| pair[1].there[0] > pair[0].there[0]),
        format!(
            "at the place of the snapshot {} fan steps with an error by speed, {} with one error",
            told(growing, &|flown| flown.there[0].to_string()),
            told(same, &|flown| flown.there[0].to_string())
        ),
        "with an error by speed the mesh is coarser as well, and changes by fewer nodes; with one error fans do increase",
    ));
    entry.claims.push(
        Claim::check(
            "the share of nodes that change in whole fans increases with the speed",
            growing.windows(2).all(|pair| pair[1].in_fans > pair[0].in_fans),
            format!("over the flight {}", told(growing, &|flown| format!("{:.1} %", 100.0 * flown.in_fans))),
            "",
        )
        .ours(),
    );
}

fn snapshot(
    entry: &mut Entry,
    brush: &Brush,
    flight: &Flight<'_>,
    camera: &Camera,
    part: &str,
    name: &str,
) -> Result<(), LedgerError> {
    let colours: Vec<Rgba> = flight.changed().iter().map(|by| by.colour()).collect();
    let scene = encode(&flight.mesh(), &Look { overlay: Overlay::Colours(&colours), ..Look::default() });
    let caption = format!(
        "The {name} flight half-way: {} fan steps (dark grey), {} edge steps (black) in this frame",
        flight.last[0], flight.last[1]
    );
    let figure: Figure = brush.paint(&format!("fan-hierarchy-figure-10{part}.png"), &caption, &scene, camera)?;
    entry.figures.push(figure);
    Ok(())
}

fn surface(
    entry: &mut Entry,
    brush: &Brush,
    flight: &Flight<'_>,
    subject: &Subject,
    camera: &Camera,
) -> Result<(), LedgerError> {
    let mesh = flight.mesh();
    let scene = encode(&mesh, &Look { smooth: true, ..Look::default() });
    let caption = format!("{}: {} triangles, half-way of the slow flight", subject.name, mesh.cell_count());
    let figure = brush.paint("fan-hierarchy-figure-10a.png", &caption, &scene, camera)?;
    entry.figures.insert(0, figure);
    Ok(())
}
