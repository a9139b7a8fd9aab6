//! The Newton system of theory §6, with the elements' pressures as unknowns.
//!
//! ```text
//! ⎡ K   B    Φᵀ ⎤ ⎡ Δu ⎤     ⎡ R + Φᵀλ     ⎤
//! ⎢ Bᵀ  −M/κ 0  ⎥ ⎢ Δp ⎥ = − ⎢ θ − M p / κ ⎥
//! ⎣ Φ   0    0  ⎦ ⎣ Δλ ⎦     ⎣ u_held − ū  ⎦
//! ```
//!
//! Φ has one row per held degree of freedom, with a single 1. R is the gradient of the whole potential, Q_k − Q_p − Q_c.
//! At equilibrium λ = −R at held degrees of freedom: the force of the body on its support.

use nalgebra::{DMatrix, DVector};

use crate::lu;

/// Matrix and residual of one Newton step.
#[derive(Clone, Debug)]
pub struct KktSystem {
    /// The matrix above; its size is displacements + pressures + held degrees of freedom.
    pub matrix: DMatrix<f64>,
    /// \[R + Φᵀλ; θ − M p / κ; u_held − ū\].
    pub residual: DVector<f64>,
}

impl KktSystem {
    /// Borders the saddle-point problem in (u, p) by the constraints u = ū on held degrees of freedom.
    ///
    /// `hessian` and `gradient` are those of the potential in (u, p); `held` lists the held degrees of freedom, `defect`
    /// is u − ū and `multipliers` λ for each of them.
    ///
    /// # Panics
    /// If `defect` or `multipliers` are not as long as `held`.
    pub fn new(
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        held: &[usize],
        defect: &[f64],
        multipliers: &[f64],
    ) -> Self {
        assert!(defect.len() == held.len() && multipliers.len() == held.len(), "one entry per held degree of freedom");
        let n = gradient.len();
        let mut matrix = DMatrix::zeros(n + held.len(), n + held.len());
        let mut residual = DVector::zeros(n + held.len());
        matrix.view_mut((0, 0), (n, n)).copy_from(hessian);
        residual.rows_mut(0, n).copy_from(gradient);
        for (i, &dof) in held.iter().enumerate() {
            matrix[(n + i, dof)] = 1.0;
            matrix[(dof, n + i)] = 1.0;
            residual[dof] += multipliers[i];
            residual[n + i] = defect[i];
        }
        Self { matrix, residual }
    }

    /// \[Δu; Δp; Δλ\] by LU with partial pivoting; `None` if the matrix is singular or not finite.
    pub fn solve(self) -> Option<DVector<f64>> {
        lu::solve(self.matrix, -self.residual)
    }
}
