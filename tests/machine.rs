//! The state machine on random models and random operations. With PROPTEST_CASES larger it runs as long as one likes.

use mt_tests::machine::{
    Engine, OPERATORS, Op, on_cells, on_ids_as_one_ring, on_merges, on_tetrahedra, ops, small_mesh,
};
use operators::order::Scheme;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

/// Triangles of the largest mesh.
const CELLS_MAX: usize = 220;

/// So many cases, or as many as PROPTEST_CASES says.
fn cases(usual: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|told| told.parse().ok()).unwrap_or(usual);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/machine.proptest-regressions");
    let failure_persistence = Some(Box::new(FileFailurePersistence::Direct(path)) as Box<_>);
    ProptestConfig { cases, max_shrink_iters: 20_000, failure_persistence, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn explicit_models_do_as_they_must(seed in any::<u64>(), operator in 0..OPERATORS.len(), ops in ops(40)) {
        let named = small_mesh(seed, CELLS_MAX);
        let played = on_cells(&named.mesh, OPERATORS[operator], Engine::default(), &ops);
        prop_assert_eq!(played, Ok(()), "{} {}", named.name, OPERATORS[operator]);
    }

    #[test]
    fn tetrahedra_do_as_they_must(seed in 0u64..1000, ops in ops(40)) {
        prop_assert_eq!(on_tetrahedra(seed, Engine::default(), &ops), Ok(()));
    }

    #[test]
    fn hierarchies_under_static_orders_do_as_they_must(
        seed in any::<u64>(), operator in 0..OPERATORS.len(), scheme in 0usize..5, ops in ops(40),
    ) {
        on_a_hierarchy(seed, OPERATORS[operator], Scheme::ALL[scheme], &ops)?;
    }

    #[test]
    fn hierarchies_under_dynamic_rules_do_as_they_must(
        seed in any::<u64>(), operator in 0..OPERATORS.len(), scheme in 5usize..8, ops in ops(40),
    ) {
        on_a_hierarchy(seed, OPERATORS[operator], Scheme::ALL[scheme], &ops)?;
    }

    #[test]
    fn ids_on_full_collapses_do_what_the_order_of_rings_does(seed in any::<u64>(), ops in ops(40)) {
        let named = small_mesh(seed, CELLS_MAX);
        prop_assert_eq!(on_ids_as_one_ring(&named.mesh, Engine::default(), &ops), Ok(()), "{}", named.name);
    }
}

fn on_a_hierarchy(seed: u64, operator: &str, scheme: Scheme, ops: &[Op]) -> Result<(), TestCaseError> {
    let named = small_mesh(seed, CELLS_MAX);
    let is_pair = operator.starts_with("vertex-pair");
    let refused = match scheme {
        Scheme::CutPair | Scheme::FourFace | Scheme::DualPiece | Scheme::DualPieceFree => is_pair,
        Scheme::ImplicitIdsStored => operator == "fan-merge",
        _ => false,
    };
    let played = on_merges(&named.mesh, operator, scheme, Engine::default(), ops);
    // A sequence without a fan of two is one of collapses.
    let lenient = refused && operator == "fan-merge" && played == Some(Ok(()));
    let wanted = if refused { None } else { Some(Ok(())) };
    prop_assert!(lenient || played == wanted, "{} {} {}: {:?}", named.name, operator, scheme, played);
    Ok(())
}
