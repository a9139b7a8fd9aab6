//! Laws in the invariants I₁ and J.

use crate::kinematics::Kinematics;
use crate::tensor::{Response, Tensor, add_dyad, add_scaled, second_derivative_of_jacobian};

/// Energy density and its derivatives with respect to I₁ and J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InvariantDerivatives {
    /// W, MPa.
    pub energy: f64,
    /// ∂W/∂I₁.
    pub w1: f64,
    /// ∂W/∂J.
    pub wj: f64,
    /// ∂²W/∂I₁².
    pub w11: f64,
    /// ∂²W/∂I₁∂J.
    pub w1j: f64,
    /// ∂²W/∂J².
    pub wjj: f64,
}

impl InvariantDerivatives {
    /// First Piola–Kirchhoff stress P = 2 W₁ F + W_J cof F, MPa; rows are the directions of the force.
    pub fn stress(&self, kinematics: &Kinematics) -> Tensor {
        let (f, c) = (&kinematics.gradient, &kinematics.cofactor);
        std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * self.w1 * f[i][j] + self.wj * c[i][j]))
    }

    /// Cauchy stress σ = J⁻¹ P Fᵀ = (2 W₁ / J) F Fᵀ + W_J 1, MPa.
    pub fn cauchy_stress(&self, kinematics: &Kinematics) -> Tensor {
        let f = &kinematics.gradient;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let b: f64 = (0..3).map(|k| f[i][k] * f[j][k]).sum();
                2.0 * self.w1 / kinematics.jacobian * b + if i == j { self.wj } else { 0.0 }
            })
        })
    }

    /// Energy, stress and tangent.
    pub fn response(&self, kinematics: &Kinematics) -> Response {
        let (f, c) = (&kinematics.gradient, &kinematics.cofactor);
        let mut tangent = [[0.0; 9]; 9];
        for (k, row) in tangent.iter_mut().enumerate() {
            row[k] = 2.0 * self.w1;
        }
        add_dyad(&mut tangent, 4.0 * self.w11, f, f);
        add_dyad(&mut tangent, 2.0 * self.w1j, f, c);
        add_dyad(&mut tangent, 2.0 * self.w1j, c, f);
        add_dyad(&mut tangent, self.wjj, c, c);
        add_scaled(&mut tangent, self.wj, &second_derivative_of_jacobian(f));
        Response { energy: self.energy, stress: self.stress(kinematics), tangent }
    }
}
