//! The loop of analysis: take the cheapest site, plan, apply, record.

use super::measure::Measure;
use super::queue::Queue;
use super::regions::RegionOperator;
use super::{Draft, Listener, Operator, Unfit};
use crate::bits::Bits;
use crate::check;
use crate::explicit::{ErrorKind, Explicit, HistoryError, Recorder};
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::plan::{Plan, Refusal, RefusalCounts};
use std::time::{Duration, Instant};

/// When to stop, and what errors to record.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Stop at this many cells or as soon below as the operator's steps allow.
    pub until_cells: Option<u32>,
    /// Refuse modifications with an error above this, in model units.
    pub until_error: Option<f32>,
    /// Which errors to record: the operator's estimates, or measured distances (triangles only).
    pub error_kind: ErrorKind,
    /// Takes plans as they come. Else debug builds judge each before it is applied, and panic at a bad one; who wants to
    /// see what a bad operator does, as verification does, wants it recorded instead.
    pub unchecked: bool,
}

/// Why analysis ended.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// No legal site is left.
    Exhausted,
    /// The wanted number of cells is reached.
    Cells,
    /// Every site that is left has a larger error than wanted, or is refused for another reason.
    Error,
    /// Somebody asked to stop.
    Cancelled,
}

impl std::fmt::Display for Stopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Stopped::Exhausted => "nothing legal is left",
            Stopped::Cells => "the wanted number of cells is reached",
            Stopped::Error => "the wanted error is reached",
            Stopped::Cancelled => "cancelled",
        })
    }
}

/// What analysis made.
#[derive(Clone, Debug)]
pub struct Analysis<const N: usize> {
    /// The model.
    pub model: Explicit<N>,
    /// Refused plans by reason; a site may be refused more than once.
    pub refusals: RefusalCounts,
    /// Why it ended.
    pub stopped: Stopped,
}

/// How an analysis ended.
#[derive(Copy, Clone, Debug)]
pub struct Ended {
    /// Refused plans by reason; a site may be refused more than once.
    pub refusals: RefusalCounts,
    /// Why it ended.
    pub stopped: Stopped,
}

/// How far analysis is.
#[derive(Copy, Clone, Debug)]
pub struct Progress {
    /// Cells of the input.
    pub cells_in: usize,
    /// Cells now.
    pub cells: usize,
}

/// Why analysis failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// The operator cannot take the mesh.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// Distances are measured to triangles only.
    #[error("errors are measured for triangles only, not for cells of {0} corners")]
    Measured(usize),
    /// What is measured in one region may be nearest to another.
    #[error("errors are not measured by regions; analyse the mesh as a whole")]
    MeasuredByRegions,
    /// There are no threads to be had.
    #[error("no threads: {0}")]
    Threads(String),
    /// The operator told a history that cannot be, which is a fault of the operator.
    #[error("the operator's modification cannot be recorded: {0}")]
    History(#[from] HistoryError),
}

/// Coarsens `mesh` by `operator` and records everything as an explicit model: [`analyse`] with a [`Recorder`].
pub fn simplify<const N: usize, O: Operator<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    options: &Options,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Analysis<N>, AnalysisError> {
    let mut recorder = Recorder::new(mesh)?;
    let Ended { refusals, stopped } = analyse(mesh, operator, options, &mut recorder, watch)?;
    Ok(Analysis { model: recorder.finish(options.error_kind)?, refusals, stopped })
}

/// Coarsens `mesh` by `operator` and tells `listener` of every modification.
///
/// `watch` hears of progress every few hundred sites and answers whether to go on. The result is the same for
/// the same input, bit for bit. O(sites), besides what the operator costs; refused sites are tried
/// again once the others are done, as long as that gets somewhere.
pub fn analyse<const N: usize, O: Operator<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    options: &Options,
    listener: &mut (impl Listener<N> + ?Sized),
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Ended, AnalysisError> {
    check_kind::<N>(options)?;
    let mut work = Work::new(mesh, operator, options)?;
    let cells = options.until_cells.map(|cells| cells as usize);
    let stopped = work.run(Until { price: f64::INFINITY, cells }, listener, watch)?;
    Ok(Ended { refusals: work.refusals, stopped })
}

pub(super) fn check_kind<const N: usize>(options: &Options) -> Result<(), AnalysisError> {
    if options.error_kind == ErrorKind::Measured && N != 3 { Err(AnalysisError::Measured(N)) } else { Ok(()) }
}

/// How far to go.
#[derive(Clone, Copy)]
pub(super) struct Until {
    /// No site above this price, to within an eighth.
    pub(super) price: f64,
    /// As few cells as this.
    pub(super) cells: Option<usize>,
}

/// The vertices that may not be touched, and how to tell by a site.
struct Frozen<S> {
    vertices: Bits,
    is_free: fn(S, &Bits) -> bool,
}

/// Who watches hears at least this often, if a turn takes no longer.
const WATCH_AT_LEAST: Duration = Duration::from_millis(100);

