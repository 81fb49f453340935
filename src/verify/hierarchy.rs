//! The laws on vertex hierarchies, under any dependency scheme: the quotient is the oracle.
//!
//! Static orders are held to every law; dynamic rules to those that do not speak of an order, on fronts that random
//! steps reach.

use super::{Counterexample, Options, Summary, Topology, held, minimality, shrink};
use mt_core::check::{self, Breach, Domain, Law, Random};
use mt_core::hierarchy::{Dependency, VertexMesh};
use mt_core::model::{MultiTessellation, Step, View, cells_of, mesh_of};
use mt_core::{Front, Hierarchy, NodeId, Order, Rule};
use selective::{Limits, State, adapt, approach};

/// Checks every law that a hierarchy claims: those on the whole once, the others at each random front.
///
/// `watch` hears how many fronts are done and answers whether to go on; a run that is cut short gives the summary so far.
pub fn hierarchy<D: Dependency + Send>(
    model: &Hierarchy<D>,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<Counterexample<3>>> {
    let mut summary = Summary::new();
    let laws = Laws::new(model, options.topology, &mut summary).map_err(|breach| {
        let front = Front::base(model.len());
        Box::new(counterexample(model, breach, front, 0))
    })?;
    let mut random = Random::new(options.seed);
    let mut state = State::new(model, ());
    for done in 0..options.fronts {
        if !watch(done) {
            break;
        }
        match D::RULE {
            Rule::Static => _ = approach(model, &check::random_front(&laws.order, &mut random), &mut state),
            Rule::Dynamic => wander(model, &mut state, &mut random),
        }
        state.steps.clear();
        let case = Random::new(random.bits());
        let front = state.view.front.clone();
        if let Err(breach) = laws.at(&mut state.view, &mut case.clone(), &mut summary) {
            let found_at = front.len();
            let (front, breach) = match D::RULE {
                Rule::Static => shrink::smallest(&laws.order, &front, breach, |smaller| laws.broken(smaller, &case)),
                Rule::Dynamic => (front, breach),
            };
            return Err(Box::new(counterexample(model, breach, front, found_at)));
        }
    }
    Ok(summary)
}

/// Takes random legal steps, as many as few: forces nodes, and coarsens what lets itself be coarsened.
fn wander<D: Dependency + Send>(model: &Hierarchy<D>, state: &mut State<3, Hierarchy<D>, ()>, random: &mut Random) {
    if model.is_empty() {
        return;
    }
    let picks = f64::from(model.len()).powf(random.unit()) as u32 + 1;
    let refine = random.below(2) == 0;
    for _ in 0..picks {
        let m = NodeId::new(random.below(model.len() as usize));
        if refine != (random.below(8) == 0) {
            state.force(model, m);
        } else {
            // A whole stretch of ranks, finest first: single nodes would hardly ever be free.
            let end = m.0.saturating_add(64).min(model.len());
            for node in (m.0..end).map(NodeId) {
                if state.view.front.is_refined(node) {
                    state.try_coarsen(model, node);
                }
            }
        }
    }
}

struct Laws<'a, D> {
    model: &'a Hierarchy<D>,
    /// For dynamic rules: the forest, and whatever the rule always asks for.
    order: Order,
    domain: Domain<3>,
}

impl<'a, D: Dependency + Send> Laws<'a, D> {
    /// The laws on the model as a whole.
    fn new(model: &'a Hierarchy<D>, topology: Topology, summary: &mut Summary) -> Result<Self, Breach> {
        let replay = &model.replay;
        let order = check::order_of(model)?;
        held(summary, Law::Order);
        check::forest_saturation(model)?;
        check::patch_bounds(replay)?;
        held(summary, Law::Saturation);
        let reference = replay.reference();
        check::ends(model, &reference)?;
        held(summary, Law::Ends);
        // Pairs sew sheets together, so what their meshes are is for the quotient and the boundary's image to say.
        let mut domain = Domain { content: None, ..Domain::of_mesh(&reference) };
        if let Some(&node) = replay.sewn().first().filter(|_| topology == Topology::Kept && domain.manifold) {
            let what = format!("node {node} sews sheets together or pinches them, which is said not to happen");
            return Err(Breach { law: Law::CrackFree, what, node: Some(node) });
        }
        if !replay.is_manifold() {
            (domain.manifold, domain.oriented) = (false, false);
        }
        Ok(Self { model, order, domain })
    }

