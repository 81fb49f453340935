//! The run-time state of one camera: its view, the log of its steps, and scratch memory for the engine.

use mt_core::model::take;
use mt_core::{Bits, Coarsen, Front, MultiTessellation, NodeId, Sink, Step, View};
use serde::Serialize;
use std::collections::BinaryHeap;
use std::time::{Duration, Instant};

/// One camera's state of a model. The model is shared and immutable; two cameras are two states.
///
/// For an explicit model: a bit for each of its cells, two for each node, the log, and scratch of the size of the front.
/// Call it with the model that it was made for.
#[derive(Clone, Debug)]
pub struct State<const N: usize, M: MultiTessellation<N>, S> {
    /// Front and current mesh.
    pub view: View<M::Mesh>,
    /// Hears of cells.
    pub sink: S,
    /// Every step taken, in order; the caller may clear it at any time.
    pub steps: Vec<Step>,
    pub(crate) scratch: Scratch,
    /// Where a front that fits a budget is looked for, always from the base mesh; made when it is first needed.
    pub(crate) search: Option<Box<State<N, M, ()>>>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// How many steps each forcing of the last call took.
    pub(crate) chains: Vec<u32>,
    /// The front before the call, for criteria with memory.
    pub(crate) before: Front,
    /// The nodes in which two fronts differ.
    pub(crate) wanted: Vec<NodeId>,
    /// The chain that is being forced.
    pub(crate) chain: Vec<NodeId>,
    /// The nodes of the chain that is being counted, or the runs that are. Empty in between.
    pub(crate) marked: Bits,
    /// Answers of the model.
    pub(crate) nodes: Vec<NodeId>,
    /// Nodes still to be judged, depth first.
    pub(crate) open: Vec<NodeId>,
    /// Nodes still to be judged, most urgent first.
    pub(crate) queue: BinaryHeap<Urgent>,
}

/// A node by its excess; of equals the one of higher rank first.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Urgent {
    pub(crate) excess: f32,
    pub(crate) node: NodeId,
}

impl Eq for Urgent {}
impl PartialOrd for Urgent {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Urgent {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.excess.total_cmp(&other.excess).then(self.node.cmp(&other.node))
    }
}

/// What selective refinement may use.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Most cells the mesh may have; never exceeded, unless the base mesh itself has more.
    pub cells: Option<u32>,
    /// Time after which to leave a legal mesh as it is. The next call goes on.
    pub time: Option<Duration>,
}

impl Limits {
    /// No limit.
    pub const NONE: Limits = Limits { cells: None, time: None };

    pub(crate) fn deadline(&self) -> Option<Instant> {
        self.time.map(|time| Instant::now() + time)
    }
}

/// What a call did.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Outcome {
    /// Steps that refined.
    pub refined: u32,
    /// Steps that coarsened.
    pub coarsened: u32,
    /// Of those that refined: nodes that the criterion did not ask for, but others need.
    pub forced: u32,
    /// Steps of the longest chain: the most that refining a single node took, itself and all that had to go before.
    /// Where a criterion judges runs of nodes as one, a run is such a node. See [`State::chains`] for each of them.
    pub chain_max: u32,
    /// Runs of more than one node that were refined or coarsened as one; 0 unless the criterion is [`crate::OnPath`].
    /// What a fan hierarchy calls fan steps.
    pub runs: u32,
    /// All other steps, which were taken by themselves.
    pub singles: u32,
    /// Whether the criterion is satisfied; not so when time ran out or the budget is used up.
    pub complete: bool,
}

impl Outcome {
    /// The same where so many runs of so many nodes were changed as one.
    pub(crate) fn with_runs(self, (runs, nodes): (u32, u32)) -> Self {
        Self { runs, singles: self.singles - nodes, ..self }
    }
}

impl<const N: usize, M: MultiTessellation<N>, S: Sink<N>> State<N, M, S> {
    /// The base mesh; `sink` hears of its cells.
    pub fn new(model: &M, mut sink: S) -> Self {
        let view = model.base_view();
        model.cells(&view.mesh, |cell, corners| sink.make(cell, corners));
        let scratch = Scratch { marked: Bits::new(model.len()), ..Scratch::default() };
        Self { view, sink, steps: Vec::new(), scratch, search: None }
    }

    /// How many steps each forcing of the last call took: the node that was asked for, and all it needed that was not
    /// refined by then. Whoever wants the number of forced nodes takes off one. In the order of the call; under a budget
    /// of cells from the base mesh, and only those that fitted.
    pub fn chains(&self) -> &[u32] {
        &self.scratch.chains
    }

    /// Forces `m` for an engine, which counts chains.
    pub(crate) fn force_counted(&mut self, model: &M, m: NodeId) {
        let mark = self.steps.len();
        self.force(model, m);
        self.scratch.chains.push((self.steps.len() - mark) as u32);
    }

    /// The refined nodes.
    pub fn front(&self) -> &Front {
        &self.view.front
    }

    /// Number of cells of the current mesh.
    pub fn cell_count(&self, model: &M) -> u32 {
        model.cell_count(&self.view.mesh)
    }

    /// Takes a legal step and logs it.
    pub fn take(&mut self, model: &M, step: Step) {
        take(model, step, &mut self.view, &mut self.sink);
        self.steps.push(step);
    }

    /// Refines `m` after all that it needs. An explicit stack, so chains may be as deep as the model.
    pub fn force(&mut self, model: &M, m: NodeId) {
        let mut chain = std::mem::take(&mut self.scratch.chain);
        chain.push(m);
        while let Some(&top) = chain.last() {
            if self.view.front.is_refined(top) {
                chain.pop();
                continue;
            }
            let before = chain.len();
            model.prerequisites(top, &self.view, &mut chain);
            // Larger ids, and not yet refined: so the chain ends.
            // A model that says otherwise would be asked for ever.
            assert!(chain[before..].iter().all(|&need| need > top), "node {top} waits for a node of no higher rank");
            debug_assert!(chain[before..].iter().all(|&need| !self.view.front.is_refined(need)));
            if chain.len() == before {
                chain.pop();
                self.take(model, Step::refine(top));
            }
        }
        self.scratch.chain = chain;
    }

    /// Coarsens `m` if nothing stands in the way; whether it did.
    pub fn try_coarsen(&mut self, model: &M, m: NodeId) -> bool {
        self.scratch.nodes.clear();
        let now = model.obstacles(m, &self.view, &mut self.scratch.nodes) == Coarsen::Now;
        if now {
            self.take(model, Step::coarsen(m));
        }
        now
    }

    /// Undoes the steps after the first `mark`, last first, and takes them off the log.
    pub fn roll_back(&mut self, model: &M, mark: usize) {
        while self.steps.len() > mark {
            let step = self.steps.pop().expect("the log is longer than the mark");
            take(model, step.inverse(), &mut self.view, &mut self.sink);
        }
    }

    /// Counts the steps since `mark`, each by itself.
    pub(crate) fn outcome_since(&self, mark: usize, forced: u32, complete: bool) -> Outcome {
        let steps = (self.steps.len() - mark) as u32;
        let refined = self.steps[mark..].iter().filter(|step| step.refined).count() as u32;
        let chain_max = self.scratch.chains.iter().copied().max().unwrap_or(0);
        Outcome { refined, coarsened: steps - refined, forced, chain_max, runs: 0, singles: steps, complete }
    }
}
