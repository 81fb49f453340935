//! A user's order: sound on generated sequences of merges, or a witness.

use super::hierarchy::{self, Look, Seen};
use super::reduce::At;
use super::specimen::{Spec, specimens};
use super::trial::{self, Finding, Tally, Trial};
use super::{Options, Summary, text};
use mt_core::analysis::{self, analyse};
use mt_core::check::{self, Breach, Law, Random};
use mt_core::hierarchy::{Dependency, HierarchyError};
use mt_core::{Front, Hierarchy, Replay, Rule, Sequence};
use operators::order::Stored;
use operators::{EdgeCollapse, FanMerge};
use std::cell::RefCell;
use std::panic::Location;
use std::sync::Arc;

/// Judges an order, given as what makes it for a sequence of merges: on full and half-edge collapses and fans of generated
/// meshes, it is sound (what is closed in it is closed in the order of `[KimLee2001]`), and every law holds that it claims.
/// To be called in a test.
///
/// Where it cannot take a sequence, it says [`HierarchyError::Unfit`], and the case counts as refused. A dynamic rule is
/// judged by the laws that do not speak of an order.
///
/// # Panics
/// With a [`Finding`] where it is not so.
#[track_caller]
pub fn order<D: Dependency + Send>(name: &str, make: impl Fn(&Arc<Replay>) -> Result<D, HierarchyError>) -> Tally {
    // Panics here, so that the message names the caller's line.
    match order_in(&Trial::default(), name, make) {
        Ok(tally) => tally,
        Err(finding) => panic!("{finding}"),
    }
}

/// [`order`], as a trial says, with the finding as a value.
///
/// # Panics
/// Where it takes none of the sequences drawn.
#[track_caller]
pub fn order_in<D: Dependency + Send>(
    trial: &Trial,
    name: &str,
    make: impl Fn(&Arc<Replay>) -> Result<D, HierarchyError>,
) -> Result<Tally, Box<Finding>> {
    let tally = RefCell::new(Tally::default());
    let mut find = |replay: &Arc<Replay>, look: Look| judged(&make, replay, look);
    let options =
        |case: &(Spec<3>, u8)| Options { fronts: trial.fronts, seed: u64::from(case.0.seed), topology: trial.topology };
    let shared = RefCell::new(&mut find);
    let judge = |case: &(Spec<3>, u8)| {
        let look = Look { options: options(case), first: None, last: None, watch: &mut |_| true };
        let seen = trial::guarded("the order", || (shared.borrow_mut())(&sequence_of(case), look))?;
        let mut tally = tally.borrow_mut();
        match seen {
            Ok(Seen::Held(checks)) => {
                tally.add(&checks);
                (tally.judged, tally.merging) = (tally.judged + 1, tally.merging + 1);
                Ok(())
            }
            Ok(Seen::Broken(at)) => Err(at.breach),
            Ok(Seen::Simple(_)) => Ok(()),
            Err(HierarchyError::Unfit { why, .. }) => {
                tally.refused = (tally.refused.0 + 1, why);
                Ok(())
            }
            Err(error) => Err(trial::breach(Law::Order, error.to_string())),
        }
    };
    let drawn = (specimens::<3>(), 0u8..3);
    match trial::first_failure(trial, Location::caller(), &drawn, &judge) {
        None => {
            trial::insist(name, &tally.borrow());
            Ok(tally.into_inner())
        }
        Some(case) => {
            let mut find = |replay: &Arc<Replay>, look: Look| judged(&make, replay, look);
            let kind = ["full collapses", "half-edge collapses", "fans"][usize::from(case.1.min(2))];
            let drawn = format!("{kind} of {}, seed {} ({:?})", case.0.mesh().name, case.0.seed, case.0);
            let again = look_at(&sequence_of(&case), name, drawn.clone(), &options(&case), &mut find);
            let other = || bare(name, drawn, trial::breach(Law::Determinism, "a law was broken, but not again".into()));
            let finding = again.map_or_else(|finding| *finding, |_| other());
            Err(Box::new(finding.written(trial.folder.as_ref())))
        }
    }
}

/// What a look at the hierarchy sees, after its soundness.
fn judged<D: Dependency + Send>(
    make: &impl Fn(&Arc<Replay>) -> Result<D, HierarchyError>,
    replay: &Arc<Replay>,
    look: Look,
) -> Result<Seen, HierarchyError> {
    let dependency = match make(replay) {
        Ok(dependency) => dependency,
        Err(error @ HierarchyError::Unfit { .. }) => return Err(error),
        Err(error) => return Ok(refusal(replay, &error, look)),
    };
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    if look.last.is_none()
        && let Some((breach, front)) = unsound(&model)
    {
        return Ok(Seen::Broken(Box::new(At { front, breach, case: Random::new(look.options.seed) })));
    }
    Ok(look.at(&model))
}

