//! Schemes by name, for commands and studies.

use super::{DualPieceFree, ImplicitIds, Stored, StoredIds};
use mt_core::hierarchy::{Dependency, HierarchyError};
use mt_core::{Hierarchy, Replay};
use std::sync::Arc;

/// A dependency scheme.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scheme {
    /// [`Stored::explicit`].
    Explicit,
    /// [`Stored::one_ring`].
    OneRing,
    /// [`Stored::cut_pair`].
    CutPair,
    /// [`Stored::four_face`].
    FourFace,
    /// [`Stored::dual_piece`].
    DualPiece,
    /// [`ImplicitIds`].
    ImplicitIds,
    /// [`StoredIds`].
    ImplicitIdsStored,
    /// [`DualPieceFree`].
    DualPieceFree,
}

/// Work on a hierarchy whose type is known only when a name has been read.
pub trait Visit {
    /// What comes of it.
    type Output;
    /// Does it. Whoever keeps the model keeps a copy: the replay is shared, and rows are short.
    fn visit<D: Dependency + Send + Clone + 'static>(self, model: &Hierarchy<D>) -> Self::Output;
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Scheme; 8] = [
        Scheme::Explicit,
        Scheme::OneRing,
        Scheme::CutPair,
        Scheme::FourFace,
        Scheme::DualPiece,
        Scheme::ImplicitIds,
        Scheme::ImplicitIdsStored,
        Scheme::DualPieceFree,
    ];

    /// The name by which commands know it.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::Explicit => "explicit",
            Scheme::OneRing => "one-ring",
            Scheme::CutPair => "cut-pair",
            Scheme::FourFace => "four-face",
            Scheme::DualPiece => "dual-piece",
            Scheme::ImplicitIds => "implicit-ids",
            Scheme::ImplicitIdsStored => "implicit-ids-stored",
            Scheme::DualPieceFree => "dual-piece-free",
        }
    }

    /// Whether it is a static order, with all the laws of one.
    pub fn is_static(self) -> bool {
        !matches!(self, Scheme::ImplicitIds | Scheme::ImplicitIdsStored | Scheme::DualPieceFree)
    }

    /// The rows of a static scheme; `None` for dynamic ones.
    pub fn stored(self, replay: &Replay) -> Result<Option<Stored>, HierarchyError> {
        Ok(match self {
            Scheme::Explicit => Some(Stored::explicit(replay)),
            Scheme::OneRing => Some(Stored::one_ring(replay)),
            Scheme::CutPair => Some(Stored::cut_pair(replay)?),
            Scheme::FourFace => Some(Stored::four_face(replay)?),
            Scheme::DualPiece => Some(Stored::dual_piece(replay)?),
            Scheme::ImplicitIds | Scheme::ImplicitIdsStored | Scheme::DualPieceFree => None,
        })
    }

    /// Derives the scheme for a replay, and does `work` on the hierarchy.
    pub fn visit<V: Visit>(self, replay: &Arc<Replay>, work: V) -> Result<V::Output, HierarchyError> {
        let shared = Arc::clone(replay);
        if let Some(dependency) = self.stored(replay)? {
            return Ok(work.visit(&Hierarchy { replay: shared, dependency }));
        }
        Ok(match self {
            Scheme::ImplicitIdsStored => work.visit(&Hierarchy { dependency: StoredIds::new(replay)?, replay: shared }),
            Scheme::DualPieceFree => work.visit(&Hierarchy { dependency: DualPieceFree::new(replay)?, replay: shared }),
            _ => work.visit(&Hierarchy { dependency: ImplicitIds, replay: shared }),
        })
    }
}

impl std::fmt::Display for Scheme {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no scheme.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no dependency scheme `{0}`; there are {names}", names = Scheme::ALL.map(Scheme::name).join(", "))]
pub struct UnknownScheme(pub String);

impl std::str::FromStr for Scheme {
    type Err = UnknownScheme;
    fn from_str(name: &str) -> Result<Self, UnknownScheme> {
        Self::ALL.into_iter().find(|scheme| scheme.name() == name).ok_or_else(|| UnknownScheme(name.to_owned()))
    }
}
