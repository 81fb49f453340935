//! Seeded meshes made from nothing: what tests, benches and the built-in study run on.
//!
//! The same arguments give the same mesh, bit for bit, on one platform; nothing
//! is read from a file. Triangles turn counter-clockwise seen from outside, or
//! from above for patches. Sizes below the smallest that makes sense are taken
//! as that smallest size, so no generator fails.
//!
//! | kind | generators |
//! |---|---|
//! | closed, genus 0 | [`tetrahedron`], [`octahedron`], [`icosahedron`], [`sphere`], [`bumpy_sphere`], [`sharp_box`] |
//! | closed, genus 0 to 3 | [`torus`], [`genus_surface`] |
//! | with boundary | [`triangle`], [`grid`], [`bumpy_grid`], [`slivers`], [`strip`], [`annulus`], [`cylinder`], [`terrain`] |
//! | not orientable | [`moebius`] |
//! | not manifold | [`hourglass`], [`fan3`] |
//! | tetrahedra | [`tetrahedral_box`] |
//! | of others | [`components`], [`random_mesh`] |

mod boxes;
mod implicit;
mod noise;
mod patches;
mod random;
mod round;
mod terrain;
mod tiny;

#[cfg(test)]
mod tests;

pub use boxes::{sharp_box, tetrahedral_box};
pub use implicit::genus_surface;
pub use patches::{annulus, bumpy_grid, cylinder, grid, moebius, slivers, strip};
pub use random::{Named, components, random_mesh};
pub use round::{bumpy_sphere, sphere, torus};
pub use terrain::terrain;
pub use tiny::{fan3, hourglass, icosahedron, octahedron, tetrahedron, triangle};
