//! Element kernels and their deterministic parallel assembly.
//!
//! A solver is given a list of [`Contribution`]s: [`Solid`], [`cavity::PressurisedFaces`], [`ConservativeLoads`], [`Equations`],
//! [`Distances`] and [`ContactForces`] here. Two levels that know nothing of each other put their blocks together:
//!
//! * local: a [`LocalContribution`] is a list of *blocks* (an element, a loaded face, a touching pair of faces); it knows
//!   its nodes and computes energy, residual and tangent of one block. What a pressure's tangent has beside its symmetric part is in
//!   [`boundary_term`].
//! * global: [`Assembler`] knows blocks and node numbers only, and scatters what the blocks compute into a residual
//!   vector and a node-blocked symmetric matrix.
//!
//! Nothing here knows about load steps, convergence or linear solvers.
//!
//! # Parallel and still the same to the last bit
//!
//! Ways to add elements in parallel: locks or atomics (order of summation changes from run to run); colouring (fixed
//! order, but a pass over the mesh per colour, and neighbours never share a cache); private copies (memory times
//! threads, order depends on their number); ordered scatter: blocks are computed in parallel batch by batch, and each
//! batch is added in block order while the next one is being computed. The last is used: sums do not depend on the
//! number of threads, and scattering costs a small part of computing.

pub mod boundary_term;
pub mod cavity;
pub mod conservative_load;
pub mod contact;
pub mod contribution;
pub mod distances;
pub mod elimination;
pub mod equations;
pub mod follower_pressure;
pub mod formulation;
pub mod global;
mod kernel;
pub mod law;
pub mod local;
pub mod solid;
pub mod spring;

pub use boundary_term::{BoundaryTerm, Couplings};
pub use conservative_load::ConservativeLoads;
pub use contact::ContactForces;
pub use contribution::{
    BorderedEquation, Contribution, Frozen, Mixed, Position, Prediction, RigidMotion, Tractions, Unilateral,
};
pub use distances::Distances;
pub use elimination::{CondensedBlocks, Elimination};
pub use equations::Equations;
pub use follower_pressure::FollowerPressure;
pub use formulation::ReferenceElement;
pub use global::{Assembler, Totals};
pub use local::{LocalBlock, LocalContribution, LocalError, Request};
pub use solid::Solid;
pub use spring::NodeSprings;
