//! All the laws on one model, over random fronts, with a counterexample made small.
//!
//! The checkers are `mt_core::check`; law 10 is checked here, because it needs selective refinement.

mod hierarchy;
mod minimality;
mod shrink;

pub use hierarchy::hierarchy;
pub use minimality::minimality;

use mt_core::analysis::{Operator, simplify};
use mt_core::check::{self, Breach, Domain, Law, Random};
use mt_core::container;
use mt_core::model::{MultiTessellation, View, cells_of, mesh_of};
use mt_core::{Explicit, Front, Mesh, NodeId, Order};
use selective::{State, approach};
use std::collections::BTreeMap;

/// How much to check, and what is claimed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Number of random fronts.
    pub fronts: u32,
    /// Seed of the fronts and of all other choices.
    pub seed: u64,
    /// What an explicit model claims; a hierarchy knows it by itself.
    pub topology: Topology,
}

impl Default for Options {
    fn default() -> Self {
        Self { fronts: 100, seed: 1, topology: Topology::Kept }
    }
}

/// What the modifications of an explicit model may do to the topology of its meshes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Topology {
    /// Nothing: where the input is a manifold every mesh is one, oriented as the input is.
    #[default]
    Kept,
    /// Anything that vertex pairs do: sheets are laid onto each other and holes close. What is left of law 3 is the
    /// boundary: the facets with an odd number of cells are those that the modifications make of the input's.
    Coarsened,
}

/// Law 7: analysing the same mesh twice gives the same model, byte for byte.
pub fn determinism<const N: usize, O: Operator<N>>(mesh: &Mesh<N>, operator: &O) -> Result<(), Breach> {
    let breach = |what: String| Breach { law: Law::Determinism, what, node: None };
    let bytes = || {
        let analysis = simplify(mesh, operator, &Default::default(), &mut |_| true);
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

/// How often each law was checked, and held.
pub type Summary = BTreeMap<Law, u64>;

/// A broken law with the smallest case found.
#[derive(Clone, Debug)]
pub struct Counterexample<const N: usize> {
    /// The law, and what is wrong.
    pub breach: Breach,
    /// The front at which it shows, made small; closed.
    pub front: Front,
    /// The mesh of that front.
    pub mesh: Mesh<N>,
    /// Number of nodes of the front at which it was found.
    pub found_at: u32,
    /// Both sides of the modification concerned, where there is one.
    pub patch: Option<(NodeId, mt_core::Patch<N>)>,
}

/// Checks every law of a model: those on the model as a whole once, the others at each random front.
///
/// `watch` hears how many fronts are done and answers whether to go on; a run that is cut short gives the summary so far.
pub fn explicit<const N: usize>(
    model: &Explicit<N>,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<Counterexample<N>>> {
    let mut summary = Summary::new();
    let whole = whole_model(model, options.topology, &mut summary);
    let (order, domain) = whole.map_err(|breach| Box::new(counterexample_of_whole(model, breach)))?;
    let laws = Laws { model, order: &order, domain: &domain };
    let mut random = Random::new(options.seed);
    let mut state = State::new(model, ());
    for done in 0..options.fronts {
        if !watch(done) {
            break;
        }
        let front = check::random_front(&order, &mut random);
        approach(model, &front, &mut state);
        state.steps.clear();
        let case = Random::new(random.bits());
        if let Err(breach) = laws.at(&mut state.view, &mut case.clone(), &mut summary) {
            let found_at = front.len();
            let (front, breach) = shrink::smallest(&order, &front, breach, |smaller| laws.broken(smaller, &case));
            return Err(Box::new(finish(model, breach, front, found_at)));
        }
    }
    Ok(summary)
}

/// The laws on the model as a whole.
fn whole_model<const N: usize>(
    model: &Explicit<N>,
    topology: Topology,
    summary: &mut Summary,
) -> Result<(Order, Domain<N>), Breach> {
    let order = check::order_of(model)?;
    check::order_from_cells(model)?;
    held(summary, Law::Order);
    check::cells(model)?;
    held(summary, Law::Cells);
    let domain = match topology {
        Topology::Kept => check::conformity(model)?,
        // Sheets of a plane that are sewn together lie one over the other, so the content says nothing either.
        Topology::Coarsened => Domain { content: None, ..check::conformity_of_quotient(model)? },
    };
    held(summary, Law::Conformity);
    check::saturation(model)?;
    held(summary, Law::Saturation);
    check::ends(model, &model.reference())?;
    held(summary, Law::Ends);
    Ok((order, domain))
}

fn held(summary: &mut Summary, law: Law) {
    *summary.entry(law).or_default() += 1;
}

/// What the laws at a front are judged by.
struct Laws<'a, const N: usize> {
    model: &'a Explicit<N>,
    order: &'a Order,
    domain: &'a Domain<N>,
}

impl<const N: usize> Laws<'_, N> {
    /// Every law at the front of `view`, which is left as it was.
    fn at(
        &self,
        view: &mut View<mt_core::explicit::Alive>,
        random: &mut Random,
        summary: &mut Summary,
    ) -> Result<(), Breach> {
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

/// A breach that is no front's: it shows at the least front that has the node.
fn counterexample_of_whole<const N: usize>(model: &Explicit<N>, breach: Breach) -> Counterexample<N> {
    let mut front = Front::from_nodes(model.len(), breach.node);
    model.order().close(&mut front);
    finish(model, breach, front.clone(), front.len())
}

fn finish<const N: usize>(model: &Explicit<N>, breach: Breach, front: Front, found_at: u32) -> Counterexample<N> {
    let mut state = State::new(model, ());
    approach(model, &front, &mut state);
    let patch = breach.node.filter(|m| m.0 < model.len()).map(|m| (m, model.patch(m)));
    Counterexample { mesh: mesh_of(model, &state.view.mesh), breach, front, found_at, patch }
}
