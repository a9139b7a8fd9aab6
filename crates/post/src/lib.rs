//! Derived quantities and field output of an equilibrium: stresses, bending angle, penetration, VTK files.
//!
//! This crate turns a [`pneuflex_model::Problem`] and a displacement field into numbers and texts. It knows nothing of
//! how the field was found, and touches neither files nor clock nor terminal.
//!
//! * [`stress`]: Cauchy and von Mises stress at integration points and nodes, strain energy.
//! * [`surface_stress`]: the stress at nodes of surfaces whose traction is known.
//! * [`measures`]: end-face angle, centreline, air volume, reactions; [`centreline`]: points of that line.
//! * [`peak`], [`smallest_gap`]: smooth measures of the largest stress and stretch, and of the smallest gap, with their slopes.
//! * [`penetration`]: how far walls pass through each other, by dense sampling.
//! * [`contact`]: what the contact's own points carry.
//! * [`convergence`]: Richardson extrapolation over a sequence of meshes.
//! * [`fields`], [`vtu`]: VTK XML files.
//! * [`load_step`]: what needs no stresses, for a load step on the way.
//! * [`summary`]: all of it for one reached pressure, as `summary.json` has it.
//! * [`surface`], [`search`]: faces, and the closest point on a deformed surface, as the measures use them.
//!
//! Units: mm, N, MPa, mJ; displacements and reactions have one entry per node.

pub mod centreline;
pub mod contact;
pub mod convergence;
mod error;
pub mod fields;
pub mod load_step;
pub mod measures;
pub mod peak;
pub mod penetration;
pub mod search;
pub mod smallest_gap;
pub mod stress;
pub mod summary;
pub mod surface;
pub mod surface_stress;
#[cfg(test)]
mod testing;
pub mod vtu;

pub use error::{PostError, check};
