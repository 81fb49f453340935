//! The laws on vertex hierarchies, under any dependency scheme: the quotient is the oracle.
//!
//! Static orders are held to every law; dynamic rules to those that do not speak of an order, on fronts that random
//! steps reach.

use super::any::wander;
use super::counterexample::{Case, Counterexample, Found};
use super::reduce::{self, At};
use super::{Options, Summary, Topology, held, minimality, shrink, ties};
use mt_core::check::{self, Breach, Domain, Law, Random};
use mt_core::hierarchy::{Dependency, HierarchyError, VertexMesh};
use mt_core::model::{MultiTessellation, Step, View, cells_of, mesh_of};
use mt_core::{Front, Hierarchy, Mesh, NodeId, Order, Replay, Rule};
use operators::order::{Scheme, Visit};
use selective::{Limits, State, adapt, approach};
use std::sync::Arc;

/// Checks every law that a hierarchy claims: those on the whole once, the others at each random front.
///
/// `watch` hears how many fronts are done and answers whether to go on; a run that is cut short gives the summary so far.
/// The counterexample is of the whole model, since nobody can tell how its dependencies come about: see [`scheme`] and
/// [`super::order`].
pub fn hierarchy<D: Dependency + Send>(
    model: &Hierarchy<D>,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<Counterexample<3>>> {
    find(model, options, None, watch).map_err(|at| {
        let found = found(&model.replay, &at);
        let (front, breach) = simplest_front(model, options, at);
        let mesh = mesh_at(model, &front);
        Box::new(Counterexample { mesh, breach, found, case: Case::Whole, front, patch: None })
    })
}

/// [`hierarchy`] under a scheme, and where a law is broken, the smallest part of the sequence under that scheme.
pub fn scheme(
    replay: &Arc<Replay>,
    scheme: Scheme,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Result<Summary, Box<Counterexample<3>>>, HierarchyError> {
    let mut find = |replay: &Arc<Replay>, look: Look| scheme.visit(replay, look);
    under(replay, options, watch, &mut find)
}

/// Looks at the hierarchy that `find` makes of a replay, and at those of its parts where a law is broken.
pub(super) fn under(
    replay: &Arc<Replay>,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
    find: &mut Finder,
) -> Result<Result<Summary, Box<Counterexample<3>>>, HierarchyError> {
    let at = match find(replay, Look { options: *options, first: None, last: None, watch })? {
        Seen::Held(summary) => return Ok(Ok(summary)),
        Seen::Broken(at) => *at,
        Seen::Simple(_) => unreachable!("nothing was to be made simple"),
    };
    let found = found(replay, &at);
    let mut quiet = |_| true;
    let find = std::cell::RefCell::new(find);
    let judge = |part: &Arc<Replay>, carried: &Front| {
        let options = Options { fronts: reduce::fronts_to_try(part.len()), ..*options };
        let look = Look { options, first: Some((carried, &at.case)), last: None, watch: &mut |_| true };
        match (find.borrow_mut())(part, look) {
            Ok(Seen::Broken(at)) => Some(*at),
            _ => None,
        }
    };
    let small = reduce::smallest(replay, &at, &judge, shrink::deadline());
    let case = small.as_ref().map(|(part, _)| Case::Merges(Box::new(reduce::story_of(part))));
    let (part, at) = small.unwrap_or_else(|| (Arc::clone(replay), at));
    let look = Look { options: *options, first: None, last: Some(at), watch: &mut quiet };
    let Seen::Simple(simple) = (find.borrow_mut())(&part, look)? else { unreachable!("a place was given") };
    let (front, breach, mesh) = *simple;
    Ok(Err(Box::new(Counterexample { mesh, breach, found, case: case.unwrap_or(Case::Whole), front, patch: None })))
}

/// A look at a hierarchy: for a broken law, at `first` before anywhere else; or where `last` is given, for the simplest
/// front at which that is still so.
pub(super) struct Look<'a> {
    pub(super) options: Options,
    pub(super) first: Option<(&'a Front, &'a Random)>,
    pub(super) last: Option<At>,
    pub(super) watch: &'a mut dyn FnMut(u32) -> bool,
}

/// Makes a hierarchy of a replay, and looks at it.
pub(super) type Finder<'a> = dyn FnMut(&Arc<Replay>, Look) -> Result<Seen, HierarchyError> + 'a;

/// What was seen.
pub(super) enum Seen {
    Held(Summary),
    Broken(Box<At>),
    /// The simplest front, what is wrong there, and its mesh.
    Simple(Box<(Front, Breach, Mesh<3>)>),
}

impl Visit for Look<'_> {
    type Output = Seen;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Seen {
        self.at(model)
    }
}