    /// The mesh of a view is the quotient, and has no cracks.
    fn is_a_mesh(&self, view: &View<VertexMesh>, summary: &mut Summary) -> Result<(), Breach> {
        let (model, replay) = (self.model, &self.model.replay);
        let cells = cells_of(model, &view.mesh);
        let oracle = check::quotient(replay, &view.front);
        if cells != oracle {
            let odd = cells.iter().zip(&oracle).find(|(a, b)| a != b);
            let what =
                format!("the mesh has {} cells, the quotient {}; first difference {odd:?}", cells.len(), oracle.len());
            return Err(Breach { law: Law::Quotient, what, node: None });
        }
        held(summary, Law::Quotient);
        let corners: Vec<_> = cells.into_iter().map(|(_, corners)| corners).collect();
        let boundary = check::boundary_chain(replay, &view.front);
        check::crack_free(&corners, model.positions(), &self.domain, &boundary)?;
        held(summary, Law::CrackFree);
        Ok(())
    }

    /// Every law at the front of `view`, which is left as it was.
    fn at(&self, view: &mut View<VertexMesh>, random: &mut Random, summary: &mut Summary) -> Result<(), Breach> {
        let (model, replay) = (self.model, &self.model.replay);
        let breach = |law, node, what| Err(Breach { law, what, node });
        if let Err((node, parent)) = check::is_cut(replay, &view.front) {
            return breach(
                Law::Closure,
                Some(node),
                format!("node {node} is refined before node {parent}, its parent"),
            );
        }
        self.is_a_mesh(view, summary)?;
        if self.domain.manifold && D::RULE == Rule::Static {
            check::dual_pieces(replay, &view.front)?;
            held(summary, Law::Partition);
        }
        let steps = check::inverse(model, view, random, 16)?;
        *summary.entry(Law::Inverse).or_default() += u64::from(steps);
        match D::RULE {
            Rule::Static => self.static_laws(view, random, summary),
            Rule::Dynamic => self.engine(view, random, summary),
        }
    }

    /// What the engine makes of a random wish, without a budget and under one, is a mesh like any other.
    fn engine(&self, view: &View<VertexMesh>, random: &mut Random, summary: &mut Summary) -> Result<(), Breach> {
        if self.model.is_empty() {
            return Ok(());
        }
        let wish = minimality::draw(self.model, random);
        let mut state = State::new(self.model, ());
        state.view = view.clone();
        let base = self.model.base_view();
        let most = self.model.cell_count(&base.mesh) + random.below(1 + self.model.len() as usize) as u32;
        for cells in [None, Some(most)] {
            adapt(self.model, &wish, &Limits { cells, time: None }, &mut state);
            self.is_a_mesh(&state.view, summary)?;
            let count = self.model.cell_count(&state.view.mesh);
            if cells.is_some_and(|most| count > most) {
                let what = format!("{count} cells under a budget of {most}");
                return Err(Breach { law: Law::Minimality, what, node: None });
            }
        }
        Ok(())
    }

    fn static_laws(&self, view: &View<VertexMesh>, random: &mut Random, summary: &mut Summary) -> Result<(), Breach> {
        let other = check::random_front(&self.order, random);
        check::closure(&self.order, &view.front, &other)?;
        held(summary, Law::Closure);
        check::order(self.model, &self.order, view, random, 64)?;
        held(summary, Law::Order);
        check::front_determines_mesh(self.model, view, random)?;
        held(summary, Law::FrontDeterminesMesh);
        minimality(self.model, &self.order, view, random)?;
        held(summary, Law::Minimality);
        Ok(())
    }

    fn broken(&self, front: &Front, case: &Random) -> Option<Breach> {
        let mut state = State::new(self.model, ());
        approach(self.model, front, &mut state);
        self.at(&mut state.view, &mut case.clone(), &mut Summary::new()).err()
    }
}

/// The mesh of a front that steps of refinement reach from the base mesh.
fn counterexample<D: Dependency + Send>(
    model: &Hierarchy<D>,
    breach: Breach,
    front: Front,
    found_at: u32,
) -> Counterexample<3> {
    let mut view = model.base_view();
    let coarsest_first: Vec<NodeId> = front.finest_first().collect();
    for &m in coarsest_first.iter().rev() {
        mt_core::model::take(model, Step::refine(m), &mut view, &mut ());
    }
    Counterexample { mesh: mesh_of(model, &view.mesh), breach, front, found_at, patch: None }
}
