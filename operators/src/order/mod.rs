//! Orders: what a split must wait for. Every scheme of the literature, on one and the same sequence of merges.
//!
//! | scheme | a node waits for | after |
//! |---|---|---|
//! | `explicit` | those that make the cells it replaces | `[DeFlorianiTutorial2002]` |
//! | `one-ring` | those that make its neighbours at analysis | `[XiaVarshney1996]` |
//! | `cut-pair` | those that make the two vertices opposite its edge | `[Hoppe1996]` |
//! | `four-face` | those that make the four triangles beside its two | `[Hoppe1997]` |
//! | `dual-piece` | the lowest common ancestor of its fundamental cut vertices | `[KimLee2001]` |
//! | `implicit-ids` | neighbours with larger ids; nothing is stored | `[ElSanaVarshney1999]` |
//! | `implicit-ids-stored` | neighbours out of the range of ids that it had; unsound | `[ElSanaVarshney1999]`, as `[KimLee2001]` tells it |
//! | `dual-piece-free` | a common cut vertex; collapses wait for extra neighbours to go | `[KimLee2001]`, section 4.4 |
//!
//! All of them wait for the parent in the forest as well. The first five are static orders: rows of needs
//! ([`Stored`]), derived by one sweep over the replay. For a static order to be sound on a manifold it is enough that it
//! contains `dual-piece`: the two cut vertices of a node are one exactly while the lowest common ancestor of its
//! fundamental cut vertices is coarse, and that ancestor was always made later than the node. [`Stored::of_user`] takes
//! anybody's order that does.

mod derive;
mod free;
mod implicit;
mod lowest;
mod scheme;
mod stored;

pub use free::DualPieceFree;
pub use implicit::{ImplicitIds, StoredIds};
pub use scheme::{Scheme, UnknownScheme, Visit};
pub use stored::Stored;
