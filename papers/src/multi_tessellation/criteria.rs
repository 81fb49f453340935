//! The three criteria of the slides on cells of a field, and both ways of answering a query that moves.

use super::FIELD;
use crate::ledger::{
    Brush, Claim, Entry, Figure, LedgerError, Published, PublishedTable, Workshop, close_up, edge_collapse, share,
};
use crate::table::Table;
use glam::Vec3;
use mt_core::model::mesh_of;
use mt_core::{Explicit, Mesh};
use render::{Look, encode};
use selective::{
    CellCriterion, CellView, ErrorBelow, Focus, InRegion, Limits, Region, State, Strategy, adapt, extract,
    extract_exact,
};

/// An error where the field takes a value, anything elsewhere.
struct AtValue {
    value: f32,
    error_max: f32,
}

impl CellCriterion<3> for AtValue {
    fn holds(&self, cell: &CellView<3>) -> bool {
        let (low, high) =
            cell.corners.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        !(low..=high).contains(&self.value) || cell.error <= self.error_max
    }
}

/// What the slides' errors are shares of: the range of the field.
fn range_of(mesh: &Mesh<3>) -> (f32, f32) {
    let heights = mesh.positions.iter().map(|p| p.y);
    heights.fold((f32::MAX, f32::MIN), |(low, high), y| (low.min(y), high.max(y)))
}

/// A box of a share of the sides, of all heights.
fn window(mesh: &Mesh<3>, share: f32, at: f32) -> Region {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let side = (high - low) * share;
    let corner = low + (high - low - side) * at;
    Region { low: Vec3::new(corner.x, low.y, corner.z), high: Vec3::new(corner.x + side.x, high.y, corner.z + side.z) }
}

pub(super) fn criteria(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let subject = workshop.subject(&FIELD)?;
    entry.models.push(subject.told());
    let model = workshop.explicit(&subject, &edge_collapse())?;
    let (low, high) = range_of(&subject.mesh);
    let error = |percent: f32| (high - low) * percent * 0.01;
    let uniform = |percent| ErrorBelow { error_max: error(percent), region: None, focus: Focus::Strict };
    let inside =
        |side, focus| ErrorBelow { error_max: error(0.1), region: Some(window(&subject.mesh, side, 0.4)), focus };
    let at = |share: f32| AtValue { value: low + (high - low) * share, error_max: error(0.1) };
    let meshes = [
        ("uniform", "0.5", mesh_for(&model, &uniform(0.5))),
        ("uniform", "0.1", mesh_for(&model, &uniform(0.1))),
        ("region of a fourth of the plane", "0.1", mesh_for(&model, &inside(0.5, Focus::Strict))),
        ("region of a sixteenth", "0.1", mesh_for(&model, &inside(0.25, Focus::Strict))),
        ("region of a sixty-fourth", "0.1", mesh_for(&model, &inside(0.125, Focus::Strict))),
        ("region of a sixteenth, by the largest threshold", "0.1", mesh_for(&model, &inside(0.25, Focus::Loose))),
        ("field value at 0.2 of the range", "0.1", mesh_for(&model, &at(0.2))),
        ("field value at 0.4", "0.1", mesh_for(&model, &at(0.4))),
        ("field value at 0.7", "0.1", mesh_for(&model, &at(0.7))),
    ];
    let whole = subject.mesh.cell_count() as f64;
    let fine = meshes[1].2.cell_count() as f64;
    let mut table = Table::new(
        "Measured: cells are judged one by one, and the mesh is the least that satisfies the criterion.",
        "criterion | #error there, % of the range | #triangles | #of the reference mesh | #of the uniform mesh of 0.1 %",
    );
    for (name, percent, mesh) in &meshes {
        let count = mesh.cell_count() as f64;
        table.row([
            (*name).to_owned(),
            (*percent).to_owned(),
            format!("{count}"),
            share(count, whole),
            share(count, fine),
        ]);
    }
    entry.measured.push(table);
    sizes(entry, published.table("criteria")?, &meshes, whole)?;
    show(entry, &meshes, &subject.mesh)?;
    entry.note("A cell counts as in the region where its bounding box meets it: the smallest threshold over it counts. By the slides it is the largest, so that all of a cell has to be inside.");
    entry.note("The slides have fields over tetrahedra; ours is over a plane until there is an operator for tetrahedra. The box and the value of the slides are not given, so several were tried.");
    Ok(())
}

/// A criterion, its error in per cent of the range, and the mesh for it.
type Made = (&'static str, &'static str, Mesh<3>);

