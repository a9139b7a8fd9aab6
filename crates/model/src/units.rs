//! Units of files in those of the solver.

/// MPa per kPa.
pub const MPA_PER_KPA: f64 = 1e-3;
