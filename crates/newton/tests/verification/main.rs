//! The production path against the reference solver.
//!
//! * [`cross_check`]: element, contribution, global residual and tangent, one Newton step, load path (design §2).

// Helpers count as tests here.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod cross_check;
mod fixtures;
