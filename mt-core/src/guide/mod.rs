//! The laws, one drawing each; how to write an operator; how to read a counterexample.
//!
//! Every drawing here is made of a real model by `cargo run --example laws`, and what is wrong in it is a planted fault; a
//! test sees that they are current. Blue is fine, ochre is coarse, red is wrong.
//!
//! A model is a base mesh and modifications of it, each of which waits for those that it needs. Whatever set of them is
//! refined, as long as it is closed under needs, there is one mesh: fine here and coarse there, as one asks for.
//!
#![doc = include_str!("model.svg")]
//!
//! That this is so whoever wrote the operator, the order or the engine is what the laws say. Each is a function in
//! [`crate::check`], is named by [`Law`](crate::check::Law), and has been seen to fail: `docs/faults.md` lists what is
//! planted and which law sees it first, and tests plant faults for single checkers besides. `multi_tessellation::verify`
//! judges all that belong to what somebody wrote by one call.
//!
//! | law | of what | checked by |
//! |---|---|---|
//! | [conformity](#conformity) | every modification | [`check::conformity`](crate::check::conformity), [`check::plan`](crate::check::plan) |
//! | [cells](#cells) | explicit models | [`check::cells`](crate::check::cells), [`check::set_algebra`](crate::check::set_algebra) |
//! | [crack-freeness](#crack-freeness) | every mesh | [`check::crack_free`](crate::check::crack_free) |
//! | [inverse](#inverse) | every step | [`check::inverse`](crate::check::inverse) |
//! | [the front determines the mesh](#the-front-determines-the-mesh) | every front | [`check::front_determines_mesh`](crate::check::front_determines_mesh) |
//! | [ends](#ends) | every model | [`check::ends`](crate::check::ends) |
//! | [determinism](#determinism) | operators | `verify::determinism` |
//! | [conduct](#conduct) | code that somebody wrote | `verify::operator`, `verify::order`, … |
//! | [order](#order) | static orders | [`check::order`](crate::check::order), [`check::order_from_cells`](crate::check::order_from_cells) |
//! | [closure](#closure) | static orders | [`check::closure`](crate::check::closure) |
//! | [minimality](#minimality) | static orders, any criterion | `verify::minimality`, [`check::is_least`](crate::check::is_least) |
//! | [saturation](#saturation) | bounds | [`check::saturation`](crate::check::saturation), [`check::patch_bounds`](crate::check::patch_bounds) |
//! | [quotient](#quotient) | hierarchies of vertices | [`check::quotient`](crate::check::quotient()) |
//! | [partition](#partition) | hierarchies of vertices | [`check::dual_pieces`](crate::check::dual_pieces) |
//!
//! A dynamic rule (an order that looks at the mesh before it answers) is not held to order, closure and minimality, which
//! it cannot have; everything else it is held to.
//!
//! # The laws
//!
//! ## Conformity
//!
//! A modification replaces one patch of cells by another **with the same boundary**, so that the rest of the mesh need not
//! know. Facets of the patch's boundary that no cell outside has may change: that is where the input's own boundary moves,
//! when an ear of a sheet goes.
//!
#![doc = include_str!("conformity.svg")]
//!
//! ## Cells
//!
//! Each cell is **made once and killed at most once**. So the cells of a front are those of the base, and the fine cells of
//! its nodes, less their coarse cells: set algebra by id, which is a slow and certain oracle for every mesh.
//!
#![doc = include_str!("cells.svg")]
//!
//! ## Crack-freeness
//!
//! **Every mesh that a front has is a mesh**: where the input is a manifold no facet has more than two cells, and none has
//! one unless it is on the boundary as the front has it. Flat and solid inputs are embedded besides: no cell is turned over, and their content
//! sums to the domain. Manifolds are judged by the umbrella of cells around each vertex, not by counts.
//!
#![doc = include_str!("crack-freeness.svg")]
//!
//! ## Inverse
//!
//! **Coarsening undoes refining exactly**, and the reverse: the same cells with their corners in the same turn, positions to
//! the bit. The inverse of a legal step is legal at once.
//!
#![doc = include_str!("inverse.svg")]
//!
//! ## The front determines the mesh
//!
//! **However a front is reached, its mesh is the same.** Without this nothing could be cached, two cameras could not share a
//! model, and a bug report could not be repeated. A sink that was told every kill and make knows the same mesh.
//!
#![doc = include_str!("front-determines-mesh.svg")]
//!
//! ## Ends
//!
//! The empty front is the base mesh, **the full front the input, bit for bit**.
//!
#![doc = include_str!("ends.svg")]
//!
//! ## Determinism
//!
//! **Same input, same bytes.** Prices that depend on addresses, hash maps or the weather are found by analysing twice.
//!
#![doc = include_str!("determinism.svg")]
//!
//! ## Conduct
//!
//! **What somebody wrote comes to an end and says what is so**: it does not panic, names only what is there, tells prices
//! that are numbers, and wins as many cells as it says.
//!
#![doc = include_str!("conduct.svg")]
//!
//! ## Order
//!
//! **Ids are a rank**: what a node needs has a larger id. Prerequisites are empty exactly when what is needed is refined,
//! and nothing is in the way of coarsening exactly when no refined node needs this one.
//!
#![doc = include_str!("order.svg")]
//!
//! ## Closure
//!
//! **A front has what its nodes need**, and so do the meet and the join of two fronts: closed sets are a lattice.
//!
#![doc = include_str!("closure.svg")]
//!
//! ## Minimality
//!
//! Whatever the way, from the top or from where the view was before, the engine ends in **the least closed front that has
//! what was asked for**. A [`Certificate`](crate::check::Certificate) says of each node why it is there: asked for, or
//! needed by another; a few lines check it by order and wish alone.
//!
#![doc = include_str!("minimality.svg")]
//!
//! ## Saturation
//!
//! **The bound of a node contains the bounds of all that is discovered under it**: spheres within spheres (rounded
//! outwards), errors that grow towards the roots, cones within cones. Then a criterion that is monotone in the bound never
//! says no to a node and yes to one below, for any camera.
//!
#![doc = include_str!("saturation.svg")]
//!
//! ## Quotient
//!
//! A hierarchy merges vertices, so its mesh can be told in one sentence: **each vertex of the input becomes the one that
//! stands for it, and triangles whose corners are still three are left**.
//!
#![doc = include_str!("quotient.svg")]
//!
//! ## Partition
//!
//! Seen from the dual, as in `[KimLee2001]`: the pieces of the active vertices **cover the input, do not overlap, and two of
//! them touch along one portion of boundary or not at all**.
//!
#![doc = include_str!("partition.svg")]
//!
//! # How to write an operator
//!
//! An [`Operator`](crate::analysis::Operator) names *sites* where it may act, gives each a *price*, and fills a
//! [`Plan`](crate::Plan): which cells go, which are made of which vertices, which vertices retire. It changes nothing
//! itself. The driver takes the cheapest site (to within an eighth), has the plan checked in debug builds, applies it and
//! tells the recorder; then it asks which sites have a new price.
//!
//! Here is one, whole: an end of the shortest edge goes into the other.
//!
//! ```
//! use mt_core::analysis::{Draft, Operator, Options, Unfit, simplify};
//! use mt_core::{Plan, Refusal, VertexId, check, generate};
//!
//! struct ShortestEdge;
//!
//! impl Operator<3> for ShortestEdge {
//!     /// An edge, and which end of it goes: the first.
//!     type Site = (VertexId, VertexId);
//!     type Aux = ();
//!
//!     fn name(&self) -> &'static str {
//!         "shortest-edge"
//!     }
//!     fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Self::Site>) -> Result<(), Unfit> {
//!         // Say what you do not take; what you take, you are judged on.
//!         if !draft.complex.boundary().is_empty() {
//!             return Err(Unfit::Other("closed meshes only".into()));
//!         }
//!         sites.extend(draft.complex.cells().flat_map(|(_, cell)| (0..3).map(|i| (cell[i], cell[(i + 1) % 3]))));
//!         Ok(())
//!     }
//!     fn price(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site) -> Option<f64> {
//!         // An edge that is not there any more has no price: the site is stale.
//!         let length = draft.positions[u.index()].distance(draft.positions[v.index()]);
//!         (draft.complex.edge_degree(u, v) > 0).then_some(f64::from(length))
//!     }
//!     fn plan(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
//!         let (mut around_u, mut around_v) = (Vec::new(), Vec::new());
//!         draft.complex.neighbours(u, &mut around_u);
//!         draft.complex.neighbours(v, &mut around_v);
//!         let shared = around_u.iter().filter(|w| around_v.contains(w)).count();
//!         // The link condition: more than two shared neighbours, and sheets would be sewn together.
//!         if shared != 2 || draft.complex.cell_count() <= 4 {
//!             return Err(Refusal::Link);
//!         }
//!         for (slot, i) in draft.complex.star(u) {
//!             let mut cell = *draft.complex.cell(slot);
//!             plan.kills.push(slot);
//!             if !cell.contains(&v) {
//!                 cell[i] = v;
//!                 plan.makes.push(cell);
//!             }
//!         }
//!         plan.retired.push(u);
//!         plan.kept = Some(v);
//!         Ok(())
//!     }
//!     fn applied(&self, draft: &Draft<3>, (): &mut (), plan: &Plan<3>, again: &mut Vec<Self::Site>) {
//!         // Edges at the vertex that stays are new, or others than before.
//!         let v = plan.kept.expect("every plan keeps one");
//!         let mut around = Vec::new();
//!         draft.complex.neighbours(v, &mut around);
//!         again.extend(around.into_iter().flat_map(|u| [(u, v), (v, u)]));
//!     }
//! }
//!
//! let mesh = generate::bumpy_sphere(3, 0.1, 7);
//! let model = simplify(&mesh, &ShortestEdge, &Options::default(), &mut |_| true)?.model;
//! assert_eq!(model.base_cells().len(), 4);
//! check::ends(&model, &mesh)?;
//! check::conformity(&model)?;
//! check::saturation(&model)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Those were three checkers by hand. In a test of yours, one call draws meshes and fronts, holds the operator to every law,
//! makes what fails small, and remembers its seed:
//!
//! ```text
//! #[test]
//! fn shortest_edge_keeps_the_laws() {
//!     multi_tessellation::verify::operator::<3, _>(&ShortestEdge);
//! }
//! ```
//!
//! `PROPTEST_CASES=5000 cargo test` is the same test for a long night. Where an operator may change the topology (pairs
//! of vertices do), say so with `Topology::Coarsened` in a `Trial`, and `verify::operator_in` judges by the weaker laws. The
//! same room has `verify::order` for rows of needs and dynamic rules, `verify::models` for a model of your own,
//! `verify::criterion` and `verify::strategy`. The example `triangle_collapse` is an operator with quadrics, studied beside
//! edge collapse.
//!
//! What to keep in mind while writing one:
//!
//! - A site whose price changes must become another site, such as by a stamp in it; else what waits in the queue is half right.
//! - Refuse rather than plan something odd: a refusal is counted, and the site is tried again.
//! - `kept` claims that a vertex stays where it is. If a plan is a merge of vertices, its model is a hierarchy too, and is
//!   judged under every dependency scheme.
//! - Laws say right, not good: a fold in space breaks none. Look at the report's errors and pictures for that.
//!
//! # How to read a counterexample
//!
//! Leave the link condition out of the operator above, and on a torus of 256 triangles one call says:
//!
//! ```text
//! crack-freeness is broken: node 5 gives facet [2, 3] a third cell, but the input is a manifold
//!   subject     shortest-edge
//!   case        a mesh of 256 cells, seed 1
//!   made small  256 cells to 18; its history: 7 modifications to 1, 18 cells to 14, a front of 2 to 0
//! ```
//!
//! - **The first line** is the law, the node and what is wrong there, in the ids of the smallest mesh. A facet is named by its
//!   vertices.
//! - **made small** tells both ways in which it was: the mesh that the operator is given (256 cells to 18), and what the
//!   operator does on that (7 modifications to the one that matters, on the 14 cells that it touches). A front of 0 nodes
//!   is the base mesh: nothing has to be refined to see it.
//! - **The OBJ** is the mesh at which the law is broken: open it and look for the vertices that the first line names.
//! - **The log** has the mesh, then the history: one modification a line, `kill` and `make` by id, in the words of
//!   [`crate::history`], so that it can be edited and read again.
//! - **The test** judges the operator on that mesh alone. Paste it beside the operator; it fails until the fault is gone, and
//!   stays as a guard.
//!
//! The files stand in `target/counterexamples`, and the seed of the case beside your test, from where it comes first the
//! next time. A history shrinks by what lies between two of its fronts, which is a model again; here one made cell of a
//! sheet was turned over:
//!
#![doc = include_str!("counterexample.svg")]
//!
//! Something that goes wrong in the middle of a walk is found by its log: `mtess bisect MODEL --log FILE --holds crack` names
//! the first step after which a law fails, since every step can be undone ([`crate::log`]).
