//! Polynomials that shape functions are made of.

/// Quadratic Lagrange polynomials through −1, 0, 1: \[value, first, second derivative\] of each.
pub(crate) fn quadratic_line(t: f64) -> [[f64; 3]; 3] {
    [[0.5 * t * (t - 1.0), t - 0.5, 1.0], [1.0 - t * t, -2.0 * t, -2.0], [0.5 * t * (t + 1.0), t + 0.5, 1.0]]
}
