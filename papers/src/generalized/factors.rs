//! The simplification factors of the slide: each is a criterion, and one hierarchy serves all.

use super::BUNNY;
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop, share};
use crate::table::Table;
use glam::Vec3;
use mt_core::{Camera, Hierarchy};
use operators::AnyOperator;
use operators::EdgeCollapse;
use operators::metric::{AnyMetric, Quadrics};
use operators::order::Stored;
use selective::{
    Facing, Frustum, InView, Limits, Measure, Reading, ScreenError, Silhouette, Strategy, Transfer, UniformError,
    VisualError, Wish, extract, wish_closure,
};
use std::sync::Arc;

const ERROR_PX: f32 = 1.0;

/// The factors by name, with what is asked for.
fn wishes(camera: &Camera, diagonal: f32) -> Result<Vec<(&'static str, &'static str, Wish)>, LedgerError> {
    let screen = |px| Wish::Screen(Box::new(ScreenError::new(camera, px)));
    let frustum = Frustum::new(camera);
    let error_max = 1e-4 * diagonal;
    let uniform = Wish::Uniform(UniformError { error_max });
    let in_view = Wish::InView(Box::new(InView { frustum, criterion: uniform.clone() }));
    let eye = camera.eye;
    let outline =
        Wish::Silhouette(Box::new(Silhouette { eye, outline: screen(0.25 * ERROR_PX), elsewhere: screen(ERROR_PX) }));
    let knots = vec![(0.0, 2e-5 * diagonal), (diagonal * 0.5, 1e-4 * diagonal), (diagonal * 2.0, 1e-3 * diagonal)];
    let transfer =
        Transfer::new(eye, Measure::Distance, knots).map_err(|error| LedgerError::Data(error.to_string()))?;
    let light = Vec3::new(0.3, 0.9, 0.4).normalize();
    let reading = Reading::Error;
    let visual = VisualError { eye, light, epsilon: 0.2, scale: 1e-4 * diagonal * diagonal, error_min: 0.0, reading };
    Ok(vec![
        ("none", "the same error everywhere", uniform),
        ("screen-space projection", "an error of one pixel, within the frustum", screen(ERROR_PX)),
        ("local illumination", "the error times what light and view make of it", Wish::Visual(Box::new(visual))),
        ("visibility culling: frustum", "the same error, within the frustum", in_view.clone()),
        (
            "visibility culling: back faces",
            "the same, where the surface may face the eye",
            Wish::Facing(Box::new(Facing { eye, criterion: in_view })),
        ),
        ("silhouette boundaries", "one pixel, a quarter of it at outlines", outline),
        ("level of detail transfer function", "an error that grows with distance", Wish::Transfer(Box::new(transfer))),
    ])
}

pub(super) fn factors(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let operator = AnyOperator::EdgeCollapse(EdgeCollapse::FULL.with(AnyMetric::Quadric(Quadrics)));
    let replay = workshop.sequence(&subject, &operator)?.replay;
    let wrong = |error| LedgerError::Hierarchy("dual-piece".into(), error);
    let model = Hierarchy { dependency: Stored::dual_piece(&replay).map_err(wrong)?, replay: Arc::clone(&replay) };
    let (low, high) = subject.mesh.bounding_box().unwrap_or_default();
    let around = Camera::around(low, high, Vec3::new(-0.3, 0.3, 1.0));
    let target = around.target + Vec3::new(-0.1, 0.2, 0.0) * (high - low);
    let camera = Camera { target, eye: target + (around.eye - around.target) * 0.5, ..around };
    let mut table = Table::new(
        "Measured: one camera near the head, one hierarchy under dual pieces.",
        &["factor", "asked for", "#triangles", "#of the input", "#steps"],
    );
    let mut least = true;
    let mut counts = Vec::new();
    for (name, asked, wish) in wishes(&camera, subject.mesh.diagonal() as f32)? {
        let (state, outcome) = extract(&model, &wish, &Limits::NONE, Strategy::TopDown, ());
        least &= *state.front() == wish_closure(&model, &wish);
        let triangles = state.cell_count(&model);
        counts.push(triangles);
        table.row([
            name.to_owned(),
            asked.to_owned(),
            triangles.to_string(),
            share(f64::from(triangles), subject.mesh.cell_count() as f64),
            outcome.refined.to_string(),
        ]);
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "the metric is a parameter: every factor works on one tree",
        least,
        "each answer is the least closed front that holds the wish, as a slow oracle finds it",
        "",
    ));
    entry.claims.push(Claim::check(
        "what cannot be seen is coarse: each kind of culling leaves fewer triangles",
        counts[3] < counts[0] && counts[4] < counts[3],
        format!(
            "{} of the same error everywhere, {} within the frustum, {} of them where the surface may face the eye",
            counts[0], counts[3], counts[4]
        ),
        "the camera sees all of this model",
    ));
    entry.claims.push(Claim::check(
        "silhouettes are emphasised",
        counts[5] > counts[1],
        format!("{} triangles with finer outlines, {} without", counts[5], counts[1]),
        "",
    ));
    Ok(())
}
