//! The assembler and its contributions from outside.
//!
//! * [`buffers`]: what was in a block's buffers does not come through.
//! * [`derivatives`]: residual against the energy, tangent against the residual.
//! * [`eigenvalues`]: rigid motions are the only ones without energy; inf-sup constants.
//! * [`elements`]: patch tests and rigid motions.
//! * [`global`]: the assembler with contributions of integers ([`mock`]).
//! * [`pattern`]: the tangent has room for what touches.
//! * [`laws`]: bodies with a known answer, the frame, states that no law describes.

// Helpers count as tests here.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod buffers;
mod derivatives;
mod eigenvalues;
mod elements;
mod global;
mod laws;
mod mock;
mod pattern;
