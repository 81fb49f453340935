//! The laws on anything that implements the trait: what can be said without knowing what a model is made of.
//!
//! What is left of law 3 where nobody can tell how the boundary moves: where topology is kept, every mesh is a manifold if
//! the reference is one, closed if it is, and has its Euler characteristic. On closed meshes a cell too few, one too many
//! or a slit along an edge changes one of these; of an open mesh a front may lose an ear at the boundary unseen.

use super::counterexample::{Case, Counterexample, Found};
use super::specimen::{Generated, Spec, specimens};
use super::trial::{self, Finding, Tally, Trial};
use super::{Options, Summary, Topology, held, minimality, shrink, text, ties};
use mt_core::cell::{Cell, facets};
use mt_core::check::{self, Breach, Domain, Law, Random};
use mt_core::model::{MultiTessellation, Step, View, cells_of, mesh_of, take};
use mt_core::{Bound, Front, Mesh, NodeId, Order, Rule};
use selective::{State, approach};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::panic::Location;

/// Checks every law of any model; of a dynamic rule those that do not speak of an order.
///
/// `watch` hears how many fronts are done and answers whether to go on; a run that is cut short gives the summary so far.
/// The counterexample has the front made small, of the whole model: nobody can tell how to take one apart.
pub fn model<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<Counterexample<N>>> {
    let gains: i64 = (0..model.len()).filter_map(|m| model.gain(NodeId(m))).map(i64::from).sum();
    let base = model.base_view();
    let cells = usize::try_from(i64::from(model.cell_count(&base.mesh)) + gains).unwrap_or(0);
    let found = |breach: &Breach, front: u32| Found { breach: breach.clone(), nodes: model.len(), cells, front };
    let (breach, found, front) = match trial::guarded("the model", || look(model, options, watch)) {
        Ok(Ok(summary)) => return Ok(summary),
        Ok(Err(places)) => {
            let (at, simple) = *places;
            (simple.1, found(&at.1, at.0.len()), simple.0)
        }
        Err(breach) => (breach.clone(), found(&breach, 0), Front::base(model.len())),
    };
    let mesh = trial::guarded("the model", || mesh_at(model, &front)).unwrap_or_default();
    Err(Box::new(Counterexample { breach, found, case: Case::Whole, front, mesh, patch: None }))
}

/// A front, and what is wrong there.
type Place = (Front, Breach);

/// Checks; where something is wrong, the place where it was found, and the simplest.
fn look<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    options: &Options,
    watch: &mut dyn FnMut(u32) -> bool,
) -> Result<Summary, Box<(Place, Place)>> {
    let mut summary = Summary::new();
    let laws = Laws::new(model, options, &mut summary).map_err(|breach| {
        let whole = (Front::base(model.len()), breach);
        Box::new((whole.clone(), whole))
    })?;
    let mut random = Random::new(options.seed);
    let mut state = State::new(model, ());
    for done in 0..options.fronts {
        if !watch(done) {
            break;
        }
        match M::RULE {
            Rule::Static => _ = approach(model, &check::random_front(&laws.order, &mut random), &mut state),
            Rule::Dynamic => wander(model, &mut state, &mut random),
        }
        state.steps.clear();
        let (front, case) = (state.view.front.clone(), Random::new(random.bits()));
        if let Err(breach) = laws.at(&mut state.view, &mut case.clone(), &mut summary) {
            let at = (front.clone(), breach.clone());
            let simple = match M::RULE {
                Rule::Static => shrink::simplest(&laws.order, &front, breach, |simpler| laws.broken(simpler, &case)),
                Rule::Dynamic => (front, breach),
            };
            return Err(Box::new((at, simple)));
        }
    }
    Ok(summary)
}

