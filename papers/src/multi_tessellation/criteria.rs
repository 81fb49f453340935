//! The three criteria of the slides on cells of a field, and both ways of answering a query that moves.

use super::{FIELD, collapse};
use crate::ledger::{Brush, Claim, Entry, Figure, LedgerError, Published, Workshop, close_up, share};
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

/// A box of a quarter of the sides, of all heights.
fn window(mesh: &Mesh<3>, at: f32) -> Region {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let side = (high - low) * 0.25;
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
    let model = workshop.explicit(&subject, &collapse())?;
    let (low, high) = range_of(&subject.mesh);
    let error = |percent: f32| (high - low) * percent * 0.01;
    let region = window(&subject.mesh, 0.4);
    let uniform = |percent| ErrorBelow { error_max: error(percent), region: None, focus: Focus::Strict };
    let inside = |focus| ErrorBelow { error_max: error(0.1), region: Some(region), focus };
    let value = low + (high - low) * 0.4;
    let meshes = [
        ("uniform", "0.5", mesh_for(&model, &uniform(0.5))),
        ("uniform", "0.1", mesh_for(&model, &uniform(0.1))),
        ("region, a sixteenth of the plane, strict", "0.1", mesh_for(&model, &inside(Focus::Strict))),
        ("region, the same, loose", "0.1", mesh_for(&model, &inside(Focus::Loose))),
        ("field value, at 0.4 of the range", "0.1", mesh_for(&model, &AtValue { value, error_max: error(0.1) })),
    ];
    let whole = subject.mesh.cell_count() as f64;
    let fine = meshes[1].2.cell_count() as f64;
    let mut table = Table::new(
        "Measured: cells are judged one by one, and the mesh is the least that satisfies the criterion.",
        &[
            "criterion",
            "#error there, % of the range",
            "#triangles",
            "#of the reference mesh",
            "#of the uniform mesh of 0.1 %",
        ],
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
    let of_fine = |i: usize| 100.0 * meshes[i].2.cell_count() as f64 / fine;
    let printed = published.table("criteria")?;
    let number = |row| printed.number(row, "size, %").unwrap_or(f64::NAN);
    entry.claims.push(Claim::check(
        "a uniform error of 0.5 % of the range takes less than half of the reference mesh",
        (meshes[0].2.cell_count() as f64) < 0.5 * whole,
        format!(
            "{:.1} %, {} % printed; a terrain where the slide has a volume",
            100.0 * meshes[0].2.cell_count() as f64 / whole,
            number("uniform")
        ),
        "",
    ));
    entry.claims.push(Claim::check(
        "detail in a region or at a field value is a fraction of the uniform mesh, a region less than a value",
        of_fine(2) < of_fine(4) && of_fine(4) < 100.0,
        format!(
            "{:.1} % and {:.1} %; {} % and {} % printed",
            of_fine(2),
            of_fine(4),
            number("region"),
            number("field value")
        ),
        "how much of the field takes the value depends on the field",
    ));
    let brush = Brush::new()?;
    let camera = close_up(&subject.mesh, Vec3::new(0.0, 1.0, 0.55), Vec3::Y);
    for (i, name) in [(1, "uniform"), (2, "region"), (4, "value")] {
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
    entry.note("Strict: a cell counts as in the region where its bounding box meets it. Loose, the slides' definition: where the largest threshold over the cell is that of the region, so where all of the cell is inside; large cells never are, and nothing is asked of them.");
    entry.note("The slides have fields over tetrahedra; ours is over a plane until there is an operator for tetrahedra. The box and the value of the slides are not given.");
    Ok(())
}

fn mesh_for(model: &Explicit<3>, criterion: &impl CellCriterion<3>) -> Mesh<3> {
    mesh_of(model, &extract_exact(model, criterion, ()).0.view.mesh)
}

pub(super) fn strategies(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&FIELD)?;
    entry.models.push(subject.told());
    let model = workshop.explicit(&subject, &collapse())?;
    let (low, high) = range_of(&subject.mesh);
    let frames = workshop.pick(60, 12);
    let mut state = State::new(&*model, ());
    let (mut fresh_steps, mut steps, mut equal, mut largest) = (0u64, 0u64, 0u32, 0);
    for frame in 0..frames {
        workshop.go_on("a region that moves")?;
        let region = window(&subject.mesh, frame as f32 / frames as f32);
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
        &["#frames", "#steps a frame, top-down", "#steps a frame, incremental", "#equal fronts", "#largest front"],
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
