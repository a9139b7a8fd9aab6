//! The problem as plain data, without any numerics.
//!
//! * [`case`]: what a user writes in a case file, with defaults and range checks.
//! * [`material`]: hyperelastic laws and their constants.
//! * [`model_file`]: the same for bodies of any shape, from mesh files and decks.
//! * [`load`]: what acts on a body, as functions of time.
//! * [`obstacle`]: rigid bodies that a deformable one may touch.
//! * [`problem`]: what a solver needs: mesh, materials, supports, cavities, loads, contact pairs. Both the production
//!   path and the reference solver start from a [`Problem`], and share nothing else.
//!
//! Units: mm, N, MPa; contact stiffness N/mm³; pressures in a case file in kPa.

pub mod case;
pub mod load;
pub mod material;
pub mod model_file;
pub mod obstacle;
pub mod obstacle_table;
pub mod problem;
mod written;

pub use case::{
    Case, CaseError, Contact, ContactMethod, Formulation, Load, MeshOptions, Output, Probe, Resolution, Size, Solver,
};
pub use load::{Cavity, Control, Curve, Gas, LinearEquation, Motion};
pub use material::{Invariant, Law, Material, OgdenTerm, Volumetric};
pub use obstacle::{Obstacle, Shape};
pub use obstacle_table::{ObstacleTable, ShapeName};
pub use problem::{Clock, ContactPair, OpenCavity, Problem, Region, Support};

/// MPa per kPa.
pub const MPA_PER_KPA: f64 = 1e-3;