/// Random legal steps, as many as few.
pub(super) fn wander<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    state: &mut State<N, M, ()>,
    random: &mut Random,
) {
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

/// The mesh of a front that refining from the base mesh reaches.
fn mesh_at<const N: usize, M: MultiTessellation<N>>(model: &M, front: &Front) -> Mesh<N> {
    let mut view = model.base_view();
    let finest_first: Vec<NodeId> = front.finest_first().collect();
    finest_first.iter().rev().for_each(|&m| take(model, Step::refine(m), &mut view, &mut ()));
    mesh_of(model, &view.mesh)
}

/// The laws of one model, to be judged at views of it.
#[derive(Debug)]
pub struct Laws<'a, const N: usize, M> {
    model: &'a M,
    order: Order,
    domain: Domain<N>,
    /// Euler characteristic of the reference, where every mesh is to have it.
    characteristic: Option<i64>,
    is_closed: bool,
}

impl<'a, const N: usize, M: MultiTessellation<N, Bound = Bound>> Laws<'a, N, M> {
    /// The laws on the model as a whole, and what the others are judged by. O(model).
    pub fn new(model: &'a M, options: &Options, summary: &mut Summary) -> Result<Self, Breach> {
        let order = check::order_of(model)?;
        held(summary, Law::Order);
        check::forest_saturation(model)?;
        held(summary, Law::Saturation);
        let reference = mesh_at(model, &Front::reference(model.len()));
        let kept = options.topology == Topology::Kept;
        let of_mesh = Domain::of_mesh(&reference);
        let characteristic = characteristic_of(&reference.cells);
        let is_closed = boundary_of(&reference.cells).is_empty();
        let domain = Domain {
            // Where a boundary moves, the domain does.
            content: of_mesh.content.filter(|_| kept && is_closed),
            manifold: kept && of_mesh.manifold,
            oriented: kept && of_mesh.oriented,
            ..Domain::default()
        };
        let laws = Self { model, order, domain, characteristic: kept.then_some(characteristic), is_closed };
        if M::RULE == Rule::Static {
            let checked = ties(model, &laws.order, options.seed)?;
            *summary.entry(Law::Minimality).or_default() += u64::from(checked);
        }
        Ok(laws)
    }

    /// Law 3: the mesh of a view has no cracks, as far as that can be told without knowing how the model came about.
    pub fn is_a_mesh(&self, view: &View<M::Mesh>) -> Result<(), Breach> {
        let cells: Vec<Cell<N>> = cells_of(self.model, &view.mesh).into_iter().map(|(_, corners)| corners).collect();
        let told = self.model.cell_count(&view.mesh) as usize;
        if told != cells.len() {
            let what = format!("the model tells of {} cells and counts {told}", cells.len());
            return Err(trial::breach(Law::FrontDeterminesMesh, what));
        }
        let boundary = boundary_of(&cells);
        if self.is_closed && !boundary.is_empty() {
            let what = format!("{} facets are open, but the reference has no boundary", boundary.len());
            return Err(trial::breach(Law::CrackFree, what));
        }
        check::crack_free(&cells, self.model.positions(), &self.domain, &boundary.into_iter().collect())?;
        let characteristic = characteristic_of(&cells);
        match self.characteristic.filter(|&wanted| wanted != characteristic) {
            Some(wanted) => {
                let what = format!("the Euler characteristic is {characteristic}, that of the reference {wanted}");
                Err(trial::breach(Law::CrackFree, what))
            }
            None => Ok(()),
        }
    }

