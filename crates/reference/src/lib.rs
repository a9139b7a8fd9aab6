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
//! * [`solid`]: the strain energy (theory §3).
//! * [`pressure`], [`follower_pressure`]: pressure behind closed surfaces, which has a potential, and on any face (theory §4).
//! * [`cavity`]: cavities with a given pressure, volume or amount of gas (theory §13).
//! * [`conservative_load`]: forces, tractions and weights.
//! * [`contact`], [`closest_point`], [`obstacle`]: contact between surfaces and with rigid obstacles (theory §5).
//! * [`kkt`]: the Newton system (theory §6).
//! * [`solver`]: everything together, and load paths.
//!
//! # What is modelled
//! All of a [`Problem`](pneuflex_model::Problem) but for [`Unmodelled`]: a problem that needs one of these is refused with
//! [`ReferenceError::NotModelled`]. Every structure of a problem is taken apart without `..` where it is consumed, the problem itself
//! in [`ReferenceSolver::new`]: a new field does not compile until somebody has decided what becomes of it.
//!
//! What it does not know: sparsity, threads, elimination of unknowns, predictors, files. A Newton step with about 1500
//! rows takes half a second, which is the size it is meant for.
//!
//! Units: mm, N, MPa; contact stiffness N/mm³; pressures in MPa. Curves are evaluated by the model. Displacements come as three
//! numbers per node, x, y, z, held ones included: entry `3 · node + axis`.

pub mod cavity;
pub mod closest_point;
pub mod conservative_load;
pub mod contact;
pub mod differentiate;
pub mod elements;
pub mod energy;
mod error;
pub mod follower_pressure;
pub mod kkt;
mod lu;
pub mod obstacle;
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

pub use cavity::CavityModel;
pub use conservative_load::ConservativeLoads;
pub use contact::{ContactModel, ContactPoint};
pub use differentiate::Dual;
pub use error::{ReferenceError, Unmodelled};
pub use follower_pressure::FollowerPressure;
pub use kkt::{Constraint, KktSystem};
pub use obstacle::ObstacleModel;
pub use pressure::AirModel;
pub use solid::SolidModel;
pub use solver::{PathOptions, ReferenceSolver, ReferenceState};