/// Sizes held against those of the slides.
fn sizes(entry: &mut Entry, sizes: &PublishedTable, meshes: &[Made; 9], whole: f64) -> Result<(), LedgerError> {
    let fine = meshes[1].2.cell_count() as f64;
    let part = |mesh: &Mesh<3>, of: f64| 100.0 * mesh.cell_count() as f64 / of;
    let like = |ours: f64, printed: f64| (0.5..=2.0).contains(&(ours / printed));
    let (ours, printed) = (part(&meshes[0].2, whole), sizes.number("uniform", "size, %")?);
    entry.claims.push(Claim::check(
        "a uniform error of 0.5 % of the range takes 44.7 % of the reference mesh",
        like(ours, printed),
        format!("{ours:.1} %, {printed} % printed"),
        "a terrain stands in for a volume, and is smoother",
    ));
    for (says, name, rows) in [
        ("detail in a region takes 6 % of the uniform mesh", "region", 2..5),
        ("detail at a value of the field takes 26 % of the uniform mesh", "field value", 6..9),
    ] {
        let printed = sizes.number(name, "size, %")?;
        let ours: Vec<f64> = meshes[rows].iter().map(|(_, _, mesh)| part(mesh, fine)).collect();
        entry.claims.push(Claim::check(
            says,
            ours.iter().any(|&ours| like(ours, printed)),
            format!(
                "{} %, {printed} % printed for a box or value that is not given",
                ours.iter().map(|size| format!("{size:.1}")).collect::<Vec<_>>().join(", ")
            ),
            "the mesh gets coarser gradually around what is asked for, the more of it the less is asked for",
        ));
    }
    entry.claims.push(Claim::check(
        "a mesh satisfies a variable criterion where no cell is worse than the largest threshold over it (the slides' definition)",
        meshes[5].2.cell_count() > meshes[3].2.cell_count() / 10,
        format!("a region of a sixteenth then takes {} triangles, and {} where the smallest threshold counts", meshes[5].2.cell_count(), meshes[3].2.cell_count()),
        "the largest threshold over a large cell is that outside of the region, so nothing is asked of cells that reach out of \
         it, and the coarsest all do",
    ));
    Ok(())
}

fn show(entry: &mut Entry, meshes: &[Made; 9], input: &Mesh<3>) -> Result<(), LedgerError> {
    let brush = Brush::new()?;
    let camera = close_up(input, Vec3::new(0.0, 1.0, 0.55), Vec3::Y);
    for (i, name) in [(1, "uniform"), (3, "region"), (7, "value")] {
        let (told, _, mesh) = &meshes[i];
        let scene = encode(mesh, &Look { wireframe: true, ..Look::default() });
        let figure: Figure = brush.paint(
            &format!("multi-tessellation-criteria-{name}.png"),
            &format!("{told}: {} triangles", mesh.cell_count()),
            &scene,
            &camera,
        )?;
        entry.figures.push(figure);
    }
    Ok(())
}

fn mesh_for(model: &Explicit<3>, criterion: &impl CellCriterion<3>) -> Mesh<3> {
    mesh_of(model, &extract_exact(model, criterion, ()).0.view.mesh)
}

pub(super) fn strategies(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&FIELD)?;
    entry.models.push(subject.told());
    let model = workshop.explicit(&subject, &edge_collapse())?;
    let (low, high) = range_of(&subject.mesh);
    let frames = workshop.pick(60, 12);
    let mut state = State::new(&*model, ());
    let (mut fresh_steps, mut steps, mut equal, mut largest) = (0u64, 0u64, 0u32, 0);
    for frame in 0..frames {
        workshop.go_on("a region that moves")?;
        let region = window(&subject.mesh, 0.25, frame as f32 / frames as f32);
        let wish = InRegion { region, error_max: (high - low) * 0.001 };
        let (fresh, outcome) = extract(&*model, &wish, &Limits::NONE, Strategy::TopDown, ());
        state.steps.clear();
        let changed = adapt(&*model, &wish, &Limits::NONE, &mut state);
        equal += u32::from(fresh.front() == state.front());
        if frame > 0 {
            fresh_steps += u64::from(outcome.refined);
            steps += u64::from(changed.refined + changed.coarsened);
        }
        largest = largest.max(state.front().len());
    }
    let mut table = Table::new(
        "Measured: a region of a sixteenth of the field that moves across it.",
        "#frames | #steps a frame, top-down | #steps a frame, incremental | #equal fronts | #largest front",
    );
    let mean = |sum: u64| format!("{:.1}", sum as f64 / f64::from(frames - 1));
    table.row([frames.to_string(), mean(fresh_steps), mean(steps), equal.to_string(), largest.to_string()]);
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "both approaches return one and the same mesh where the error decreases with each modification",
        equal == frames,
        format!("equal fronts in {equal} of {frames} frames; bounds are saturated, so errors do decrease"),
        "",
    ));
    entry.claims.push(Claim::check(
        "the incremental approach takes fewer steps where the query moves a little",
        steps < fresh_steps,
        format!("{:.1} times fewer", fresh_steps as f64 / steps.max(1) as f64),
        "the query leaves most of the mesh behind between two frames",
    ));
    Ok(())
}
