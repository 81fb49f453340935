//! What may be done to the views of a model. Every operation makes sense in every state: numbers are taken modulo.

use proptest::prelude::*;

/// An operation, on one of two views unless it says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Op {
    /// Whether the second view.
    pub second: bool,
    /// What to do.
    pub act: Act,
}

/// What may be done to a view.
#[allow(missing_docs, reason = "what the numbers are is said of each act")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Refine a node and all that it needs.
    Force { node: u16 },
    /// Refine the first node, from this one on, that may be; alone.
    Refine { node: u16 },
    /// Coarsen a refined node, if that is legal.
    Coarsen { node: u16 },
    /// Try to coarsen one of so many refined nodes, finest first.
    Thin { every: u8 },
    /// Choose what to ask: a kind of criterion, how strict, and a hair to either side of a tie.
    Wish { kind: u8, level: u8, hair: i8 },
    /// Hesitate to coarsen, or stop to.
    Memory { margin: Option<u8> },
    /// Judge runs of nodes on a path, or each for itself.
    Path { path: Option<u8> },
    /// Look from elsewhere.
    Camera { turn: u8, distance: u8 },
    /// Allow so many 255ths of the cells, or all.
    Budget { cells: Option<u8> },
    /// Stop the clock at once, or never.
    Time { none: bool },
    /// Bring the view to what is asked.
    Adapt,
    /// The same without time, until it is complete.
    AdaptByAndBy,
    /// Make the view anew.
    Extract { priority: bool },
    /// Go to a random closed front (static orders).
    Approach { seed: u8 },
    /// Undo the steps back to an earlier mark.
    RollBack { to: u16 },
    /// Take again what was undone.
    Forward,
    /// Clear the log.
    Forget,
    /// Write the model, read it, and go on with what was read: both views as they are, or made anew at their fronts.
    Reload { anew: bool },
    /// Go over to another model of the mesh, both views from its base mesh.
    Other,
}

fn act() -> impl Strategy<Value = Act> {
    let changes = prop_oneof![
        3 => any::<u16>().prop_map(|node| Act::Force { node }),
        2 => any::<u16>().prop_map(|node| Act::Refine { node }),
        2 => any::<u16>().prop_map(|node| Act::Coarsen { node }),
        2 => (1u8..5).prop_map(|every| Act::Thin { every }),
        8 => Just(Act::Adapt),
        1 => Just(Act::AdaptByAndBy),
        2 => any::<bool>().prop_map(|priority| Act::Extract { priority }),
        1 => any::<u8>().prop_map(|seed| Act::Approach { seed }),
    ];
    let choices = prop_oneof![
        5 => (0u8..13, any::<u8>(), -1i8..2).prop_map(|(kind, level, hair)| Act::Wish { kind, level, hair }),
        1 => prop::option::of(0u8..4).prop_map(|margin| Act::Memory { margin }),
        1 => prop::option::of(0u8..4).prop_map(|path| Act::Path { path }),
        2 => (0u8..32, 0u8..6).prop_map(|(turn, distance)| Act::Camera { turn, distance }),
        2 => prop::option::of(any::<u8>()).prop_map(|cells| Act::Budget { cells }),
        1 => any::<bool>().prop_map(|none| Act::Time { none }),
    ];
    let travels = prop_oneof![
        3 => any::<u16>().prop_map(|to| Act::RollBack { to }),
        2 => Just(Act::Forward),
        1 => Just(Act::Forget),
        1 => any::<bool>().prop_map(|anew| Act::Reload { anew }),
        1 => Just(Act::Other),
    ];
    prop_oneof![6 => changes, 4 => choices, 2 => travels]
}

/// A sequence of operations that shrinks: to fewer, and to simpler ones.
pub fn ops(most: usize) -> impl Strategy<Value = Vec<Op>> {
    prop::collection::vec((any::<bool>(), act()).prop_map(|(second, act)| Op { second, act }), 1..=most)
}
