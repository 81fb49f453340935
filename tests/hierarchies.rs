//! Vertex hierarchies under every dependency scheme: all laws, and how the schemes relate.

use mt_core::generate::{self, Named};
use mt_core::hierarchy::Dependency;
use mt_core::model::MultiTessellation;
use mt_core::{Front, Hierarchy, Mesh, NodeId, Order, Replay, check};
use mt_tests::both_of;
use multi_tessellation::verify;
use operators::EdgeCollapse;
use operators::order::{DualPieceFree, ImplicitIds, Scheme, Stored, StoredIds};
use proptest::prelude::*;
use selective::State;
use std::sync::Arc;

fn laws_hold<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D, seed: u64, fronts: u32) {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let verdict = verify::hierarchy(&model, &verify::Options { fronts, seed }, &mut |_| true);
    if let Err(found) = verdict {
        panic!("{name}: {} at a front of {} nodes (found at {})", found.breach, found.front.len(), found.found_at);
    }
}

fn all_laws(name: &str, replay: &Arc<Replay>, seed: u64, fronts: u32) {
    for scheme in Scheme::ALL {
        if let Some(stored) = scheme.stored(replay).expect("a manifold") {
            laws_hold(&format!("{name} {scheme}"), replay, stored, seed, fronts);
        }
    }
    laws_hold(&format!("{name} implicit-ids"), replay, ImplicitIds, seed, fronts);
    laws_hold(&format!("{name} dual-piece-free"), replay, DualPieceFree::new(replay).unwrap(), seed, fronts);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn every_law_holds_under_every_scheme(mesh_seed in any::<u64>(), half in any::<bool>(), seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let (_, replay) = both_of(&mesh, if half { &EdgeCollapse::HALF } else { &EdgeCollapse::FULL });
        all_laws(&name, &replay, seed, 8);
    }
}
