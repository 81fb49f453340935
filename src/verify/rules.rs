//! A user's criterion, and a user's strategy, on generated models.

use super::minimality;
use super::reduce::{self, At, Divisible};
use super::specimen::{Spec, specimens};
use super::trial::{self, Finding, Tally, Trial};
use super::{Options, counterexample, shrink, text};
use mt_core::analysis::simplify;
use mt_core::check::{self, Breach, Law, Mirror, Random};
use mt_core::model::{MultiTessellation, View, cells_of, mesh_of, take};
use mt_core::{Bound, Explicit, Front};
use operators::EdgeCollapse;
use selective::{Criterion, State, Wish, approach};
use std::cell::{Cell, RefCell};
use std::panic::Location;

/// Judges a criterion, given as what draws one for a model: on generated models it is monotone along the discovery forest
/// (what asks below asks above), never not a number, and extract and adapt end in the least closure of what it asks for.
/// One with a memory is held to its head start instead: what is refined asks at least as much as what is not. To be called
/// in a test.
///
/// # Panics
/// With a [`Finding`] where it is not so; also where it never asked for some nodes of a model and not for others, since
/// nothing was seen then.
#[track_caller]
pub fn criterion<C: Criterion<Bound>>(name: &str, draw: impl Fn(&Explicit<3>, &mut Random) -> C) -> Tally {
    // Panics here, so that the message names the caller's line.
    match criterion_in(&Trial::default(), name, draw) {
        Ok(tally) => tally,
        Err(finding) => panic!("{finding}"),
    }
}

/// [`criterion`], as a trial says, with the finding as a value.
///
/// # Panics
/// Where all it was seen to ask for is everything or nothing.
#[track_caller]
pub fn criterion_in<C: Criterion<Bound>>(
    trial: &Trial,
    name: &str,
    draw: impl Fn(&Explicit<3>, &mut Random) -> C,
) -> Result<Tally, Box<Finding>> {
    let decided = Cell::new(false);
    let judge = |model: &Explicit<3>, view: &View<mt_core::explicit::Alive>, random: &mut Random| {
        if model.is_empty() {
            return Ok(0);
        }
        let criterion = draw(model, random);
        let asked = monotone(model, &criterion)?;
        decided.set(decided.get() || (1..model.len()).contains(&asked));
        if C::MEMORY {
            return Ok(1);
        }
        minimality::ends_in_least(model, model.order(), &criterion, name, view, random)?;
        Ok(1)
    };
    let tally = on_models(trial, Location::caller(), name, &judge)?;
    assert!(decided.get(), "{name} asked for everything or for nothing on every model, so nothing was seen");
    Ok(tally)
}

/// What asks below asks above, nothing is not a number, and a memory only holds on. Gives how many nodes are asked for.
fn monotone<C: Criterion<Bound>>(model: &Explicit<3>, criterion: &C) -> Result<u32, Breach> {
    let mut asked = 0;
    for m in (0..model.len()).map(mt_core::NodeId) {
        let excess = [false, true].map(|refined| criterion.excess(&model.bound(m), refined));
        let fault = |what: String| Err(Breach { law: Law::Minimality, what, node: Some(m) });
        if excess.iter().any(|e| e.is_nan()) {
            return fault(format!("the excess of node {m} is not a number: {:?}", model.bound(m)));
        }
        if C::MEMORY && excess[1] < excess[0] {
            return fault(format!("node {m} asks less when it is refined: {} after {}", excess[1], excess[0]));
        }
        if !C::MEMORY && excess[0] != excess[1] {
            return fault(format!("node {m} asks otherwise when it is refined, but no memory is claimed"));
        }
        let otherwise = [false, true].into_iter().zip(excess);
        let mut otherwise = otherwise.filter(|(refined, e)| criterion.asks(&model.bound(m), *refined) != (*e > 0.0));
        if let Some((_, excess)) = otherwise.next() {
            return fault(format!("node {m} has an excess of {excess}, and asks otherwise"));
        }
        asked += u32::from(excess[0] > 0.0);
        let above = model.parent(m).filter(|&p| excess[0] > 0.0 && !criterion.asks(&model.bound(p), false));
        if let Some(p) = above {
            let (child, parent) = (model.bound(m), model.bound(p));
            return fault(format!(
                "not monotone: it asks for node {m} and not for node {p}, whose bound contains that: {child:?} within {parent:?}"
            ));
        }
    }
    Ok(asked)
}

