//! Certificates of minimality: why each node of a front is refined, for a checker that knows the order and the wish only.

use super::{Breach, Law, ensure};
use crate::front::Front;
use crate::id::NodeId;
use crate::order::Order;
use serde::{Deserialize, Serialize};

/// Why a node is refined.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Witness {
    /// The criterion asks for it.
    Asked,
    /// A node of smaller id that is refined needs it; following these leads to one that is asked for.
    NeededBy(NodeId),
}

/// A front as a list, with the reason of each node.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Certificate {
    /// Nodes and reasons, ascending by node.
    pub entries: Vec<(NodeId, Witness)>,
}

impl Certificate {
    /// The nodes from `m` to one that is asked for, each needed by the next; empty where `m` is not refined.
    pub fn chain(&self, m: NodeId) -> Vec<NodeId> {
        let mut chain = Vec::new();
        let mut next = Some(m);
        while let Some(m) = next.take() {
            let Ok(at) = self.entries.binary_search_by_key(&m, |entry| entry.0) else { break };
            chain.push(m);
            // Ids fall along a chain, or it would not end.
            next = match self.entries[at].1 {
                Witness::NeededBy(other) if other < m => Some(other),
                _ => None,
            };
        }
        chain
    }
}

/// Whether a certificate proves its front the least closed set of all that `asked` tells: each entry is asked for, or
/// needed by an entry of smaller id; and nothing that is asked for or needed is missing. O(nodes + arcs of the front).
pub fn is_least(order: &Order, asked: &dyn Fn(NodeId) -> bool, certificate: &Certificate) -> Result<(), Breach> {
    let stray = certificate.entries.iter().map(|entry| entry.0).find(|m| m.0 >= order.len());
    ensure!(stray.is_none(), Law::Minimality, None, "node {stray:?} is refined, but the order has no such node");
    let front = Front::from_nodes(order.len(), certificate.entries.iter().map(|entry| entry.0));
    for &(m, witness) in &certificate.entries {
        let proved = match witness {
            Witness::Asked => asked(m),
            Witness::NeededBy(other) => other < m && front.is_refined(other) && order.needs(other).contains(&m),
        };
        ensure!(proved, Law::Minimality, m, "node {m} is refined, but {witness:?} is no reason");
    }
    let missing = (0..order.len()).map(NodeId).find(|&m| asked(m) && !front.is_refined(m));
    ensure!(missing.is_none(), Law::Minimality, missing, "node {missing:?} is asked for and not refined");
    let unmet = order.unmet(&front);
    ensure!(unmet.is_none(), Law::Closure, None, "(node, need) {unmet:?}: the need is not refined");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Rows;

    /// 3 is the root; 2 and 1 need it; 0 needs 1.
    fn order() -> Order {
        let mut rows = Rows::default();
        for row in [&[1][..], &[3], &[3], &[]] {
            rows.push(row.iter().map(|&n| NodeId(n)));
        }
        Order::from_needs(rows).unwrap()
    }

    #[test]
    fn a_reason_for_each_and_nothing_missing() {
        use Witness::{Asked, NeededBy};
        let asked = |m: NodeId| m.0 == 0;
        let judge = |entries: &[(u32, Witness)]| {
            let entries = entries.iter().map(|&(m, witness)| (NodeId(m), witness)).collect();
            is_least(&order(), &asked, &Certificate { entries })
        };
        let (one, two) = (NeededBy(NodeId(0)), NeededBy(NodeId(1)));
        let good = [(0, Asked), (1, one), (3, two)];
        assert_eq!(judge(&good), Ok(()));
        let chain = |m| {
            let entries = good.iter().map(|&(m, witness)| (NodeId(m), witness)).collect();
            Certificate { entries }.chain(NodeId(m)).into_iter().map(|m| m.0).collect::<Vec<_>>()
        };
        assert_eq!((chain(3), chain(2)), (vec![3, 1, 0], vec![]));
        // A node too many, a reason that is none, one that goes in a circle, one that nobody has.
        assert!(judge(&[(0, Asked), (1, one), (2, Asked), (3, two)]).is_err());
        assert!(judge(&[(0, Asked), (1, one), (2, one), (3, two)]).is_err());
        assert!(judge(&[(0, Asked), (1, NeededBy(NodeId(1))), (3, two)]).is_err());
        assert!(judge(&[(0, Asked), (1, one), (3, NeededBy(NodeId(2)))]).is_err());
        assert!(judge(&[(0, Asked), (1, one), (3, two), (9, Asked)]).is_err());
        assert!(judge(&[(0, Asked), (1, one), (3, NeededBy(NodeId(9)))]).is_err());
        // What is asked for is missing; what is needed is.
        assert_eq!(judge(&[]).unwrap_err().law, Law::Minimality);
        assert_eq!(judge(&[(0, Asked), (1, one)]).unwrap_err().law, Law::Closure);
    }
}
