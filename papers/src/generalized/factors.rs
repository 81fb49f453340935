//! The simplification factors of the slide: each is a criterion, and one hierarchy serves all.

use crate::ledger::{BUNNY, Claim, Entry, LedgerError, Published, Workshop, edge_collapse, share};
use crate::study::folds;
use crate::table::Table;
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::model::{cells_of, mesh_of};
use mt_core::{Camera, Hierarchy, Mesh, MultiTessellation};
use operators::order::{ImplicitIds, Stored};
use selective::{
    Facing, Frustum, InView, Limits, Measure, Reading, ScreenError, Silhouette, Strategy, Transfer, UniformError,
    VisualError, Wish, extract, wish_closure,
};
use std::sync::Arc;

const ERROR_PX: f32 = 1.0;

/// Directions of the light: from above, a little from the left.
fn light() -> Vec3 {
    Vec3::new(-0.3, 0.9, 0.4).normalize()
}

/// What is asked for by one factor.
struct Factor {
    name: &'static str,
    asked: &'static str,
    wish: Wish,
}

fn factors_for(camera: &Camera, diagonal: f32) -> Result<[Factor; 7], LedgerError> {
    let screen = |px| Wish::Screen(Box::new(ScreenError::new(camera, px)));
    let (eye, error_max) = (camera.eye, 1e-4 * diagonal);
    let uniform = Wish::Uniform(UniformError { error_max });
    let in_view = Wish::InView(Box::new(InView { frustum: Frustum::new(camera), criterion: uniform.clone() }));
    let outline = Silhouette { eye, outline: screen(0.25 * ERROR_PX), elsewhere: screen(ERROR_PX) };
    let knots = vec![(0.0, 2e-5 * diagonal), (diagonal * 0.5, 1e-4 * diagonal), (diagonal * 2.0, 1e-3 * diagonal)];
    let transfer =
        Transfer::new(eye, Measure::Distance, knots).map_err(|error| LedgerError::Data(error.to_string()))?;
    let scale = 2e-5 * diagonal * diagonal;
    let visual = VisualError { eye, light: light(), epsilon: 0.2, scale, error_min: 0.0, reading: Reading::Error };
    let factor = |name, asked, wish| Factor { name, asked, wish };
    Ok([
        factor("none", "the same error everywhere", uniform),
        factor("screen-space projection", "an error of one pixel, within the frustum", screen(ERROR_PX)),
        factor("local illumination", "the error times what light and view make of it", Wish::Visual(Box::new(visual))),
        factor("visibility: frustum", "the same error, within the frustum", in_view.clone()),
        factor(
            "visibility: back faces",
            "the same, where the surface may face the eye",
            Wish::Facing(Box::new(Facing { eye, criterion: in_view })),
        ),
        factor("silhouette boundaries", "one pixel, a quarter of it at outlines", Wish::Silhouette(Box::new(outline))),
        factor(
            "level of detail transfer function",
            "an error that grows with distance",
            Wish::Transfer(Box::new(transfer)),
        ),
    ])
}

/// The mean area of the triangles of which something holds.
fn mean_area(mesh: &Mesh<3>, holds: impl Fn(Vec3, Vec3) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0u32);
    for cell in &mesh.cells {
        let corners = cell.map(|v| mesh.positions[v.index()].as_dvec3());
        let area = area_vector(corners);
        let middle = ((corners[0] + corners[1] + corners[2]) / 3.0).as_vec3();
        if holds(middle, area.normalize_or_zero().as_vec3()) {
            sum += area.length() * 0.5;
            count += 1;
        }
    }
    sum / f64::from(count.max(1))
}

/// What came of a factor.
struct Seen {
    triangles: u32,
    mesh: Mesh<3>,
}

