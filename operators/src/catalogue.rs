//! The operators by name, for commands and studies: one line each.

use crate::edge_collapse::EdgeCollapse;
use crate::fan_merge::FanMerge;
use crate::metric::{AnyMetric, Metric, Quadrics};
use crate::vertex_pair::VertexPair;
use mt_core::analysis::{
    AnalysisError, Ended, Listener, Operator, Options, Progress, RegionListener, Regions, analyse, analyse_by_regions,
};
use mt_core::{Mesh, VertexId};
use std::fmt::Debug;
use std::str::FromStr;
use std::sync::Arc;

/// An operator chosen at run time, with its metric.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyOperator {
    /// Full or half-edge collapse.
    EdgeCollapse(EdgeCollapse<AnyMetric>),
    /// Collapse of any two vertices that are near.
    VertexPair(VertexPair<AnyMetric>),
    /// Fan-merge, which brings its own metric.
    FanMerge(FanMerge),
    /// One that is not from here: see [`Self::yours`].
    Yours(Yours),
}

impl AnyOperator {
    /// The names of the operators; after those that take one, a slash and a metric may follow.
    pub const NAMES: [&str; 4] = ["edge-collapse", "half-edge-collapse", "vertex-pair", "fan-merge"];

    /// Anybody's operator, for a study beside ours. No command knows it by name.
    ///
    /// What a study keeps of it is found again by its `Debug` text, so that has to tell all its options, and something new
    /// when the code changes (or nothing is kept). It joins vertices that share an edge; one that joins others needs links,
    /// and a [`mt_core::Replay`] made by hand.
    pub fn yours(operator: impl Operator<3> + Debug + Send + Sync + 'static) -> Self {
        Self::Yours(Yours(Arc::new(operator)))
    }

    /// Its name, with the metric where that is not the quadric.
    pub fn name(&self) -> String {
        match self {
            Self::EdgeCollapse(collapse) => with_metric(Operator::name(collapse), &collapse.metric),
            Self::VertexPair(pair) => with_metric(Operator::name(pair), &pair.metric),
            Self::FanMerge(fan) => Operator::name(fan).to_owned(),
            Self::Yours(Yours(operator)) => operator.title().to_owned(),
        }
    }

    /// Whether its modifications may change the topology of a mesh: sew sheets together, close holes.
    pub fn coarsens_topology(&self) -> bool {
        matches!(self, Self::VertexPair(_))
    }

    /// The edges by which this operator knows neighbours besides triangles, for [`mt_core::Replay::new`]. Collapses, fans
    /// and operators from elsewhere have none. Vertex pairs have their virtual edges, and the real ones too: an edge stays
    /// one when its triangles die.
    pub fn links(&self, mesh: &Mesh<3>) -> Vec<[VertexId; 2]> {
        let Self::VertexPair(pair) = self else { return Vec::new() };
        let mut links = pair.pairs(mesh);
        let sides = mesh.cells.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        links.extend(sides.map(|[a, b]| [a.min(b), a.max(b)]));
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Whether it can coarsen a mesh region by region: see [`Self::analyse_by_regions`].
    pub fn works_by_regions(&self) -> bool {
        matches!(self, Self::EdgeCollapse(_))
    }

    /// Coarsens `mesh` region by region, and tells `listener`: see [`mt_core::analysis::analyse_by_regions`]. An operator
    /// that cannot [do that](Self::works_by_regions) coarsens it as a whole.
    pub fn analyse_by_regions(
        &self,
        mesh: &Mesh<3>,
        options: &Options,
        regions: &Regions,
        listener: &mut impl RegionListener<3>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Ended, AnalysisError> {
        let Self::EdgeCollapse(collapse) = self else { return self.analyse(mesh, options, listener, watch) };
        // By type, since each metric keeps something else of a vertex.
        macro_rules! by {
            ($metric:expr) => {
                analyse_by_regions(mesh, &collapse.clone().with($metric), options, regions, listener, watch)
            };
        }
        match &collapse.metric {
            AnyMetric::Quadric(metric) => by!(*metric),
            AnyMetric::QuadricAttributes(metric) => by!(metric.clone()),
            AnyMetric::LindstromTurk(metric) => by!(*metric),
            AnyMetric::EdgeLength(metric) => by!(*metric),
        }
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
            Self::Yours(Yours(operator)) => operator.coarsen(mesh, options, listener, watch),
        }
    }
}

/// An operator of which only the trait is known. Shared, so that a copy costs nothing.
#[derive(Clone)]
pub struct Yours(Arc<dyn Coarsens>);

/// As the operator's own: a study tells operators apart by this text.
impl Debug for Yours {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq for Yours {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// [`Operator`] without its types, which differ from one operator to the next.
trait Coarsens: Debug + Send + Sync {
    fn title(&self) -> &'static str;

    fn coarsen(
        &self,
        mesh: &Mesh<3>,
        options: &Options,
        listener: &mut dyn Listener<3>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Ended, AnalysisError>;
}

impl<O: Operator<3> + Debug + Send + Sync> Coarsens for O {
    fn title(&self) -> &'static str {
        self.name()
    }

    fn coarsen(
        &self,
        mesh: &Mesh<3>,
        options: &Options,
        listener: &mut dyn Listener<3>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Ended, AnalysisError> {
        analyse(mesh, self, options, listener, watch)
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
    #[error("there is no operator `{0}`; there are {names}, each of the collapses also with /METRIC", names = AnyOperator::NAMES.join(", "))]
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

    #[test]
    fn an_operator_from_elsewhere_does_what_it_does_by_type() {
        let mesh = mt_core::generate::torus(12, 8);
        let sequence = |operator: &AnyOperator| {
            let mut sequence = mt_core::Sequence::new(&mesh);
            operator.analyse(&mesh, &Options::default(), &mut sequence, &mut |_| true).unwrap();
            sequence
        };
        let yours = AnyOperator::yours(FanMerge::PARTIAL);
        let ours = AnyOperator::FanMerge(FanMerge::PARTIAL);
        assert_eq!(sequence(&yours), sequence(&ours));
        assert_eq!(yours.name(), ours.name());
        assert_eq!(format!("{yours:?}"), format!("Yours({:?})", FanMerge::PARTIAL));
        assert!(yours == yours.clone() && yours != ours);
    }
}
