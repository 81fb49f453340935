//! An operator that leaves out what one may leave out, for verification to find.

use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::check::Random;
use mt_core::{Plan, Refusal, VertexId};
use std::sync::atomic::{AtomicU32, Ordering};

/// Half-edge collapse of whatever is shortest, on closed meshes, with one rule left out.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Careless {
    /// Nothing is wrong.
    Not,
    /// No link condition.
    Link,
    /// The plan forgets one of the cells that it should make, now and then.
    Cell,
    /// It panics at a vertex of four cells.
    Panic,
    /// It makes a cell with a vertex that is gone.
    Gone,
    /// It goes on for ever: makes what it kills.
    Ever,
    /// It turns a cell over, now and then.
    Turned,
    /// It kills a cell beside the star, too, now and then.
    Beside,
    /// It prices by what it was asked before.
    Moody,
    /// Its price is no number, now and then.
    Unpriced,
}

impl Operator<3> for Careless {
    type Site = (VertexId, VertexId);
    type Aux = ();

    fn name(&self) -> &'static str {
        "careless"
    }
    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Self::Site>) -> Result<(), Unfit> {
        let boundary = draft.complex.boundary();
        if !boundary.is_empty() {
            return Err(Unfit::Other("closed meshes only".into()));
        }
        sites.extend(draft.complex.cells().flat_map(|(_, cell)| (0..3).map(|i| (cell[i], cell[(i + 1) % 3]))));
        Ok(())
    }
    fn price(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site) -> Option<f64> {
        let apart = draft.positions[u.index()].distance(draft.positions[v.index()]);
        // Never the same again, however often it was asked: nothing periodic.
        let mood = 1.0 + 6.0 * Random::new(u64::from(ASKED.fetch_add(1, Ordering::Relaxed))).unit();
        let factor = match self {
            Careless::Moody => mood,
            Careless::Unpriced if u.0.is_multiple_of(5) => f64::NAN,
            _ => 1.0,
        };
        (draft.complex.edge_degree(u, v) > 0).then_some(f64::from(apart) * factor)
    }
    fn plan(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
        let mut dying = Vec::new();
        for (slot, i) in draft.complex.star(u) {
            let mut cell = *draft.complex.cell(slot);
            if cell.contains(&v) {
                dying.push(slot);
            } else {
                cell[i] = v;
                plan.kills.push(slot);
                plan.makes.push(cell);
            }
        }
        let mut shared = Vec::new();
        draft.complex.neighbours(u, &mut shared);
        let mut of_v = Vec::new();
        draft.complex.neighbours(v, &mut of_v);
        shared.retain(|w| of_v.contains(w));
        if dying.is_empty() {
            return Err(Refusal::Stale);
        }
        if *self != Careless::Link && (shared.len() != 2 || draft.complex.cell_count() <= 4) {
            return Err(Refusal::Link);
        }
        let odd = plan.makes.len() == 4;
        match self {
            Careless::Cell if odd => _ = plan.makes.pop(),
            Careless::Turned if odd => plan.makes[0].swap(0, 1),
            Careless::Beside if odd => plan.kills.extend(self.beside(draft, u, v)),
            Careless::Panic if odd => panic!("a vertex of six cells"),
            Careless::Gone if odd => plan.makes[0] = [u, plan.makes[0][1], plan.makes[0][2]],
            Careless::Ever => {
                plan.kills.truncate(1);
                plan.makes = vec![*draft.complex.cell(plan.kills.first().copied().unwrap_or(dying[0]))];
                if plan.kills.is_empty() {
                    plan.kills.push(dying[0]);
                }
                return Ok(());
            }
            _ => {}
        }
        plan.kills.extend(dying);
        plan.retired.push(u);
        plan.kept = Some(v);
        Ok(())
    }
    fn applied(&self, draft: &Draft<3>, (): &mut (), plan: &Plan<3>, again: &mut Vec<Self::Site>) {
        let Some(v) = plan.kept.or(plan.makes.first().map(|cell| cell[0])) else { return };
        let mut around = Vec::new();
        draft.complex.neighbours(v, &mut around);
        again.extend(around.into_iter().map(|u| (u, v)));
    }
}

impl Careless {
    /// A cell at `v` that has not `u`.
    fn beside(self, draft: &Draft<3>, u: VertexId, v: VertexId) -> Option<u32> {
        draft.complex.star(v).map(|(slot, _)| slot).find(|&slot| !draft.complex.cell(slot).contains(&u))
    }
}

/// How often anybody was asked for a price.
static ASKED: AtomicU32 = AtomicU32::new(0);