pub(super) fn factors(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
    let wrong = |error| LedgerError::Hierarchy("dual-piece".into(), error);
    let model = Hierarchy { dependency: Stored::dual_piece(&replay).map_err(wrong)?, replay: Arc::clone(&replay) };
    let (low, high) = subject.mesh.bounding_box().unwrap_or_default();
    let around = Camera::around(low, high, Vec3::new(-0.3, 0.3, 1.0));
    let target = around.target + Vec3::new(-0.1, 0.2, 0.0) * (high - low);
    let camera = Camera { target, eye: target + (around.eye - around.target) * 0.5, ..around };
    let mut table = Table::new(
        "Measured: one camera near the head, one hierarchy under dual pieces; last the same under implicit ids.",
        "factor | asked for | #triangles | #of the input | #steps | #folds",
    );
    let mut least = 0;
    let all = factors_for(&camera, subject.mesh.diagonal() as f32)?;
    let seen = all.each_ref().map(|Factor { name, asked, wish }| {
        let (state, outcome) = extract(&model, wish, &Limits::NONE, Strategy::TopDown, ());
        least += u32::from(*state.front() == wish_closure(&model, wish));
        let triangles = state.cell_count(&model);
        table.row(row(name, asked, &model, &state.view.mesh, outcome.refined, subject.mesh.cell_count()));
        Seen { triangles, mesh: mesh_of(&model, &state.view.mesh) }
    });
    let implicit = Hierarchy { dependency: ImplicitIds, replay };
    let (state, outcome) = extract(&implicit, &all[0].wish, &Limits::NONE, Strategy::TopDown, ());
    let name = "prevent foldovers: implicit dependencies";
    table.row(row(name, all[0].asked, &implicit, &state.view.mesh, outcome.refined, subject.mesh.cell_count()));
    let folds_in = |mesh: &Mesh<3>| folds(&mesh.cells, &mesh.positions);
    let counts = [folds_in(&seen[0].mesh), folds_of(&implicit, &state.view.mesh)];
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "the metric is a parameter: every factor works on one tree",
        least as usize == all.len(),
        format!(
            "{least} of {} answers are the least closed front that holds the wish, as a slow oracle finds it",
            all.len()
        ),
        "",
    ));
    entry.claims.push(Claim::check(
        "implicit dependencies prevent foldovers",
        counts[1] <= folds_in(&subject.mesh) && counts[1] <= counts[0],
        format!(
            "{} folds under implicit ids, {} under dual pieces, for the same error everywhere",
            counts[1], counts[0]
        ),
        "the analysis itself lets a triangle turn by up to 78 degrees at each merge, and turns add up",
    ));
    decide(entry, &seen, &camera);
    Ok(())
}

fn folds_of<M: MultiTessellation<3>>(model: &M, mesh: &M::Mesh) -> u32 {
    let cells: Vec<_> = cells_of(model, mesh).into_iter().map(|(_, cell)| cell).collect();
    folds(&cells, model.positions())
}

fn row<M: MultiTessellation<3>>(
    name: &str,
    asked: &str,
    model: &M,
    mesh: &M::Mesh,
    steps: u32,
    input: usize,
) -> [String; 6] {
    let triangles = model.cell_count(mesh);
    let part = share(f64::from(triangles), input as f64);
    let folds = folds_of(model, mesh).to_string();
    [name.to_owned(), asked.to_owned(), triangles.to_string(), part, steps.to_string(), folds]
}

/// Whether each factor does what it is for; in the order of [`factors_for`].
fn decide(entry: &mut Entry, seen: &[Seen; 7], camera: &Camera) {
    let [none, screen, light_, frustum, backs, outline, transfer] = seen;
    let planes = camera.frustum();
    let inside = |p: Vec3| planes.iter().all(|plane| plane.dot(p.extend(1.0)) >= 0.0);
    let mut areas = |says: &str, what: [&str; 2], areas: [f64; 2]| {
        let finds = format!("triangles {} are {:.1} times as large as those {}", what[1], areas[1] / areas[0], what[0]);
        entry.claims.push(Claim::check(says, areas[0] < areas[1], finds, ""));
    };
    areas(
        "screen-space projection: detail where it can be seen",
        ["in the frustum", "outside"],
        [true, false].map(|within| mean_area(&screen.mesh, |p, _| inside(p) == within)),
    );
    let middle = {
        let mut distances: Vec<f32> = transfer.mesh.positions.iter().map(|p| p.distance(camera.eye)).collect();
        distances.sort_by(f32::total_cmp);
        distances.get(distances.len() / 2).copied().unwrap_or(0.0)
    };
    areas(
        "a transfer function from distance to detail",
        ["nearer than the middle", "farther away"],
        [true, false].map(|near| mean_area(&transfer.mesh, |p, _| (p.distance(camera.eye) < middle) == near)),
    );
    let lit = |n: Vec3| n.dot(light()).abs();
    areas(
        "local illumination: detail where light falls",
        ["that look at the light", "that it grazes"],
        [mean_area(&light_.mesh, |_, n| lit(n) > 0.8), mean_area(&light_.mesh, |_, n| lit(n) < 0.2)],
    );
    entry.claims.push(Claim::check(
        "visibility culling: what cannot be seen is coarse",
        frustum.triangles < none.triangles && backs.triangles < frustum.triangles,
        format!(
            "{} of the same error everywhere, {} within the frustum, {} of them where the surface may face the eye",
            none.triangles, frustum.triangles, backs.triangles
        ),
        "the camera sees all of this model",
    ));
    entry.claims.push(Claim::check(
        "silhouettes are emphasised",
        outline.triangles > screen.triangles,
        format!("{} triangles with finer outlines, {} without", outline.triangles, screen.triangles),
        "",
    ));
}
