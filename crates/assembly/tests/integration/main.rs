//! The assembler and its contributions from outside.
//!
//! * [`derivatives`]: residual against the energy, tangent against the residual.
//! * [`eigenvalues`]: rigid motions are the only ones without energy; inf-sup constants.
//! * [`elements`]: patch tests and rigid motions.
//! * [`laws`]: bodies with a known answer, the frame, states that no law describes.

// Helpers count as tests here.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod derivatives;
mod eigenvalues;
mod elements;
mod laws;
