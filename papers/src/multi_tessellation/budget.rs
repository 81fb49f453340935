//! Contraction and expansion within a budget of cells, as the slides have them and as the engine does.

use super::slides::{contraction, expansion};
use super::{FIELD, collapse};
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::study::camera_path;
use crate::table::Table;
use mt_core::{Camera, Explicit, MultiTessellation, NodeId};
use operators::{AnyOperator, FanMerge};
use selective::{Criterion, Limits, ScreenError, State, adapt};

/// What one way of keeping a budget did.
#[derive(Clone, Copy, Debug, Default)]
struct Kept {
    /// Frames whose mesh is larger than the budget, and by how much at most.
    over: u32,
    over_max: u32,
    /// Nodes that were added for one that then was not.
    in_vain: u32,
    /// Steps a frame of a camera that stands still, after it has stood for some frames.
    restless: f64,
    /// Steps a frame in motion.
    steps: f64,
}

/// Follows the cameras and then stands still. `frame` answers one and says what was added in vain.
fn follow(
    model: &Explicit<3>,
    cameras: &[Camera],
    budget: u32,
    mut frame: impl FnMut(&Camera, &mut State<3, Explicit<3>, ()>) -> u32,
) -> Kept {
    const STILL: usize = 8;
    let mut state = State::new(model, ());
    let mut kept = Kept::default();
    for camera in cameras {
        state.steps.clear();
        kept.in_vain += frame(camera, &mut state);
        let over = state.cell_count(model).saturating_sub(budget);
        kept.over += u32::from(over > 0);
        kept.over_max = kept.over_max.max(over);
        kept.steps += state.steps.len() as f64 / cameras.len() as f64;
    }
    let last = &cameras[cameras.len() - 1];
    for i in 0..2 * STILL {
        state.steps.clear();
        frame(last, &mut state);
        if i >= STILL {
            kept.restless += state.steps.len() as f64 / STILL as f64;
        }
    }
    kept
}

pub(super) fn budget(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&FIELD)?;
    entry.models.push(subject.told());
    let budget = (subject.mesh.cell_count() / 20) as u32;
    let cameras = camera_path(&subject.mesh, workshop.pick(40, 8));
    let caption = format!(
        "Measured: {} frames around the field within {budget} triangles, then the last camera again and again.",
        cameras.len()
    );
    let mut table = Table::new(
        &caption,
        &[
            "operator",
            "way",
            "#frames over",
            "#triangles over, most",
            "#nodes in vain",
            "#steps a still frame",
            "#steps a frame",
        ],
    );
    let (mut slides_over, mut slides_restless, mut ours_over, mut ours_restless) = (0, 0.0f64, 0, 0.0f64);
    for operator in [collapse(), AnyOperator::FanMerge(FanMerge::PARTIAL)] {
        let model = workshop.explicit(&subject, &operator)?;
        workshop.go_on("budget")?;
        let slides = follow(&model, &cameras, budget, |camera, state| {
            let criterion = ScreenError::new(camera, 0.25);
            let excess = |m: NodeId| criterion.excess(&model.bound(m), false);
            contraction(&*model, &excess, budget, state);
            expansion(&*model, &excess, budget, state)
        });
        let limits = Limits { cells: Some(budget), time: None };
        let ours = follow(&model, &cameras, budget, |camera, state| {
            adapt(&*model, &ScreenError::new(camera, 0.25), &limits, state);
            0
        });
        for (way, kept) in [("slides", slides), ("engine", ours)] {
            table.row([
                operator.name(),
                way.to_owned(),
                kept.over.to_string(),
                kept.over_max.to_string(),
                kept.in_vain.to_string(),
                format!("{:.1}", kept.restless),
                format!("{:.1}", kept.steps),
            ]);
        }
        slides_over += slides.over;
        slides_restless = slides_restless.max(slides.restless);
        ours_over += ours.over;
        ours_restless = ours_restless.max(ours.restless);
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "nodes are added if the size of the mesh is below the maximum size (so the mesh keeps within it)",
        slides_over == 0,
        format!("the slides' meshes are too large in {slides_over} frames"),
        "the test comes before a step and does not count what the step adds",
    ));
    entry.claims.push(Claim::check(
        "the engine keeps within the budget",
        ours_over == 0,
        "a chain is counted before it is forced, and left out where it does not fit",
        "",
    ));
    entry.claims.push(Claim::check(
        "the phases come to rest for a camera that stands still",
        slides_restless == 0.0,
        format!("at most {slides_restless:.1} steps a frame go on for ever"),
        "a mesh that is too large loses nodes that are asked for, and the expansion adds them again",
    ));
    entry.claims.push(Claim::check(
        "the engine comes to rest at once",
        ours_restless == 0.0,
        "its front is a function of model, criterion and budget, found before a step is taken",
        "",
    ));
    Ok(())
}
