//! The laws on explicit models: those on the whole once, the others at random fronts; set algebra is the oracle.

use super::counterexample::{Case, Counterexample, Found};
use super::reduce::{self, At};
use super::{Options, Summary, Topology, held, minimality, shrink, ties};
use mt_core::analysis::{self, Operator, simplify};
use mt_core::check::{self, Breach, Domain, Law, Random};
use mt_core::container;
use mt_core::explicit::Alive;
use mt_core::model::{MultiTessellation, View, cells_of, mesh_of};
use mt_core::{Explicit, Front, Mesh, Order};
use selective::{State, approach};

/// Law 7: analysing the same mesh twice gives the same model, byte for byte.
pub fn determinism<const N: usize, O: Operator<N>>(mesh: &Mesh<N>, operator: &O) -> Result<(), Breach> {
    let breach = |what: String| Breach { law: Law::Determinism, what, node: None };
    let bytes = || {
        // Whether plans are good is for other laws.
        let options = analysis::Options { unchecked: true, ..Default::default() };
        let analysis = simplify(mesh, operator, &options, &mut |_| true);
        let model = analysis.map_err(|error| breach(error.to_string()))?.model;
        let mut bytes = Vec::new();
        container::write(&model, &Default::default(), &mut bytes).map_err(|error| breach(error.to_string()))?;
        Ok(bytes)
    };
    let (first, second) = (bytes()?, bytes()?);
    let same = first == second;
    let what = format!("{} made two models of {} and {} bytes of one mesh", operator.name(), first.len(), second.len());
    if same { Ok(()) } else { Err(breach(what)) }
}

