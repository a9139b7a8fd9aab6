//! The problem as plain data, without any numerics.
//!
//! * [`case`]: what a user writes in a case file, with defaults and range checks.
//! * [`model_file`]: the same for bodies of any shape, from mesh files and decks.
//! * [`choice`], [`chosen`]: which nodes, faces or elements a file means, by name or by place.
//! * [`options`]: the tables that both have.
//! * [`law`], [`material`]: hyperelastic laws and their constants; what else a material has.
//! * [`fitted_to`]: the tests of materials, and how far constants were measured.
//! * [`formulation`]: element formulations.
//! * [`load`]: what acts on a body, as functions of the load parameter.
//! * [`quantity`]: the load parameter, pressures.
//! * [`obstacle`]: rigid bodies that a deformable one may touch.
//! * [`symmetry`]: planes at which the body is cut.
//! * [`problem`]: what a solver needs: mesh, materials, supports, cavities, loads, contact pairs. Both the production
//!   path and the reference solver start from a [`Problem`], and share nothing else.
//!
//! Units: mm, N, MPa; contact stiffness N/mm³; pressures in a case file in kPa.

pub mod case;
pub mod choice;
pub mod chosen;
mod contact_stiffness;
mod divided;
mod enrichment;
pub mod fitted_to;
pub mod formulation;
pub mod image;
pub mod law;
pub mod load;
pub mod material;
pub mod model_file;
mod number;
pub mod obstacle;
pub mod obstacle_table;
pub mod options;
pub mod problem;
mod problem_of_actuator;
pub mod quantity;
pub mod range_check;
mod series;
pub mod state_kind;
pub mod symmetry;
mod symmetry_check;
mod units;
mod whole;

pub use case::Case;
pub use choice::Choice;
pub use chosen::{Asked, Chooser};
pub use divided::Undividable;
pub use fitted_to::{FittedTo, Mode};
pub use formulation::Formulation;
pub use image::Image;
pub use law::{Invariant, Law, OgdenTerm, Volumetric};
pub use load::{Cavity, Control, Curve, Gas, LinearEquation, Motion};
pub use material::Material;
pub use obstacle::{Obstacle, Shape};
pub use obstacle_table::{ObstacleTable, ShapeName};
pub use options::{Contact, ContactMethod, Continuation, Load, MeshOptions, Output, Probe, Resolution, Size, Solver};
pub use problem::{Clock, ContactPair, OpenCavity, Problem, Region, Support, Tie};
pub use quantity::{LoadParameter, Pressure};
pub use range_check::CaseError;
pub use series::Series;
pub use state_kind::StateKind;
pub use symmetry::{NoSymmetry, SymmetryPlane};
pub use symmetry_check::{Asymmetry, BoxSide, ProblemPart};
pub use units::MPA_PER_KPA;