impl Look<'_> {
    /// Looks at a hierarchy under any dependency, also of somebody else's.
    pub(super) fn at<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Seen {
        if let Some(at) = self.last {
            let (front, breach) = simplest_front(model, &self.options, at);
            let mesh = mesh_at(model, &front);
            return Seen::Simple(Box::new((front, breach, mesh)));
        }
        match find(model, &self.options, self.first, self.watch) {
            Ok(summary) => Seen::Held(summary),
            Err(at) => Seen::Broken(Box::new(at)),
        }
    }
}

fn found(replay: &Replay, at: &At) -> Found {
    Found { breach: at.breach.clone(), nodes: replay.len(), cells: replay.cells().len(), front: at.front.len() }
}

/// Checks without making anything small; at the place `first` before any other.
fn find<D: Dependency + Send>(
    model: &Hierarchy<D>,
    options: &Options,
    first: Option<(&Front, &Random)>,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, At> {
    let mut summary = Summary::new();
    let mut random = Random::new(options.seed);
    let laws = Laws::new(model, options, &mut summary).map_err(|breach| At {
        front: Front::base(model.len()),
        breach,
        case: random.clone(),
    })?;
    let mut state = State::new(model, ());
    for done in 0..options.fronts.max(u32::from(first.is_some())) {
        if !watch(done) {
            break;
        }
        let carried = first.filter(|_| done == 0);
        match (D::RULE, carried) {
            (_, Some((front, _))) => reach(model, front, &mut state),
            (Rule::Static, None) => _ = approach(model, &check::random_front(&laws.order, &mut random), &mut state),
            (Rule::Dynamic, None) => wander(model, &mut state, &mut random),
        }
        state.steps.clear();
        let case = carried.map_or_else(|| Random::new(random.bits()), |(_, case)| case.clone());
        let front = state.view.front.clone();
        laws.at(&mut state.view, &mut case.clone(), &mut summary).map_err(|breach| At { front, breach, case })?;
    }
    Ok(summary)
}

/// Goes to a front; under a dynamic rule by legal steps from the base mesh, which may lead to a larger one.
fn reach<D: Dependency + Send>(model: &Hierarchy<D>, front: &Front, state: &mut State<3, Hierarchy<D>, ()>) {
    if D::RULE == Rule::Static {
        approach(model, front, state);
        return;
    }
    *state = State::new(model, ());
    let finest_first: Vec<NodeId> = front.finest_first().collect();
    finest_first.iter().rev().for_each(|&m| state.force(model, m));
}

/// The simplest front of the same model at which the same law is broken.
fn simplest_front<D: Dependency + Send>(model: &Hierarchy<D>, options: &Options, at: At) -> (Front, Breach) {
    let Ok(laws) = Laws::new(model, options, &mut Summary::new()) else { return (at.front, at.breach) };
    let (front, breach) =
        shrink::simplest(&laws.order, &at.front, at.breach.clone(), |simpler| laws.broken(simpler, &at.case));
    let mut state = State::new(model, ());
    reach(model, &front, &mut state);
    // Under a dynamic rule that may be another front, or none at which the law is broken.
    if laws.broken(&front, &at.case).is_some() { (state.view.front, breach) } else { (at.front, at.breach) }
}

struct Laws<'a, D> {
    model: &'a Hierarchy<D>,
    /// For dynamic rules: the forest, and whatever the rule always asks for.
    order: Order,
    domain: Domain<3>,
}

impl<'a, D: Dependency + Send> Laws<'a, D> {
    /// The laws on the model as a whole.
    fn new(model: &'a Hierarchy<D>, options: &Options, summary: &mut Summary) -> Result<Self, Breach> {
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
        if let Some(&node) = replay.sewn().first().filter(|_| options.topology == Topology::Kept && domain.manifold) {
            let what = format!("node {node} sews sheets together or pinches them, which is said not to happen");
            return Err(Breach { law: Law::CrackFree, what, node: Some(node) });
        }
        if !replay.is_manifold() {
            (domain.manifold, domain.oriented) = (false, false);
        }
        if D::RULE == Rule::Static {
            let checked = ties(model, &order, options.seed)?;
            *summary.entry(Law::Minimality).or_default() += u64::from(checked);
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
        reach(self.model, front, &mut state);
        self.at(&mut state.view, &mut case.clone(), &mut Summary::new()).err()
    }
}

/// The mesh of a front that steps of refinement reach from the base mesh.
fn mesh_at<D: Dependency + Send>(model: &Hierarchy<D>, front: &Front) -> Mesh<3> {
    let mut view = model.base_view();
    let finest_first: Vec<NodeId> = front.finest_first().collect();
    for &m in finest_first.iter().rev() {
        mt_core::model::take(model, Step::refine(m), &mut view, &mut ());
    }
    mesh_of(model, &view.mesh)
}
