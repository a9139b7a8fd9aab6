//! Sparse symmetric direct solvers for node-blocked matrices.
//!
//! A finite-element matrix couples nodes, and every node carries the same number `B` of unknowns (3 displacements, or
//! 1 value of a scalar field). The graph of the *nodes* is therefore all that ordering and symbolic analysis need to
//! see. Three steps, each reusable by itself:
//!
//! 1. [`BlockPattern`]: which nodes couple (from the elements, by [`BlockPattern::from_cliques`]);
//! 2. [`Symbolic`]: fill-reducing order and structure of the factor, once per pattern;
//! 3. [`Factor`]: numbers, as often as the values change, then [`Factor::solve_in_place`].
//!
//! ```
//! use std::sync::Arc;
//! use pneuflex_factor::{BlockPattern, Factor, Ordering, Parallelism, Symbolic};
//!
//! // Two springs in a row, the first node held.
//! let springs: [[u32; 2]; 2] = [[0, 1], [1, 2]];
//! let pattern = BlockPattern::from_cliques(3, springs.iter().map(|s| s.as_slice()));
//! let values = [1.0, -1.0, 2.0, -1.0, 1.0];
//! let symbolic = Arc::new(Symbolic::<1>::analyze(&pattern, Ordering::default())?);
//! let mut factor = Factor::new(symbolic);
//! let inertia = factor.factorize(&values, &[true, false, false], Parallelism::Serial)?;
//! assert_eq!(inertia.negative, 0);
//! let mut displacement = [0.0, 0.0, 1.0];
//! factor.solve_in_place(&mut displacement, 1)?;
//! assert!((displacement[2] - 2.0).abs() < 1e-12);
//! # Ok::<(), pneuflex_factor::FactorError>(())
//! ```
//!
//! [`gmres`] solves with a few unsymmetric terms that the factor of a symmetric matrix lacks.
//!
//! This crate knows nothing of meshes, elements or loads.

mod assembly_tree;
mod dense;
mod elimination;
mod error;
pub mod faer_backend;
mod front;
mod geometric;
pub mod gmres;
mod minimum_degree;
mod numeric;
mod ordering;
mod outcome;
mod pattern;
mod plan;
mod solve;
mod symbolic;
pub mod testing;

pub use error::FactorError;
pub use numeric::Factor;
pub use ordering::Ordering;
pub use outcome::{Inertia, Method, Parallelism};
pub use pattern::{BlockPattern, multiply};
pub use symbolic::Symbolic;
