//! Contraction and expansion within a budget of cells, as the slides have them and as the engine does.

use super::FIELD;
use super::slides::{contraction, expansion};
use crate::ledger::{Claim, Entry, LedgerError, Published, Subject, Workshop, edge_collapse};
use crate::study::camera_path;
use crate::table::Table;
use mt_core::{Camera, Explicit, MultiTessellation, NodeId};
use operators::{AnyOperator, FanMerge};
use selective::{Criterion, Limits, ScreenError, State, adapt};
use std::sync::Arc;

/// Frames of standing still before steps are counted, and while they are.
const STILL: usize = 8;

/// What one way of keeping a budget did.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kept {
    /// Frames whose mesh is larger than the budget, and by how much at most.
    pub(super) over: u32,
    pub(super) over_max: u32,
    /// Nodes that were added for one that then was not.
    pub(super) in_vain: u32,
    /// Steps a frame of a camera that stands still, after it has stood for some frames.
    pub(super) restless: f64,
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

/// A field, cameras around it, and so many triangles that they do not suffice.
struct Trial {
    subject: Arc<Subject>,
    cameras: Vec<Camera>,
    budget: u32,
}

/// The error that is asked for, in pixels; so small that the number of triangles ends the refinement, not the error.
const ERROR_PX: f32 = 0.25;

impl Trial {
    fn new(workshop: &mut Workshop<'_>) -> Result<Self, LedgerError> {
        let subject = workshop.subject(&FIELD)?;
        let budget = (subject.mesh.cell_count() / 20) as u32;
        let cameras = camera_path(&subject.mesh, workshop.pick(40, 16));
        Ok(Self { subject, cameras, budget })
    }

    fn by_slides(&self, model: &Explicit<3>) -> Kept {
        follow(model, &self.cameras, self.budget, |camera, state| {
            let criterion = ScreenError::new(camera, ERROR_PX);
            let excess = |m: NodeId| criterion.excess(&model.bound(m), false);
            contraction(model, &excess, self.budget, state);
            expansion(model, &excess, self.budget, state)
        })
    }

    fn by_engine(&self, model: &Explicit<3>) -> Kept {
        let limits = Limits { cells: Some(self.budget), time: None };
        follow(model, &self.cameras, self.budget, |camera, state| {
            adapt(model, &ScreenError::new(camera, ERROR_PX), &limits, state);
            0
        })
    }
}

/// What the slides' algorithm does, with edge collapses.
pub(super) fn slides(workshop: &mut Workshop<'_>) -> Result<Kept, LedgerError> {
    let trial = Trial::new(workshop)?;
    let model = workshop.explicit(&trial.subject, &edge_collapse())?;
    Ok(trial.by_slides(&model))
}

pub(super) fn budget(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let trial = Trial::new(workshop)?;
    entry.models.push(trial.subject.told());
    let caption = format!(
        "Measured: {} frames around the field within {} triangles, then the last camera again, {} times.",
        trial.cameras.len(),
        trial.budget,
        2 * STILL
    );
    let mut table = Table::new(
        &caption,
        "operator | way | #frames over | #triangles over, most | #nodes in vain | #steps a still frame | #steps a frame",
    );
    let (mut slides, mut engine) = (Kept::default(), Kept::default());
    for operator in [edge_collapse(), AnyOperator::FanMerge(FanMerge::PARTIAL)] {
        let model = workshop.explicit(&trial.subject, &operator)?;
        workshop.go_on("budget")?;
        for (way, kept, all) in
            [("slides", trial.by_slides(&model), &mut slides), ("engine", trial.by_engine(&model), &mut engine)]
        {
            let counts = [kept.over, kept.over_max, kept.in_vain].map(|count| count.to_string());
            let steps = [kept.restless, kept.steps].map(|steps| format!("{steps:.1}"));
            table.row([operator.name(), way.to_owned()].into_iter().chain(counts).chain(steps));
            all.over += kept.over;
            all.in_vain += kept.in_vain;
            all.restless = all.restless.max(kept.restless);
        }
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "nodes are added if the size of the mesh is below the maximum size, so the mesh keeps within it",
        slides.over == 0,
        format!("the slides' meshes are too large in {} frames", slides.over),
        "the test comes before a step and does not count what the step adds",
    ));
    entry.claims.push(Claim::check(
        "what is added is needed",
        slides.in_vain == 0,
        format!("{} nodes were added for others that then did not fit", slides.in_vain),
        "the recursion stops when the mesh is full, and leaves what it has added",
    ));
    entry.claims.push(Claim::check(
        "the phases come to rest for a camera that stands still",
        slides.restless == 0.0,
        format!("{:.1} steps a frame after {STILL} frames of standing still", slides.restless),
        "a mesh that is too large loses nodes that are asked for, and the expansion adds them again",
    ));
    let finds = format!(
        "{} frames over, {} nodes in vain, {:.1} steps a still frame",
        engine.over, engine.in_vain, engine.restless
    );
    let rest = engine.over + engine.in_vain == 0 && engine.restless == 0.0;
    entry.claims.push(Claim::check("the engine keeps within the budget and comes to rest", rest, finds, "").ours());
    Ok(())
}
