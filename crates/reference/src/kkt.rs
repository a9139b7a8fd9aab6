//! The Newton system of theory §6, with the elements' pressures as unknowns.
//!
//! ```text
//! ⎡ K   B    Φᵀ ⎤ ⎡ Δu ⎤     ⎡ R + Φᵀλ     ⎤
//! ⎢ Bᵀ  −M/κ 0  ⎥ ⎢ Δp ⎥ = − ⎢ θ − M p / κ ⎥
//! ⎣ Φ   0    0  ⎦ ⎣ Δλ ⎦     ⎣ c(u)        ⎦
//! ```
//!
//! Φ = ∂c/∂u has one row per constraint: for a held degree of freedom c = u − ū, with a single 1. R is the gradient of the whole
//! potential, Q_k − Q_p − Q_c, and K contains the curvature of the constraints times λ. At equilibrium λ = −R at held degrees of
//! freedom: the force of the body on its support.

use nalgebra::{DMatrix, DVector};

use crate::lu;

/// A condition c(u) = 0, linearised at some displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// c(u).
    pub value: f64,
    /// Degrees of freedom with the derivatives of c by them.
    pub gradient: Vec<(usize, f64)>,
}

/// Matrix and residual of one Newton step.
#[derive(Clone, Debug)]
pub struct KktSystem {
    /// The matrix above; its size is displacements + pressures + constraints.
    pub matrix: DMatrix<f64>,
    /// \[R + Φᵀλ; θ − M p / κ; c(u)\].
    pub residual: DVector<f64>,
}

impl KktSystem {
    /// Borders the saddle-point problem in (u, p) by constraints on u.
    ///
    /// `hessian` and `gradient` are those of the potential in (u, p); `multipliers` holds λ of every constraint.
    ///
    /// # Panics
    /// If there are not as many multipliers as constraints.
    pub fn new(
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        constraints: &[Constraint],
        multipliers: &[f64],
    ) -> Self {
        assert_eq!(multipliers.len(), constraints.len(), "one multiplier per constraint");
        let n = gradient.len();
        let mut matrix = DMatrix::zeros(n + constraints.len(), n + constraints.len());
        let mut residual = DVector::zeros(n + constraints.len());
        matrix.view_mut((0, 0), (n, n)).copy_from(hessian);
        residual.rows_mut(0, n).copy_from(gradient);
        for (i, Constraint { value, gradient }) in constraints.iter().enumerate() {
            for &(dof, slope) in gradient {
                matrix[(n + i, dof)] += slope;
                matrix[(dof, n + i)] += slope;
                residual[dof] += multipliers[i] * slope;
            }
            residual[n + i] = *value;
        }
        Self { matrix, residual }
    }

    /// \[Δu; Δp; Δλ\] by LU with partial pivoting; `None` if the matrix is singular or not finite.
    pub fn solve(self) -> Option<DVector<f64>> {
        lu::solve(self.matrix, -self.residual)
    }
}
