//! Criteria and strategies that do not do what they say.

use crate::catalogue::{Caught, Fault, Verdict, fault, hunt};
use mt_core::check::{Mirror, Random};
use mt_core::model::MultiTessellation;
use mt_core::{Bound, Explicit, NodeId};
use multi_tessellation::verify::{self, Trial};
use selective::{Criterion, Limits, State, UniformError, Wish, adapt, wish_closure};

fn trial() -> Trial {
    let folder = Some(std::env::temp_dir().join("mt-planted"));
    Trial { cases: 24, folder, keep_seeds: false, ..Trial::default() }
}

/// A bound on the error, read in a way.
struct Read {
    error_max: f32,
    reading: Reading,
}

#[derive(Clone, Copy, PartialEq)]
enum Reading {
    Right,
    UpsideDown,
    NoNumber,
    ByTheFront,
}

impl Criterion<Bound> for Read {
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        match self.reading {
            Reading::Right => bound.error - self.error_max,
            Reading::UpsideDown => self.error_max - bound.error,
            Reading::NoNumber => (bound.error - self.error_max) * f32::NAN,
            // Memory that is not told of.
            Reading::ByTheFront if refined => 1.0,
            Reading::ByTheFront => bound.error - self.error_max,
        }
    }
}

fn criterion(reading: Reading) -> Verdict {
    let draw = |model: &Explicit<3>, random: &mut Random| {
        let m = NodeId::new(random.below(model.len() as usize));
        Read { error_max: model.bound(m).error, reading }
    };
    verify::criterion_in(&trial(), "read", draw)?;
    Ok(())
}

type Seat = State<3, Explicit<3>, Mirror<3>>;

fn strategy(change: impl Fn(&Explicit<3>, &Wish, &mut Seat)) -> Result<(), Caught> {
    verify::strategy_in(&trial(), "strategy", change)?;
    Ok(())
}

fn right(model: &Explicit<3>, wish: &Wish, state: &mut Seat) {
    adapt(model, wish, &Limits::NONE, state);
}

#[test]
fn criteria_and_strategies() {
    let read = |what, reading| -> Fault {
        fault(what, move |planted| criterion(if planted { reading } else { Reading::Right }))
    };
    type Change = fn(&Explicit<3>, &Wish, &mut Seat);
    let go =
        |what, wrong: Change| -> Fault { fault(what, move |planted| strategy(if planted { wrong } else { right })) };
    hunt(
        "criteria and strategies",
        &[
            read("a criterion asks below and not above", Reading::UpsideDown),
            read("a criterion gives no number", Reading::NoNumber),
            read("a criterion remembers and does not say so", Reading::ByTheFront),
            go("a strategy never coarsens", |model, wish, state| {
                let target = wish_closure(model, wish);
                let missing: Vec<NodeId> = target.difference(state.front()).collect();
                missing.iter().rev().for_each(|&m| state.force(model, m));
            }),
            go("a strategy does nothing", |_, _, _| {}),
            go("a strategy leaves out the last node", |model, wish, state| {
                right(model, wish, state);
                let finest = state.front().finest_first().next();
                finest.into_iter().for_each(|m| _ = state.try_coarsen(model, m));
            }),
            go("a strategy refines one node too many", |model, wish, state| {
                right(model, wish, state);
                let next = (0..model.len()).map(NodeId).find(|&m| !state.front().is_refined(m));
                next.into_iter().for_each(|m| state.force(model, m));
            }),
            go("a strategy clears the log", |model, wish, state| {
                right(model, wish, state);
                state.steps.clear();
            }),
            go("a strategy changes the mesh unseen by the sink", |model, wish, state| {
                let sink = state.sink.clone();
                right(model, wish, state);
                state.sink = sink;
            }),
            go("a strategy asks for half the error", |model, _, state| {
                right(model, &Wish::Uniform(UniformError { error_max: 0.0 }), state);
            }),
        ],
    );
}