/// An order that finds itself unsound is a finding too: on the input, since there is no model to step through.
fn refusal(replay: &Replay, error: &HierarchyError, look: Look) -> Seen {
    let breach = trial::breach(Law::Order, error.to_string());
    let front = Front::reference(replay.len());
    match look.last {
        Some(_) => Seen::Simple(Box::new((front, breach, replay.reference()))),
        None => Seen::Broken(Box::new(At { front, breach, case: Random::new(look.options.seed) })),
    }
}

/// A node and what it must wait for but does not, and the least front that has the node. O(nodes × rows of the least sound
/// order), which are few.
fn unsound<D: Dependency + Send>(model: &Hierarchy<D>) -> Option<(Breach, Front)> {
    let sound = Stored::dual_piece(&model.replay).ok().filter(|_| D::RULE == Rule::Static)?;
    let order = check::order_of(model).ok()?;
    sound.needs_rows().entries().find_map(|(m, needed)| {
        let mut front = Front::from_nodes(order.len(), [m]);
        order.close(&mut front);
        let what = format!(
            "the order is unsound: node {m} must wait for node {needed}, which its needs do not lead to (until then the \
             two cut vertices of node {m} are one)"
        );
        (!front.is_refined(needed)).then_some((Breach { law: Law::Order, what, node: Some(m) }, front))
    })
}

/// A generated sequence of merges: full collapses, half-edge collapses or fans.
fn sequence_of((spec, kind): &(Spec<3>, u8)) -> Arc<Replay> {
    let mesh = spec.mesh().mesh;
    let mut sequence = Sequence::new(&mesh);
    let options = analysis::Options::default();
    let told = &mut sequence;
    let ended = match kind {
        0 => analyse(&mesh, &EdgeCollapse::FULL, &options, told, &mut |_| true),
        1 => analyse(&mesh, &EdgeCollapse::HALF, &options, told, &mut |_| true),
        _ => analyse(&mesh, &FanMerge::PARTIAL, &options, told, &mut |_| true),
    };
    ended.expect("generated meshes are manifolds");
    Arc::new(Replay::new(&mesh, &[], &sequence).expect("an analysis tells a sequence"))
}

/// [`order`] on one sequence. The finding is made small, and not written anywhere.
pub fn order_on<D: Dependency + Send>(
    replay: &Arc<Replay>,
    name: &str,
    make: impl Fn(&Arc<Replay>) -> Result<D, HierarchyError>,
    options: &Options,
) -> Result<Summary, Box<Finding>> {
    let drawn = format!("a sequence of {} merges, seed {}", replay.merge_count(), options.seed);
    look_at(replay, name, drawn, options, &mut |replay, look| judged(&make, replay, look))
}

/// Looks at an order on one sequence, and tells what is found.
fn look_at(
    replay: &Arc<Replay>,
    name: &str,
    drawn: String,
    options: &Options,
    find: &mut hierarchy::Finder,
) -> Result<Summary, Box<Finding>> {
    let verdict = trial::guarded("the order", || hierarchy::under(replay, options, &mut |_| true, find));
    let found = match verdict {
        Ok(Ok(Ok(summary))) => return Ok(summary),
        Ok(Ok(Err(found))) => found,
        Ok(Err(error)) => return Err(Box::new(bare(name, drawn, trial::breach(Law::Order, error.to_string())))),
        Err(breach) => return Err(Box::new(bare(name, drawn, breach))),
    };
    let judged = format!(
        "// The order as it was given, made for this replay.\n    \
         verify::order_on(&replay, {name:?}, |replay| make(replay), &OPTIONS).unwrap();"
    );
    let test = text::case_test(name, &found, &judged, options);
    Err(Box::new(Finding {
        subject: name.to_owned(),
        sizes: text::sizes(&found),
        cells: found.case.cell_count().unwrap_or(found.found.cells),
        obj: text::obj(&found.mesh),
        log: format!("subject: {name}\ncase: {drawn}\n\n{}", text::story(&found)),
        test,
        drawn,
        breach: found.breach,
        files: Vec::new(),
    }))
}

/// A finding of which there is nothing to show.
fn bare(name: &str, drawn: String, breach: Breach) -> Finding {
    let test = format!("// Nothing could be made small: run the test again, on {drawn}.\n");
    let log = format!("{breach}\n\nsubject: {name}\ncase: {drawn}\n");
    let sizes = "nothing".to_owned();
    Finding {
        subject: name.to_owned(),
        sizes,
        cells: 0,
        obj: String::new(),
        log,
        test,
        drawn,
        breach,
        files: Vec::new(),
    }
}