    /// Every law at the front of `view`, which is left as it was.
    pub fn at(&self, view: &mut View<M::Mesh>, random: &mut Random, summary: &mut Summary) -> Result<(), Breach> {
        self.is_a_mesh(view)?;
        held(summary, Law::CrackFree);
        let steps = check::inverse(self.model, view, random, 16)?;
        *summary.entry(Law::Inverse).or_default() += u64::from(steps);
        if M::RULE == Rule::Dynamic {
            return Ok(());
        }
        check::closure(&self.order, &view.front, &check::random_front(&self.order, random))?;
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

/// Facets with an odd number of cells.
fn boundary_of<const N: usize>(cells: &[Cell<N>]) -> BTreeSet<mt_core::Facet<N>> {
    let mut open = BTreeSet::new();
    for (facet, _) in cells.iter().flat_map(facets) {
        if !open.remove(&facet) {
            open.insert(facet);
        }
    }
    open
}

/// Vertices less edges, plus triangles, less tetrahedra: the alternating sum over all faces of the cells.
fn characteristic_of<const N: usize>(cells: &[Cell<N>]) -> i64 {
    let mut faces: BTreeSet<Vec<u32>> = BTreeSet::new();
    for cell in cells {
        for chosen in 1..1u32 << N {
            let mut face: Vec<u32> = (0..N).filter(|i| chosen >> i & 1 == 1).map(|i| cell[i].0).collect();
            face.sort_unstable();
            faces.insert(face);
        }
    }
    faces.iter().map(|face| if face.len() % 2 == 1 { 1 } else { -1 }).sum()
}

/// Judges a Multi-Tessellation of one's own, given as what makes it of a mesh: on generated meshes every law that it
/// claims, and that its full front is the mesh it was made of. To be called in a test. What it does not take it refuses
/// with a reason.
///
/// # Panics
/// With a [`Finding`] where a law is broken.
#[track_caller]
pub fn models<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    trial: &Trial,
    name: &str,
    make: impl Fn(&Mesh<N>) -> Result<M, String>,
) -> Tally
where
    Mesh<N>: Generated<N>,
{
    let tally = RefCell::new(Tally::default());
    let options = |seed: u64| Options { fronts: trial.fronts, seed, topology: trial.topology };
    let judge = |mesh: &Mesh<N>, seed: u64, tally: &mut Tally| -> Result<(), Box<Counterexample<N>>> {
        let alone = |breach| without_model(mesh, breach);
        let made = trial::guarded("making the model", || make(mesh)).map_err(alone)?;
        let made = match made {
            Ok(made) => made,
            Err(why) => {
                tally.refused = (tally.refused.0 + 1, why);
                return Ok(());
            }
        };
        let judged = trial::guarded("the model", || {
            check::ends(&made, mesh).map_err(alone)?;
            model(&made, &options(seed), &mut |_| true)
        });
        tally.add(&judged.map_err(alone)??);
        tally.add(&[(Law::Ends, 1)].into());
        tally.judged += 1;
        Ok(())
    };
    let each = |spec: &Spec<N>| {
        let judged = judge(&spec.mesh().mesh, u64::from(spec.seed), &mut tally.borrow_mut());
        judged.map_err(|found| found.breach)
    };
    let Some(spec) = trial::first_failure(trial, Location::caller(), &specimens::<N>(), &each) else {
        trial::insist(name, &tally.borrow());
        return tally.into_inner();
    };
    let (specimen, seed) = (spec.mesh(), u64::from(spec.seed));
    let again = |mesh: &Mesh<N>| judge(mesh, seed, &mut Tally::default()).err();
    let found = again(&specimen.mesh).unwrap_or_else(|| {
        let what = format!("{name} broke a law on {}, and not the next time", specimen.name);
        without_model(&specimen.mesh, trial::breach(Law::Determinism, what))
    });
    let law = found.breach.law;
    let same = |mesh: &Mesh<N>| again(mesh).filter(|found| super::reduce::alike(found.breach.law, law));
    let (mesh, found) = super::meshes::smallest(&specimen.mesh, None, found, &same);
    let drawn = format!("{}, seed {seed} ({spec:?})", specimen.name);
    let test = text::model_test(name, law, &mesh, &options(seed));
    let finding = Finding {
        subject: name.to_owned(),
        sizes: format!("{} cells to {}", specimen.mesh.cell_count(), mesh.cell_count()),
        cells: mesh.cell_count(),
        obj: text::obj(&found.mesh),
        log: format!("subject: {name}\ncase: {drawn}\n\nmade of:\n{}\n{}", text::obj(&mesh), text::story(&found)),
        test,
        drawn,
        breach: found.breach,
        files: Vec::new(),
    };
    panic!("{}", finding.written(trial.folder.as_ref()))
}

/// A breach of which there is a mesh to show, and nothing made of it.
fn without_model<const N: usize>(mesh: &Mesh<N>, breach: Breach) -> Box<Counterexample<N>> {
    let found = Found { breach: breach.clone(), nodes: 0, cells: mesh.cell_count(), front: 0 };
    let (front, mesh) = (Front::base(0), mesh.clone());
    Box::new(Counterexample { breach, found, case: Case::Whole, front, mesh, patch: None })
}
