//! What kinds of steps an analysis by fans took, counted by listening to it.

use mt_core::analysis::{Draft, Listener};
use mt_core::explicit::HistoryError;
use mt_core::{Mesh, Plan, Slot, VertexId};

/// What a plan merges.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// All vertices around the one that stays.
    Full,
    /// Several of them, not all.
    Partial,
    /// One of them.
    Single,
}

impl Step {
    /// What `plan`, which was made for `draft` as it is, merges. `None` for a plan that merges into no vertex. O(patch).
    pub fn of_plan(draft: &Draft<3>, plan: &Plan<3>) -> Option<Self> {
        let mut around = Vec::new();
        draft.complex.neighbours(plan.kept?, &mut around);
        Some(match plan.retired.len() {
            n if n == around.len() => Step::Full,
            1 => Step::Single,
            _ => Step::Partial,
        })
    }
}

/// Counts steps; a [`Listener`] on its own or beside a recorder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FanTally {
    /// Full fans.
    pub full: u64,
    /// Vertices that full fans merged.
    pub full_children: u64,
    /// Partial fans.
    pub partial: u64,
    /// Vertices that partial fans merged.
    pub partial_children: u64,
    /// Single half-edge collapses.
    pub single: u64,
    /// The most vertices that one step merged.
    pub children_max: usize,
    /// Vertices with triangles, as many as are left.
    pub vertices: usize,
    /// Vertices that were left when the first step came that was not a full fan.
    pub stalled_at: Option<usize>,
}

impl FanTally {
    /// A tally of an analysis of `mesh` that is about to begin. O(cells).
    pub fn new(mesh: &Mesh<3>) -> Self {
        let mut used = vec![false; mesh.positions.len()];
        mesh.cells.iter().flatten().for_each(|v: &VertexId| used[v.index()] = true);
        Self { vertices: used.iter().filter(|u| **u).count(), ..Self::default() }
    }

    /// Vertices that a full fan merges, on average.
    pub fn full_children_mean(&self) -> f64 {
        self.full_children as f64 / self.full as f64
    }
}

impl Listener<3> for FanTally {
    fn applying(&mut self, draft: &Draft<3>, plan: &Plan<3>) -> Result<(), HistoryError> {
        let children = plan.retired.len();
        let Some(step) = Step::of_plan(draft, plan) else { return Ok(()) };
        match step {
            Step::Full => {
                self.full += 1;
                self.full_children += children as u64;
            }
            Step::Partial => {
                self.partial += 1;
                self.partial_children += children as u64;
            }
            Step::Single => self.single += 1,
        }
        if step != Step::Full && self.stalled_at.is_none() {
            self.stalled_at = Some(self.vertices);
        }
        self.children_max = self.children_max.max(children);
        self.vertices -= children;
        Ok(())
    }

    fn applied(&mut self, _: &mut Draft<3>, _: &Plan<3>, _: &[Slot]) -> Result<(), HistoryError> {
        Ok(())
    }
}
