//! A metric chosen by name while the program runs.

use super::{
    AttributePair, AttributeState, Boundary, Displacements, EdgeLength, LindstromTurk, Memoryless, Merge, Metric,
    Offer, Place, Quadric, QuadricAttributes, Quadrics, Surroundings,
};
use mt_core::VertexId;
use mt_core::analysis::{Draft, Unfit};
use std::str::FromStr;

/// Writes the enum of all metrics and passes every question on to the one that it is.
macro_rules! any_metric {
    ($($(#[$doc:meta])* $variant:ident($metric:ty, $state:ty, $pair:ty) = $default:expr,)+) => {
        /// Any of the metrics. Each question costs a branch, so where the metric is known beforehand, name its type.
        #[derive(Clone, Debug, PartialEq)]
        pub enum AnyMetric { $($(#[$doc])* $variant($metric),)+ }

        /// The state of any metric.
        #[derive(Clone, Debug)]
        pub enum AnyState { $($(#[$doc])* $variant($state),)+ }

        /// What any metric knows of two vertices.
        #[derive(Clone, Debug)]
        pub enum AnyPair { $($(#[$doc])* $variant($pair),)+ }

        impl AnyMetric {
            /// Each of them with its default settings, in the order in which they are listed.
            pub const ALL: &[Self] = &[$(Self::$variant($default),)+];
        }

        impl Metric for AnyMetric {
            type State = AnyState;
            type Pair = AnyPair;

            fn name(&self) -> &'static str {
                match self { $(Self::$variant(metric) => metric.name(),)+ }
            }

            fn sees_neighbours(&self) -> bool {
                match self { $(Self::$variant(metric) => metric.sees_neighbours(),)+ }
            }

            fn prepare(&self, draft: &Draft<3>, boundary: &Boundary<'_>) -> Result<AnyState, Unfit> {
                match self { $(Self::$variant(metric) => metric.prepare(draft, boundary).map(AnyState::$variant),)+ }
            }

            fn pair(&self, draft: &Draft<3>, state: &AnyState, ends: [VertexId; 2]) -> AnyPair {
                match (self, state) {
                    $((Self::$variant(metric), AnyState::$variant(state)) => {
                        AnyPair::$variant(metric.pair(draft, state, ends))
                    })+
                    _ => unreachable!("{MIXED}"),
                }
            }

            fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &AnyPair, place: Place) -> Offer {
                match (self, pair) {
                    $((Self::$variant(metric), AnyPair::$variant(pair)) => metric.offer(draft, ends, pair, place),)+
                    _ => unreachable!("{MIXED}"),
                }
            }

            fn merged(&self, draft: &Draft<3>, state: &mut AnyState, merge: &Merge) {
                match (self, state) {
                    $((Self::$variant(metric), AnyState::$variant(state)) => metric.merged(draft, state, merge),)+
                    _ => unreachable!("{MIXED}"),
                }
            }
        }
    };
}

const MIXED: &str = "a metric is asked with the state of another";

any_metric! {
    /// [`Quadrics`].
    Quadric(Quadrics, Vec<Quadric>, Quadric) = Quadrics,
    /// [`QuadricAttributes`] of three attributes.
    QuadricAttributes(QuadricAttributes<3>, AttributeState<3>, AttributePair<3>) = QuadricAttributes::NORMALS,
    /// [`LindstromTurk`].
    LindstromTurk(LindstromTurk, Memoryless, Surroundings) = LindstromTurk::DEFAULT,
    /// [`EdgeLength`].
    EdgeLength(EdgeLength, Displacements, [f32; 2]) = EdgeLength,
}

impl Default for AnyMetric {
    fn default() -> Self {
        Self::Quadric(Quadrics)
    }
}

/// A name that no metric has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownMetric(pub String);

impl std::fmt::Display for UnknownMetric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<&str> = AnyMetric::ALL.iter().map(Metric::name).collect();
        write!(f, "there is no metric {:?}; there are {}", self.0, names.join(", "))
    }
}

impl std::error::Error for UnknownMetric {}

impl FromStr for AnyMetric {
    type Err = UnknownMetric;

    /// The metric of this name, with its default settings.
    fn from_str(name: &str) -> Result<Self, UnknownMetric> {
        let found = Self::ALL.iter().find(|metric| metric.name() == name);
        found.cloned().ok_or_else(|| UnknownMetric(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_metrics_and_back() {
        for metric in AnyMetric::ALL {
            assert_eq!(metric.name().parse().as_ref(), Ok(metric));
        }
        let unknown = "manhattan".parse::<AnyMetric>().unwrap_err().to_string();
        assert!(unknown.contains("\"manhattan\"") && unknown.contains("lindstrom-turk, edge-length"), "{unknown}");
        assert_eq!(AnyMetric::default().name(), "quadric");
    }
}
