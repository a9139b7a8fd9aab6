//! What a path has cost.

use serde::{Deserialize, Serialize};

/// Seconds spent, by kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Residual and tangent of solid and pressure.
    pub assembly_s: f64,
    /// Analysis and numerical factorisation.
    pub factor_s: f64,
    /// Triangular solves and rotation-aware increments.
    pub solve_s: f64,
    /// Contact search, forces and tangent.
    pub contact_s: f64,
    /// The whole path.
    pub total_s: f64,
}

/// What a path has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathReport {
    /// Newton iterations in all, rejected attempts included.
    pub iterations: usize,
    /// Seconds spent.
    pub timing: Timing,
}