/// Checks every law of a model: those on the model as a whole once, the others at each random front.
///
/// `watch` hears how many fronts are done and answers whether to go on; a run that is cut short gives the summary so far.
pub fn explicit<const N: usize>(
    model: &Explicit<N>,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<Counterexample<N>>> {
    find(model, options, None, watch).map_err(|at| Box::new(make_small(model, options, at)))
}

/// Checks without making anything small; at the place `first` before any other.
pub(super) fn find<const N: usize>(
    model: &Explicit<N>,
    options: &Options,
    first: Option<(&Front, &Random)>,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, At> {
    let mut summary = Summary::new();
    let whole = whole_model(model, options, &mut summary);
    let mut random = Random::new(options.seed);
    let (order, domain) =
        whole.map_err(|breach| At { front: front_of(model, &breach), breach, case: random.clone() })?;
    let laws = Laws { model, order: &order, domain: &domain };
    let mut state = State::new(model, ());
    for done in 0..options.fronts.max(u32::from(first.is_some())) {
        if !watch(done) {
            break;
        }
        let drawn = (check::random_front(&order, &mut random), Random::new(random.bits()));
        let (front, case) = first.filter(|_| done == 0).map_or(drawn, |(front, case)| (front.clone(), case.clone()));
        approach(model, &front, &mut state);
        state.steps.clear();
        if let Err(breach) = laws.at(&mut state.view, &mut case.clone(), &mut summary) {
            return Err(At { front, breach, case });
        }
    }
    Ok(summary)
}

/// The smallest part of the model that breaks the same law, at the simplest front.
fn make_small<const N: usize>(model: &Explicit<N>, options: &Options, at: At) -> Counterexample<N> {
    let found = Found {
        breach: at.breach.clone(),
        nodes: model.len(),
        cells: model.input_cell_count() as usize,
        front: at.front.len(),
    };
    let judge = |part: &Explicit<N>, carried: &Front| {
        let options = Options { fronts: reduce::fronts_to_try(part.len()), ..*options };
        find(part, &options, Some((carried, &at.case)), &mut |_| true).err()
    };
    let small = reduce::smallest(model, &at, &judge, shrink::deadline());
    let case = small.as_ref().map(|(part, _)| Case::Cells(Box::new(part.clone())));
    let (part, at) = small.unwrap_or_else(|| (model.clone(), at));
    let (front, breach) = simplest_front(&part, options, at);
    let mut state = State::new(&part, ());
    approach(&part, &front, &mut state);
    let patch = breach.node.filter(|m| m.0 < part.len()).map(|m| (m, part.patch(m)));
    let mesh = mesh_of(&part, &state.view.mesh);
    Counterexample { mesh, breach, found, case: case.unwrap_or(Case::Whole), front, patch }
}

/// The simplest front of the same model at which the same law is broken.
fn simplest_front<const N: usize>(model: &Explicit<N>, options: &Options, at: At) -> (Front, Breach) {
    match whole_model(model, options, &mut Summary::new()) {
        Ok((order, domain)) => {
            let laws = Laws { model, order: &order, domain: &domain };
            shrink::simplest(&order, &at.front, at.breach, |simpler| laws.broken(simpler, &at.case))
        }
        // The front says where it shows, and has no part in it.
        Err(_) => (at.front, at.breach),
    }
}

/// The laws on the model as a whole.
fn whole_model<const N: usize>(
    model: &Explicit<N>,
    options: &Options,
    summary: &mut Summary,
) -> Result<(Order, Domain<N>), Breach> {
    let order = check::order_of(model)?;
    check::order_from_cells(model)?;
    held(summary, Law::Order);
    check::cells(model)?;
    held(summary, Law::Cells);
    let domain = match options.topology {
        Topology::Kept => check::conformity(model)?,
        // Sheets of a plane that are sewn together lie one over the other, so the content says nothing either.
        Topology::Coarsened => Domain { content: None, ..check::conformity_of_quotient(model)? },
    };
    held(summary, Law::Conformity);
    check::saturation(model)?;
    held(summary, Law::Saturation);
    check::ends(model, &model.reference())?;
    held(summary, Law::Ends);
    let checked = ties(model, &order, options.seed)?;
    *summary.entry(Law::Minimality).or_default() += u64::from(checked);
    Ok((order, domain))
}

/// What the laws at a front are judged by.
struct Laws<'a, const N: usize> {
    model: &'a Explicit<N>,
    order: &'a Order,
    domain: &'a Domain<N>,
}

impl<const N: usize> Laws<'_, N> {
    /// Every law at the front of `view`, which is left as it was.
    fn at(&self, view: &mut View<Alive>, random: &mut Random, summary: &mut Summary) -> Result<(), Breach> {
        let model = self.model;
        let other = check::random_front(self.order, random);
        check::closure(self.order, &view.front, &other)?;
        held(summary, Law::Closure);
        let cells = cells_of(model, &view.mesh);
        let algebra = check::set_algebra(model, &view.front)?;
        if !algebra.iter().copied().eq(cells.iter().map(|(id, _)| *id)) {
            let what = format!("the mesh has {} cells, set algebra gives {}", cells.len(), algebra.len());
            return Err(Breach { law: Law::FrontDeterminesMesh, what, node: None });
        }
        let corners: Vec<_> = cells.into_iter().map(|(_, corners)| corners).collect();
        check::crack_free(&corners, model.positions(), self.domain, &self.domain.boundary_at(&view.front))?;
        held(summary, Law::CrackFree);
        let steps = check::inverse(model, view, random, 16)?;
        *summary.entry(Law::Inverse).or_default() += u64::from(steps);
        check::order(model, self.order, view, random, 64)?;
        held(summary, Law::Order);
        check::front_determines_mesh(model, view, random)?;
        held(summary, Law::FrontDeterminesMesh);
        minimality(model, self.order, view, random)?;
        held(summary, Law::Minimality);
        Ok(())
    }

    fn broken(&self, front: &Front, case: &Random) -> Option<Breach> {
        let mut state = State::new(self.model, ());
        approach(self.model, front, &mut state);
        self.at(&mut state.view, &mut case.clone(), &mut Summary::new()).err()
    }
}

/// A breach that is no front's shows at the least front that has the node.
fn front_of<const N: usize>(model: &Explicit<N>, breach: &Breach) -> Front {
    let mut front = Front::from_nodes(model.len(), breach.node.filter(|m| m.0 < model.len()));
    model.order().close(&mut front);
    front
}
