//! Why each node of a front is refined: the certificate of minimality, for `check::is_least` to judge.

use mt_core::check::{Breach, Certificate, Law, Witness};
use mt_core::{Front, NodeId, Order};

/// The reason of each node of a front: the wish, or a node that needs it. Fails with the first node that has none, by
/// which the front is not the least closure of the wish. O(nodes + arcs of the front).
pub fn certify(order: &Order, asked: &dyn Fn(NodeId) -> bool, front: &Front) -> Result<Certificate, Breach> {
    let mut certificate = Certificate::default();
    for m in front.finest_first() {
        let needed_by = || order.dependents(m).iter().copied().find(|&d| front.is_refined(d));
        let witness = if asked(m) { Some(Witness::Asked) } else { needed_by().map(Witness::NeededBy) };
        let Some(witness) = witness else {
            let what = format!("node {m} is refined, but nobody asks for it and nothing that is refined needs it");
            return Err(Breach { law: Law::Minimality, what, node: Some(m) });
        };
        certificate.entries.push((m, witness));
    }
    Ok(certificate)
}
