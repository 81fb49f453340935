//! A user's operator: its models on generated meshes, and what it does there, under every law.

use super::specimen::{Generated, Spec, specimens};
use super::trial::{self, Finding, Tally, Trial};
use super::watched::Watched;
use super::{Options, Topology, determinism, explicit, hierarchy, text};
use super::{meshes, reduce};
use mt_core::analysis::{self, AnalysisError, Operator, analyse, simplify};
use mt_core::check::{Breach, Law};
use mt_core::hierarchy::HierarchyError;
use mt_core::{Explicit, HistoryError, Mesh, Replay, Sequence};
use operators::order::Scheme;
use std::panic::Location;
use std::sync::Arc;

/// Judges an operator: on generated meshes its plans, its models under every law, and where it merges vertices their
/// hierarchies under every scheme. To be called in a test.
///
/// # Panics
/// With a [`Finding`] where a law is broken: the smallest mesh and history, and where they were written.
#[track_caller]
pub fn operator<const N: usize, O: Operator<N>>(operator: &O) -> Tally
where
    Mesh<N>: Generated<N>,
{
    // Panics here, so that the message names the caller's line.
    match operator_in(&Trial::default(), operator) {
        Ok(tally) => tally,
        Err(finding) => panic!("{finding}"),
    }
}

/// [`operator`], as a trial says, with the finding as a value.
///
/// # Panics
/// Where the operator takes none of the meshes drawn.
#[track_caller]
pub fn operator_in<const N: usize, O: Operator<N>>(trial: &Trial, operator: &O) -> Result<Tally, Box<Finding>>
where
    Mesh<N>: Generated<N>,
{
    let tally = std::cell::RefCell::new(Tally::default());
    let options =
        |spec: &Spec<N>| Options { fronts: trial.fronts, seed: u64::from(spec.seed), topology: trial.topology };
    let judge = |spec: &Spec<N>| {
        let mesh = spec.mesh().mesh;
        examine(operator, &mesh, &options(spec), &mut tally.borrow_mut()).map_err(Trouble::into_breach)
    };
    match trial::first_failure(trial, Location::caller(), &specimens::<N>(), &judge) {
        None => {
            trial::insist(operator.name(), &tally.borrow());
            Ok(tally.into_inner())
        }
        Some(spec) => {
            let specimen = spec.mesh();
            let drawn = format!("{}, seed {} ({spec:?})", specimen.name, spec.seed);
            let trouble = examine(operator, &specimen.mesh, &options(&spec), &mut Tally::default()).err();
            let trouble = trouble.unwrap_or_else(|| {
                let what = format!("{} broke a law on {drawn}, and not the next time", operator.name());
                Trouble::Alone(trial::breach(Law::Determinism, what))
            });
            let finding = finding(operator, &specimen.mesh, &options(&spec), trouble, drawn);
            Err(Box::new(finding.written(trial.folder.as_ref())))
        }
    }
}

/// Judges an operator on one mesh. The finding is made small, and not written anywhere.
///
/// # Panics
/// Where the operator does not take the mesh.
pub fn operator_on<const N: usize, O: Operator<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    options: &Options,
) -> Result<Tally, Box<Finding>>
where
    Mesh<N>: Generated<N>,
{
    let mut tally = Tally::default();
    let drawn = format!("a mesh of {} cells, seed {}", mesh.cell_count(), options.seed);
    examine(operator, mesh, options, &mut tally)
        .map_err(|trouble| Box::new(finding(operator, mesh, options, trouble, drawn)))?;
    trial::insist(operator.name(), &tally);
    Ok(tally)
}

/// What is wrong with an operator on a mesh, and what it was seen on.
#[derive(Debug)]
pub enum Trouble<const N: usize> {
    /// Nothing but the mesh.
    Alone(Breach),
    /// The model of cells.
    Cells(Breach, Box<Explicit<N>>),
    /// The hierarchy of its merges, under a scheme.
    Merges(Breach, Arc<Replay>, Scheme),
}

