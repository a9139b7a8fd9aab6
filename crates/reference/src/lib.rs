//! A naive dense solver that cross-checks the production path.
//!
//! It is written to be read beside the theory: every contribution is a scalar energy, every derivative is taken by
//! automatic differentiation (`num-dual`), the Newton step is the paper's KKT system with a multiplier for every held
//! degree of freedom, and the linear algebra is dense LU. From the other crates it takes data only: a
//! [`Problem`](pneuflex_model::Problem) and its mesh with the node numbering. Shape functions, quadrature, material, pressure and contact
//! are its own, so that agreement with the production crates is evidence.
//!
//! * [`elements`]: what the elements are made of.
//! * [`shape`], [`quadrature`]: interpolation by inverted Vandermonde matrices, Gauss rules by Golub and Welsch.
//! * [`differentiate`]: scalar functions of a few linear combinations of the unknowns, and their derivatives.
//! * [`energy`]: the Yeoh energy of a deformation gradient (theory §3).
//! * [`solid`], [`pressure`], [`contact`]: the contributions (theory §3, §4, §5).
//! * [`kkt`]: the Newton system (theory §6).
//! * [`solver`]: everything together, and load paths.
//!
//! What it does not know: sparsity, threads, elimination of unknowns, predictors, files. A Newton step with about 1500
//! rows takes half a second, which is the size it is meant for.
//!
//! Units: mm, N, MPa; contact stiffness N/mm³; pressures in MPa, on load paths in kPa. Displacements come as three
//! numbers per node, x, y, z, held ones included: entry `3 · node + axis`.

pub mod contact;
pub mod differentiate;
pub mod elements;
pub mod energy;
mod error;
pub mod kkt;
mod lu;
pub mod pressure;
pub mod quadrature;
pub mod shape;
pub mod solid;
pub mod solver;
mod tensor_function;

#[cfg(test)]
mod chambers;
#[cfg(test)]
mod closed_forms;
#[cfg(test)]
mod testing;

pub use contact::{ContactModel, ContactPoint};
pub use differentiate::Dual;
pub use error::ReferenceError;
pub use pressure::AirModel;
pub use solid::SolidModel;
pub use solver::{Load, PathOptions, ReferenceSolver, ReferenceState};