/// An analysis under way.
pub(super) struct Work<'a, const N: usize, O: Operator<N>> {
    operator: &'a O,
    options: &'a Options,
    draft: Draft<N>,
    aux: O::Aux,
    queue: Queue<O::Site>,
    /// Refused sites, tried again when the queue is empty: what was in their way may be gone.
    parked: Vec<O::Site>,
    /// Where only a region is worked on.
    frozen: Option<Frozen<O::Site>>,
    refusals: RefusalCounts,
    measure: Option<Measure>,
    plan: Plan<N>,
    slots: Vec<u32>,
    again: Vec<O::Site>,
}

impl<'a, const N: usize, O: Operator<N>> Work<'a, N, O> {
    fn new(mesh: &Mesh<N>, operator: &'a O, options: &'a Options) -> Result<Self, AnalysisError> {
        let draft = Draft::new(mesh);
        let mut sites = Vec::new();
        let aux = operator.prepare(&draft, &mut sites)?;
        let measure = (options.error_kind == ErrorKind::Measured).then(|| Measure::new(mesh));
        Ok(Self { measure, ..Self::with(draft, operator, aux, sites, options) })
    }

    fn with(draft: Draft<N>, operator: &'a O, aux: O::Aux, sites: Vec<O::Site>, options: &'a Options) -> Self {
        let priced = sites.iter().filter_map(|&site| Some((operator.price(&draft, &aux, site)?, site)));
        let queue = Queue::new(priced);
        Self {
            operator,
            options,
            aux,
            queue,
            parked: Vec::new(),
            frozen: None,
            refusals: RefusalCounts::default(),
            measure: None,
            draft,
            plan: Plan::default(),
            slots: Vec::new(),
            again: Vec::new(),
        }
    }

    pub(super) fn draft(&self) -> &Draft<N> {
        &self.draft
    }

    pub(super) fn aux(&self) -> &O::Aux {
        &self.aux
    }

    pub(super) fn refusals(&self) -> RefusalCounts {
        self.refusals
    }

    /// The vertices that may not be touched. Requires: work on a region.
    pub(super) fn frozen(&self) -> &Bits {
        &self.frozen.as_ref().expect("work on a region knows what is frozen").vertices
    }

    /// Whether sites wait that are dearer than the last price gone to.
    pub(super) fn has_sites(&self) -> bool {
        self.queue.counts().iter().any(|&count| count > 0)
    }

    /// How many sites have each price, as [`super::queue::median_above`] takes it.
    pub(super) fn price_counts(&self) -> Vec<usize> {
        self.queue.counts()
    }

