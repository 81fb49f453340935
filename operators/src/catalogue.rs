//! The operators by name, for commands and studies: one line each.

use crate::edge_collapse::EdgeCollapse;
use crate::fan_merge::FanMerge;
use crate::metric::{AnyMetric, Metric, Quadrics};
use crate::vertex_pair::VertexPair;
use mt_core::analysis::{AnalysisError, Ended, Listener, Operator, Options, Progress, analyse};
use mt_core::{Mesh, VertexId};
use std::str::FromStr;

/// An operator chosen at run time, with its metric.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyOperator {
    /// Full or half-edge collapse.
    EdgeCollapse(EdgeCollapse<AnyMetric>),
    /// Collapse of any two vertices that are near.
    VertexPair(VertexPair<AnyMetric>),
    /// Fan-merge, which brings its own metric.
    FanMerge(FanMerge),
}

impl AnyOperator {
    /// The names of the operators; after those that take one, a slash and a metric may follow.
    pub const NAMES: [&str; 4] = ["edge-collapse", "half-edge-collapse", "vertex-pair", "fan-merge"];

    /// Its name, with the metric where that is not the quadric.
    pub fn name(&self) -> String {
        match self {
            Self::EdgeCollapse(collapse) => with_metric(Operator::name(collapse), &collapse.metric),
            Self::VertexPair(pair) => with_metric(Operator::name(pair), &pair.metric),
            Self::FanMerge(fan) => Operator::name(fan).to_owned(),
        }
    }

    /// Whether its modifications may change the topology of a mesh: sew sheets together, close holes.
    pub fn coarsens_topology(&self) -> bool {
        matches!(self, Self::VertexPair(_))
    }

    /// The edges by which this operator knows neighbours besides triangles, for [`mt_core::Replay::new`]. Collapses and fans
    /// have none. Vertex pairs have their virtual edges, and the real ones too: an edge stays one when its triangles die.
    pub fn links(&self, mesh: &Mesh<3>) -> Vec<[VertexId; 2]> {
        let Self::VertexPair(pair) = self else { return Vec::new() };
        let mut links = pair.pairs(mesh);
        let sides = mesh.cells.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        links.extend(sides.map(|[a, b]| [a.min(b), a.max(b)]));
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Coarsens `mesh` and tells `listener`: see [`mt_core::analysis::analyse`].
    pub fn analyse(
        &self,
        mesh: &Mesh<3>,
        options: &Options,
        listener: &mut impl Listener<3>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Ended, AnalysisError> {
        match self {
            // By type, where the type is known: asking by name costs a branch at each price.
            Self::EdgeCollapse(collapse) if collapse.metric == AnyMetric::Quadric(Quadrics) => {
                analyse(mesh, &collapse.clone().with(Quadrics), options, listener, watch)
            }
            Self::EdgeCollapse(collapse) => analyse(mesh, collapse, options, listener, watch),
            Self::VertexPair(pair) if pair.metric == AnyMetric::Quadric(Quadrics) => {
                analyse(mesh, &pair.clone().with(Quadrics), options, listener, watch)
            }
            Self::VertexPair(pair) => analyse(mesh, pair, options, listener, watch),
            Self::FanMerge(fan) => analyse(mesh, fan, options, listener, watch),
        }
    }
}

fn with_metric(operator: &str, metric: &AnyMetric) -> String {
    if *metric == AnyMetric::Quadric(Quadrics) { operator.to_owned() } else { format!("{operator}/{}", metric.name()) }
}

impl std::fmt::Display for AnyOperator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

/// A name that is no operator.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnknownOperator {
    /// No operator has the name.
    #[error("there is no operator {0}; there are {names}, each of the collapses also with /METRIC", names = AnyOperator::NAMES.join(", "))]
    Operator(String),
    /// No metric has the name.
    #[error(transparent)]
    Metric(#[from] crate::metric::UnknownMetric),
    /// The operator brings its own.
    #[error("{0} brings its own metric")]
    OwnMetric(String),
}

impl FromStr for AnyOperator {
    type Err = UnknownOperator;

    fn from_str(name: &str) -> Result<Self, UnknownOperator> {
        let (operator, metric) =
            name.split_once('/').map_or((name, None), |(operator, metric)| (operator, Some(metric)));
        let chosen = metric.map_or(Ok(AnyMetric::Quadric(Quadrics)), AnyMetric::from_str)?;
        match operator {
            "edge-collapse" => Ok(Self::EdgeCollapse(EdgeCollapse::FULL.with(chosen))),
            "half-edge-collapse" => Ok(Self::EdgeCollapse(EdgeCollapse::HALF.with(chosen))),
            "vertex-pair" => Ok(Self::VertexPair(VertexPair::default().with(chosen))),
            "fan-merge" if metric.is_some() => Err(UnknownOperator::OwnMetric(operator.to_owned())),
            "fan-merge" => Ok(Self::FanMerge(FanMerge::PARTIAL)),
            _ => Err(UnknownOperator::Operator(operator.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_operators_and_back() {
        for name in AnyOperator::NAMES {
            assert_eq!(name.parse::<AnyOperator>().unwrap().name(), name);
        }
        for metric in AnyMetric::ALL.iter().skip(1) {
            let name = format!("half-edge-collapse/{}", metric.name());
            assert_eq!(name.parse::<AnyOperator>().unwrap().name(), name);
        }
        for wrong in ["", "collapse", "edge-collapse/", "edge-collapse/colour", "fan-merge/quadric"] {
            assert!(wrong.parse::<AnyOperator>().is_err(), "{wrong}");
        }
    }
}
