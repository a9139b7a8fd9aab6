//! Frictionless penalty contact between surfaces, of a surface with itself, and with rigid obstacles (theory §5).
//!
//! The chain of values: facets of the mesh → [`Surface`] → candidate faces by bounding boxes ([`broad_phase`]) → closest-point
//! [`projection`] → the foot that counts ([`narrow_phase`], within one body by the rules of [`self_contact`]) → touching points →
//! [`ContactBlock`]s, one per touching pair of faces or face on an [`obstacle`], each with its energy ½ k Σ w ⟨λ/k − d⟩², force and
//! consistent tangent ([`potential`]). In mortar contact the points come from the pieces between the edges of faces ([`segments`]), and what
//! has an energy is the gap averaged around a corner ([`averaging`], [`average_gap`]). Surfaces that are glued together ([`tie`]) give equations. The
//! multipliers λ are the solver's; they are zero for a plain penalty. For derivatives, points that touch are followed without a search (`following`).
//!
//! This crate knows faces and positions only: nothing of solids, loads or solvers.

pub mod average_gap;
pub mod averaging;
pub mod broad_phase;
pub mod brute_force;
pub mod contact_block;
mod following;
pub mod model;
pub mod narrow_phase;
pub mod obstacle;
mod overlap;
pub mod potential;
pub mod projection;
mod search;
pub mod segments;
pub mod self_contact;
mod stuck;
pub mod surface;
pub mod surface_pair;
pub mod tie;
pub mod touching;

pub use average_gap::AverageGap;
pub use averaging::Averaging;
pub use contact_block::{ContactBlock, ContactPoint, Partner};
pub use model::ContactModel;
pub use potential::{BlockOutput, distance_gradient, evaluate_block, predicted_tractions};
pub use projection::{Projection, project};
pub use stuck::{HeldInside, deepest_held};
pub use surface::Surface;
pub use surface_pair::SurfacePair;
pub use touching::Touching;
