//! Frictionless penalty contact between facing surfaces (theory §5).
//!
//! The chain of values: facets of the mesh → [`Surface`] → candidate faces by bounding boxes → closest-point
//! [`projection`] → touching points → [`ContactBlock`]s, one per touching pair of faces, each with its energy
//! ½ k Σ w ⟨−d⟩², force and consistent tangent ([`potential`]).
//!
//! This crate knows faces and positions only: nothing of solids, loads or solvers.

pub mod potential;
pub mod projection;
pub mod search;
pub mod surface;

pub use potential::{BlockOutput, evaluate_block, predicted_tractions};
pub use projection::{Projection, project};
pub use search::{ContactBlock, ContactModel, ContactPoint};
pub use surface::Surface;
