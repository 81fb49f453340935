//! Every closed set of small models, and under a dynamic rule every valid one: brute force against the order, the steps,
//! the engine and the laws. The models are all that operators and schemes make of a family of small meshes.

mod cells;
mod every;
mod family;
mod lattice;