/// Judges a strategy: a function that changes the front of a state for a wish. On generated models, from random fronts, it
/// ends in the least closure of the wish, by legal steps that it logs, and its sink hears what happens to the mesh. To be
/// called in a test.
///
/// # Panics
/// With a [`Finding`] where it is not so.
#[track_caller]
pub fn strategy(name: &str, adapt: impl Fn(&Explicit<3>, &Wish, &mut State<3, Explicit<3>, Mirror<3>>)) -> Tally {
    // Panics here, so that the message names the caller's line.
    match strategy_in(&Trial::default(), name, adapt) {
        Ok(tally) => tally,
        Err(finding) => panic!("{finding}"),
    }
}

/// [`strategy`], as a trial says, with the finding as a value.
#[track_caller]
pub fn strategy_in(
    trial: &Trial,
    name: &str,
    adapt: impl Fn(&Explicit<3>, &Wish, &mut State<3, Explicit<3>, Mirror<3>>),
) -> Result<Tally, Box<Finding>> {
    let judge = |model: &Explicit<3>, view: &View<mt_core::explicit::Alive>, random: &mut Random| {
        if model.is_empty() {
            return Ok(0);
        }
        let wish = minimality::draw(model, random);
        let mut state = State::new(model, Mirror::default());
        approach(model, &view.front, &mut state);
        state.steps.clear();
        let start = state.view.clone();
        adapt(model, &wish, &mut state);
        legal(model, start, &state)?;
        let least = minimality::least(model, model.order(), &wish);
        if *state.front() != least {
            let (extra, missing) = (state.front().difference(&least).next(), least.difference(state.front()).next());
            let what = format!(
                "{}: ends in {} nodes, the least closure has {}; extra: {extra:?}, missing: {missing:?}",
                wish.name(),
                state.front().len(),
                least.len()
            );
            return Err(trial::breach(Law::Minimality, what));
        }
        Ok(1)
    };
    on_models(trial, Location::caller(), name, &judge)
}

/// The log leads from `start` to where the state is, step by legal step, and the sink was told.
fn legal(
    model: &Explicit<3>,
    start: View<mt_core::explicit::Alive>,
    state: &State<3, Explicit<3>, Mirror<3>>,
) -> Result<(), Breach> {
    let mut view = start;
    for &step in &state.steps {
        let m = step.node;
        let (needs, dependents) = (model.order().needs(m), model.order().dependents(m));
        let free = match step.refined {
            true => needs.iter().all(|&n| view.front.is_refined(n)),
            false => !dependents.iter().any(|&d| view.front.is_refined(d)),
        };
        if view.front.is_refined(m) == step.refined || !free {
            let what = format!("{step:?} is logged where it is not legal");
            return Err(Breach { law: Law::Closure, what, node: Some(m) });
        }
        take(model, step, &mut view, &mut ());
    }
    if view != state.view {
        return Err(trial::breach(Law::FrontDeterminesMesh, "the log does not lead to the front that is there".into()));
    }
    let told = state.sink.cells().map_err(|fault| trial::breach(Law::FrontDeterminesMesh, fault.to_string()))?;
    let mut cells = cells_of(model, &state.view.mesh);
    cells.sort_unstable();
    let same = told == cells;
    let what = || "the sink was told another mesh than that of the front".to_owned();
    if same { Ok(()) } else { Err(trial::breach(Law::FrontDeterminesMesh, what())) }
}

/// Judges at a front of a model; gives how often something was judged.
type JudgeAt<'a> = dyn Fn(&Explicit<3>, &View<mt_core::explicit::Alive>, &mut Random) -> Result<u64, Breach> + 'a;

