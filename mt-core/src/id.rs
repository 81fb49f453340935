//! Names of things: `u32` newtypes, so that a cell is never taken for a node.

use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(
            Copy, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash,
            Pod, Zeroable, Serialize, Deserialize,
        )]
        #[repr(transparent)]
        #[serde(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// No such thing: the end of a list, an absent neighbour.
            pub const NONE: Self = Self(u32::MAX);

            /// The id as an index into a slice.
            #[inline(always)]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The id of the thing at `index`; counts beyond `u32` are refused where models are built.
            #[inline(always)]
            pub const fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// Whether this is [`Self::NONE`].
            #[inline(always)]
            pub const fn is_none(self) -> bool {
                self.0 == u32::MAX
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                if self.is_none() { f.write_str("none") } else { self.0.fmt(f) }
            }
        }
    };
}

id! {
    /// A vertex of a model: input vertices first, then those that modifications made, in their order.
    VertexId
}
id! {
    /// A cell of a model. The same corners may be made twice, so a cell is named by its id and never by its corners.
    CellId
}
id! {
    /// A modification of a model, which is a node of its order. Ids are a rank: what a node needs has a larger id.
    NodeId
}