impl<const N: usize> Trouble<N> {
    fn into_breach(self) -> Breach {
        match self {
            Trouble::Alone(breach) | Trouble::Cells(breach, _) | Trouble::Merges(breach, _, _) => breach,
        }
    }

    fn breach(&self) -> &Breach {
        match self {
            Trouble::Alone(breach) | Trouble::Cells(breach, _) | Trouble::Merges(breach, _, _) => breach,
        }
    }
}

/// An operator that goes on for ever is stopped after so many plans asked of it for each cell.
const PLANS_PER_CELL: u64 = 1024;

/// All laws of what an operator does on a mesh, nothing made small.
fn examine<const N: usize, O: Operator<N>>(
    operator: &O,
    mesh: &Mesh<N>,
    options: &Options,
    tally: &mut Tally,
) -> Result<(), Trouble<N>>
where
    Mesh<N>: Generated<N>,
{
    let Some(model) = analysed(operator, mesh, tally).map_err(Trouble::Alone)? else { return Ok(()) };
    let again = trial::guarded("the operator, the second time,", || determinism(mesh, operator));
    again.and_then(|same| same).map_err(Trouble::Alone)?;
    tally.add(&[(Law::Determinism, 1), (Law::Conduct, 1)].into());
    let checks = explicit::find(&model, options, None, &mut |_| true);
    tally.add(&checks.map_err(|at| Trouble::Cells(at.breach, Box::new(model)))?);
    mesh.judge_merges(operator, options, tally)?;
    tally.judged += 1;
    Ok(())
}

/// The model that an operator makes of a mesh; none where it does not take it.
fn analysed<const N: usize, O: Operator<N>>(
    operator: &O,
    mesh: &Mesh<N>,
    tally: &mut Tally,
) -> Result<Option<Explicit<N>>, Breach> {
    let most = PLANS_PER_CELL * (16 + mesh.cell_count() as u64);
    let options = analysis::Options { unchecked: true, ..Default::default() };
    let watched = Watched::new(operator);
    let mut watch = |_: analysis::Progress| watched.plans() <= most;
    let analysis = trial::guarded("the operator", || simplify(mesh, &watched, &options, &mut watch))?;
    if let Some(price) = watched.odd_price() {
        return Err(trial::breach(Law::Conduct, format!("a price is {price}; prices are not below 0")));
    }
    if watched.plans() > most {
        return Err(trial::breach(Law::Conduct, format!("no end after {most} plans")));
    }
    match analysis {
        Ok(analysis) => Ok(Some(analysis.model)),
        Err(AnalysisError::Unfit(why)) => {
            tally.refused = (tally.refused.0 + 1, why.to_string());
            Ok(None)
        }
        Err(error) => Err(trial::breach(Law::Conduct, error.to_string())),
    }
}

/// The hierarchies of an operator whose plans merge vertices, under every scheme that takes them.
pub(super) fn judge_merges<O: Operator<3>>(
    mesh: &Mesh<3>,
    operator: &O,
    options: &Options,
    tally: &mut Tally,
) -> Result<(), Trouble<3>> {
    let mut sequence = Sequence::new(mesh);
    let unchecked = analysis::Options { unchecked: true, ..Default::default() };
    match analyse(mesh, operator, &unchecked, &mut sequence, &mut |_| true) {
        Ok(_) => {}
        Err(AnalysisError::History(HistoryError::NotMerge)) => return Ok(()),
        Err(error) => return Err(Trouble::Alone(trial::breach(Law::Conduct, error.to_string()))),
    }
    let replay = Replay::new(mesh, &[], &sequence);
    let replay = replay.map_err(|error| Trouble::Alone(trial::breach(Law::Conduct, error.to_string())))?;
    let replay = Arc::new(replay);
    for scheme in schemes(options.topology) {
        let look = hierarchy::Look { options: *options, first: None, last: None, watch: &mut |_| true };
        match scheme.visit(&replay, look) {
            Ok(hierarchy::Seen::Held(checks)) => tally.add(&checks),
            Ok(hierarchy::Seen::Broken(at)) => return Err(Trouble::Merges(at.breach, replay, scheme)),
            // A scheme that does not take the sequence says so; the others are judged.
            Ok(hierarchy::Seen::Simple(_)) | Err(HierarchyError::Unfit { .. }) => {}
            Err(error) => return Err(Trouble::Alone(trial::breach(Law::Order, error.to_string()))),
        }
    }
    tally.merging += 1;
    Ok(())
}

