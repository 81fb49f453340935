//! Operators that leave something out.

use crate::catalogue::{Fault, fault, hunt};
use mt_core::generate;
use mt_tests::Careless;
use multi_tessellation::verify;

#[test]
fn operators() {
    let mesh = generate::torus(16, 8);
    let planted = |what, careless: Careless| -> Fault {
        let mesh = &mesh;
        fault(what, move |planted| {
            let operator = if planted { careless } else { Careless::Not };
            verify::operator_on(mesh, &operator, &verify::Options::default())?;
            Ok(())
        })
    };
    hunt(
        "operators",
        &[
            planted("a collapse does not test the link condition", Careless::Link),
            planted("a plan forgets a cell that it should make", Careless::Cell),
            planted("a plan turns a cell over", Careless::Turned),
            planted("a plan kills a cell beside its star", Careless::Beside),
            planted("a plan makes a cell at a vertex that is gone", Careless::Gone),
            planted("a plan panics", Careless::Panic),
            planted("coarsening never ends", Careless::Ever),
            planted("prices depend on what was asked before", Careless::Moody),
            planted("a price is no number", Careless::Unpriced),
        ],
    );
}
