//! The problem as plain data, without any numerics.
//!
//! * [`case`]: what a user writes in a case file, with defaults and range checks.
//! * [`problem`]: what a solver needs: mesh, material, supports, pressure faces, contact pairs. Both the production
//!   path and the reference solver start from a [`Problem`], and share nothing else.
//!
//! Units: mm, N, MPa; contact stiffness N/mm³; pressures in a case file in kPa.

pub mod case;
pub mod problem;
mod written;

pub use case::{
    Case, CaseError, Contact, ContactMethod, Formulation, Invariant, Law, Load, Material, MeshOptions, Output, Probe,
    Resolution, Size, Solver,
};
pub use problem::{ContactPair, Problem, Support};

/// MPa per kPa.
pub const MPA_PER_KPA: f64 = 1e-3;