/// The schemes that promise to be sound: stored ids are not, and where sheets are sewn together only these two are taken
/// without links.
fn schemes(topology: Topology) -> Vec<Scheme> {
    match topology {
        Topology::Kept => Scheme::ALL.into_iter().filter(|&scheme| scheme != Scheme::ImplicitIdsStored).collect(),
        Topology::Coarsened => vec![Scheme::Explicit, Scheme::OneRing],
    }
}

/// The same trouble on the smallest mesh, told.
fn finding<const N: usize, O: Operator<N>>(
    operator: &O,
    mesh: &Mesh<N>,
    options: &Options,
    trouble: Trouble<N>,
    drawn: String,
) -> Finding
where
    Mesh<N>: Generated<N>,
{
    let law = trouble.breach().law;
    let judge = |mesh: &Mesh<N>| {
        let options = Options { fronts: options.fronts.min(24), ..*options };
        let found = examine(operator, mesh, &options, &mut Tally::default()).err()?;
        reduce::alike(found.breach().law, law).then_some(found)
    };
    let hint = told(&trouble, options).and_then(|told| told.input);
    let (smaller, trouble) = meshes::smallest(mesh, hint, trouble, &judge);
    let told = told(&trouble, options);
    let mut sizes = format!("{} cells to {}", mesh.cell_count(), smaller.cell_count());
    let mut log = format!(
        "{}

subject: {}
case: {drawn}
",
        trouble.breach(),
        operator.name()
    );
    log += &format!(
        "
the smallest mesh found:
{}",
        text::obj(&smaller)
    );
    let mut obj = text::obj(&smaller);
    if let Some(told) = told {
        sizes += &format!("; its history: {}", told.sizes);
        log += &format!(
            "
what the operator does there, made small in turn:
{}",
            told.story
        );
        obj = told.obj;
    }
    let name = std::any::type_name::<O>();
    let test = text::operator_test(name, operator.name(), trouble.breach().law, &smaller, options);
    let (subject, cells) = (operator.name().to_owned(), smaller.cell_count());
    Finding { subject, sizes, cells, obj, log, test, drawn, breach: trouble.into_breach(), files: Vec::new() }
}

/// The history behind a trouble, made small.
struct Told<const N: usize> {
    input: Option<Mesh<N>>,
    obj: String,
    sizes: String,
    story: String,
}

fn told<const N: usize>(trouble: &Trouble<N>, options: &Options) -> Option<Told<N>> {
    match trouble {
        Trouble::Alone(_) => None,
        Trouble::Cells(_, model) => {
            let found = explicit::explicit(model, options, &mut |_| true).err()?;
            let (obj, sizes, story) = (text::obj(&found.mesh), text::sizes(&found), text::story(&found));
            Some(Told { input: found.case.input(), obj, sizes, story })
        }
        Trouble::Merges(_, replay, scheme) => {
            let found = hierarchy::scheme(replay, *scheme, options, &mut |_| true).ok()?.err()?;
            let (obj, sizes) = (text::obj(&found.mesh), text::sizes(&found));
            let story = format!("under {scheme}: {}", text::story(&found));
            // Merges are of triangles, which N then is.
            let input = found.case.input().map(|mesh| Mesh {
                cells: mesh.cells.iter().filter_map(|cell| cell.as_slice().try_into().ok()).collect(),
                positions: mesh.positions,
            });
            Some(Told { input, obj, sizes, story })
        }
    }
}
