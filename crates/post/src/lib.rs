//! Derived quantities and field output of an equilibrium: stresses, bending angle, penetration, VTK files.
//!
//! This crate turns a [`pneuflex_model::Problem`] and a displacement field into numbers and texts. It knows nothing of
//! how the field was found, and touches neither files nor clock nor terminal.
//!
//! * [`stress`]: Cauchy and von Mises stress at integration points and nodes, strain energy.
//! * [`measures`]: end-face angle, centreline, air volume, reactions.
//! * [`penetration`]: how far walls pass through each other, by dense sampling.
//! * [`contact`]: what the contact's own points carry.
//! * [`convergence`]: Richardson extrapolation over a sequence of meshes.
//! * [`fields`], [`vtu`]: VTK XML files.
//! * [`summary`]: all of it for one landed pressure, as `summary.json` has it.
//! * [`picture`], [`chart`]: pictures of deformed bodies and line charts, as [`drawing`]s in SVG and PNG.
//!
//! Units: mm, N, MPa, mJ; displacements and reactions are lists with three entries per node. Faces are quadrilaterals.

pub mod chart;
pub mod contact;
pub mod convergence;
pub mod drawing;
mod error;
pub mod fields;
pub mod measures;
pub mod penetration;
pub mod picture;
mod search;
pub mod stress;
pub mod summary;
mod surface;
#[cfg(test)]
mod testing;
mod vector;
pub mod vtu;

pub use error::PostError;