    /// Goes as far as told, and may be told to go further.
    pub(super) fn run(
        &mut self,
        until: Until,
        listener: &mut (impl Listener<N> + ?Sized),
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Stopped, AnalysisError> {
        let cells_in = self.draft.complex.cell_count();
        let mut applied_since_parking = true;
        let mut too_coarse = false;
        let mut told = Instant::now();
        for turn in 0u64.. {
            let cells = self.draft.complex.cell_count();
            if until.cells.is_some_and(|wanted| cells <= wanted) {
                return Ok(Stopped::Cells);
            }
            // Often enough to be stopped where a single turn is slow, as at hubs; seldom enough to cost nothing.
            let due = turn.is_multiple_of(256) || turn.is_multiple_of(8) && told.elapsed() > WATCH_AT_LEAST;
            if due {
                if !watch(Progress { cells_in, cells }) {
                    return Ok(Stopped::Cancelled);
                }
                told = Instant::now();
            }
            let Some(site) = self.queue.pop_until(until.price) else {
                if !applied_since_parking || self.parked.is_empty() {
                    break;
                }
                applied_since_parking = false;
                self.unpark();
                continue;
            };
            match self.try_site(site) {
                Ok(()) if self.options.until_error.is_some_and(|most| self.plan.error > most) => too_coarse = true,
                Ok(()) => {
                    self.apply(listener)?;
                    applied_since_parking = true;
                }
                Err(Refusal::Stale) => {}
                Err(refusal) => {
                    self.refusals.add(refusal);
                    self.put_off(site, refusal);
                }
            }
        }
        Ok(if too_coarse { Stopped::Error } else { Stopped::Exhausted })
    }

    /// A refused site waits for its neighbourhood to change; another way to act there takes its own turn.
    fn put_off(&mut self, site: O::Site, refusal: Refusal) {
        let other = self.operator.alternative(site, refusal);
        if let Some((other, price)) =
            other.and_then(|other| Some((other, self.operator.price(&self.draft, &self.aux, other)?)))
        {
            self.queue.push(price, other);
        }
        // What the boundary rule forbids it will forbid again.
        if refusal != Refusal::Boundary && self.operator.waits(site) {
            self.parked.push(site);
        }
    }

    fn unpark(&mut self) {
        for site in std::mem::take(&mut self.parked) {
            if let Some(price) = self.operator.price(&self.draft, &self.aux, site) {
                self.queue.push(price, site);
            }
        }
    }

    fn try_site(&mut self, site: O::Site) -> Result<(), Refusal> {
        self.plan.clear();
        self.operator.plan(&self.draft, &self.aux, site, &mut self.plan)?;
        if let Some(measure) = &mut self.measure {
            self.plan.error = measure.of_plan(&self.draft, &self.plan);
            // What was measured is the whole; the operator's errors of its parts are in another currency.
            self.plan.errors.clear();
        }
        Ok(())
    }

    fn apply(&mut self, listener: &mut (impl Listener<N> + ?Sized)) -> Result<(), HistoryError> {
        if cfg!(debug_assertions) && !self.options.unchecked {
            assert_eq!(check::plan(&self.draft.complex, &self.plan), Ok(()), "{} plans badly", self.operator.name());
        }
        listener.applying(&self.draft, &self.plan)?;
        self.draft.apply(&self.plan, &mut self.slots);
        listener.applied(&mut self.draft, &self.plan, &self.slots)?;
        if let Some(measure) = &mut self.measure {
            measure.applied(&self.slots);
        }
        self.again.clear();
        self.operator.applied(&self.draft, &mut self.aux, &self.plan, &mut self.again);
        if let Some(Frozen { vertices, is_free }) = &self.frozen {
            let is_frozen = |v: &VertexId| v.0 < vertices.capacity() && vertices.contains(v.0);
            debug_assert!(
                !self.plan.retired.iter().chain(&self.plan.kept).any(is_frozen),
                "a frozen vertex is touched"
            );
            self.again.retain(|&site| is_free(site, vertices));
        }
        for &site in &self.again {
            if let Some(price) = self.operator.price(&self.draft, &self.aux, site) {
                self.queue.push(price, site);
            }
        }
        Ok(())
    }
}

impl<'a, const N: usize, O: RegionOperator<N>> Work<'a, N, O> {
    /// Work on a region, of which these vertices are frozen.
    pub(super) fn in_region(draft: Draft<N>, operator: &'a O, aux: O::Aux, frozen: Bits, options: &'a Options) -> Self {
        let mut sites = Vec::new();
        operator.sites(&draft, &aux, &mut sites);
        let is_free = |site, frozen: &Bits| O::is_free(site, frozen);
        sites.retain(|&site| is_free(site, &frozen));
        let frozen = Some(Frozen { vertices: frozen, is_free });
        Self { frozen, ..Self::with(draft, operator, aux, sites, options) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;
    use crate::model::MultiTessellation;

    /// Takes triangles of a row away, each by a site of its own; the first only when the second is gone, though it is
    /// cheaper, and the third never.
    struct Choosy;

    impl Operator<3> for Choosy {
        type Site = u32;
        type Aux = ();

        fn name(&self) -> &'static str {
            "choosy"
        }
        fn prepare(&self, _: &Draft<3>, sites: &mut Vec<u32>) -> Result<(), Unfit> {
            sites.extend([0, 1, 2]);
            Ok(())
        }
        fn price(&self, draft: &Draft<3>, (): &(), site: u32) -> Option<f64> {
            draft.complex.is_live(site).then_some(f64::from(site))
        }
        fn plan(&self, draft: &Draft<3>, (): &(), site: u32, plan: &mut Plan<3>) -> Result<(), Refusal> {
            match site {
                0 if draft.complex.is_live(1) => Err(Refusal::Other),
                2 => Err(Refusal::Boundary),
                _ => {
                    plan.kills.push(site);
                    Ok(())
                }
            }
        }
        fn applied(&self, _: &Draft<3>, (): &mut (), _: &Plan<3>, _: &mut Vec<u32>) {}
    }

    #[test]
    fn what_is_refused_is_tried_again_when_the_others_are_done() {
        let mesh = generate::components(&[generate::triangle(), generate::triangle(), generate::triangle()]);
        let options = Options { unchecked: true, ..Options::default() };
        let analysis = simplify(&mesh, &Choosy, &options, &mut |_| true).unwrap();
        assert_eq!(analysis.stopped, Stopped::Exhausted);
        let order = [0, 1].map(|m| analysis.model.fine_side(crate::NodeId(m))[0].0);
        assert_eq!((analysis.model.len(), order), (2, [1, 0]));
        // The first is refused once; what the boundary rule forbids is not asked for again.
        assert_eq!((analysis.refusals.of(Refusal::Other), analysis.refusals.of(Refusal::Boundary)), (1, 1));
        // As few cells as are wanted, and no fewer.
        let options = Options { until_cells: Some(2), ..options };
        let analysis = simplify(&mesh, &Choosy, &options, &mut |_| true).unwrap();
        assert_eq!((analysis.stopped, analysis.model.len()), (Stopped::Cells, 1));
        // An error that is just as large as is allowed is allowed.
        let options = Options { until_error: Some(0.0), until_cells: None, ..options };
        let analysis = simplify(&mesh, &Choosy, &options, &mut |_| true).unwrap();
        assert_eq!((analysis.stopped, analysis.model.len()), (Stopped::Exhausted, 2));
    }
}