/// Runs a judge at random fronts of the models of generated meshes.
fn on_models(
    trial: &Trial,
    caller: &'static Location<'static>,
    name: &str,
    judge: &JudgeAt,
) -> Result<Tally, Box<Finding>> {
    let tally = RefCell::new(Tally::default());
    let fronts = trial.fronts;
    let each = |spec: &Spec<3>| {
        let checked = first_breach(&model_of(spec), judge, None, fronts, u64::from(spec.seed));
        let checked = checked.map_err(|at| at.breach)?;
        let mut tally = tally.borrow_mut();
        tally.add(&[(Law::Minimality, checked)].into());
        tally.judged += u32::from(checked > 0);
        Ok(())
    };
    let Some(spec) = trial::first_failure(trial, caller, &specimens::<3>(), &each) else {
        trial::insist(name, &tally.borrow());
        return Ok(tally.into_inner());
    };
    let (model, seed) = (model_of(&spec), u64::from(spec.seed));
    let drawn = format!("edge collapses of {}, seed {seed} ({spec:?})", spec.mesh().name);
    let at = first_breach(&model, judge, None, fronts, seed).err().unwrap_or_else(|| At {
        front: Front::base(model.len()),
        breach: trial::breach(Law::Determinism, format!("{name} broke a law on {drawn}, and not the next time")),
        case: Random::new(seed),
    });
    let found = made_small(&model, at, judge, seed);
    let options = Options { fronts, seed, topology: trial.topology };
    let test = text::rule_test(name, &found, &options);
    let finding = Finding {
        subject: name.to_owned(),
        sizes: text::sizes(&found),
        cells: found.case.cell_count().unwrap_or(found.found.cells),
        obj: text::obj(&found.mesh),
        log: format!("subject: {name}\ncase: {drawn}\n\n{}", text::story(&found)),
        test,
        drawn,
        breach: found.breach,
        files: Vec::new(),
    };
    Err(Box::new(finding.written(trial.folder.as_ref())))
}

fn model_of(spec: &Spec<3>) -> Explicit<3> {
    let mesh = spec.mesh().mesh;
    let analysis = simplify(&mesh, &EdgeCollapse::FULL, &Default::default(), &mut |_| true);
    analysis.expect("generated meshes are manifolds").model
}

/// The first front at which something is wrong: at `first` before any other.
fn first_breach(
    model: &Explicit<3>,
    judge: &JudgeAt,
    first: Option<(&Front, &Random)>,
    fronts: u32,
    seed: u64,
) -> Result<u64, At> {
    let mut random = Random::new(seed);
    let mut checked = 0;
    for i in 0..fronts.max(1) {
        let drawn = (check::random_front(model.order(), &mut random), Random::new(random.bits()));
        let (front, case) = first.filter(|_| i == 0).map_or(drawn, |(front, case)| (front.clone(), case.clone()));
        checked += at_front(model, judge, &front, &case).map_err(|breach| At { front, breach, case })?;
    }
    Ok(checked)
}

fn at_front(model: &Explicit<3>, judge: &JudgeAt, front: &Front, case: &Random) -> Result<u64, Breach> {
    let mut state = State::new(model, ());
    approach(model, front, &mut state);
    trial::guarded("it", || judge(model, &state.view, &mut case.clone())).and_then(|judged| judged)
}

fn made_small(model: &Explicit<3>, at: At, judge: &JudgeAt, seed: u64) -> counterexample::Counterexample<3> {
    let found = counterexample::Found {
        breach: at.breach.clone(),
        nodes: model.len(),
        cells: Divisible::cell_count(model),
        front: at.front.len(),
    };
    let look = |part: &Explicit<3>, carried: &Front| {
        first_breach(part, judge, Some((carried, &at.case)), reduce::fronts_to_try(part.len()), seed).err()
    };
    let small = reduce::smallest(model, &at, &look, shrink::deadline());
    let case = small.as_ref().map(|(part, _)| counterexample::Case::Cells(Box::new(part.clone())));
    let (part, at) = small.unwrap_or_else(|| (model.clone(), at));
    let broken = |simpler: &Front| at_front(&part, judge, simpler, &at.case).err();
    let (front, breach) = shrink::simplest(part.order(), &at.front, at.breach, broken);
    let mut state = State::new(&part, ());
    approach(&part, &front, &mut state);
    let (mesh, patch) = (mesh_of(&part, &state.view.mesh), breach.node.map(|m| (m, part.patch(m))));
    let case = case.unwrap_or(counterexample::Case::Whole);
    counterexample::Counterexample { breach, found, case, front, mesh, patch }
}
