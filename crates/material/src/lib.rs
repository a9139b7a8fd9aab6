//! What hyperelastic laws have in common.
//!
//! A law is the energy density W(F) of a change of shape, in MPa per reference volume; the energy U(J) of a change of volume
//! belongs to the element, which decides where it is evaluated (see the assembly crate). [`Hyperelastic`] is the interface
//! that the laws in the sibling crates offer, [`battery`] the tests that each of them passes, [`volumetric`] U and its
//! derivatives.
//!
//! Laws in the invariants I₁ and J alone return the six numbers of [`InvariantDerivatives`], of which stress and tangent follow:
//!
//! ```text
//! P           = 2 W₁ F + W_J cof F
//! δF:∂P/∂F:δF = 2 W₁ δF:δF + W₁₁ (2F:δF)² + 2 W₁J (2F:δF)(cof F:δF) + W_JJ (cof F:δF)² + W_J δ²J
//! ```

use std::fmt::Debug;

pub mod battery;
mod invariants;
pub mod kinematics;
pub mod volumetric;

pub use invariants::InvariantDerivatives;
pub use kinematics::{InvalidJacobian, Kinematics, cofactor};

/// A second-order tensor; `[i][j]` belongs to ∂rᵢ/∂Xⱼ.
pub type Tensor = [[f64; 3]; 3];

/// A fourth-order tensor of derivatives by F; row and column 3i + j belong to ∂rᵢ/∂Xⱼ.
pub type Tangent = [[f64; 9]; 9];

/// Energy, stress and tangent at a deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Energy density W, MPa.
    pub energy: f64,
    /// First Piola–Kirchhoff stress P = ∂W/∂F, MPa.
    pub stress: Tensor,
    /// ∂P/∂F, MPa.
    pub tangent: Tangent,
}

/// An isotropic hyperelastic law without its volumetric energy.
pub trait Hyperelastic: Debug + Send + Sync {
    /// The law as a function of I₁ and J, if it is one: elements have a faster kernel for these.
    #[inline]
    fn by_invariants(&self, _kinematics: &Kinematics) -> Option<InvariantDerivatives> {
        None
    }

    /// The value of I₁ − 3 (Ī₁ − 3 for an isochoric law) beyond which the law has no stiffness left, so that stresses mean nothing there;
    /// `None` if there is none, or if the law is none in the first invariant alone: others are not checked.
    fn limit(&self) -> Option<f64> {
        None
    }

    /// Energy, stress and tangent, MPa. Where a formula overflows, they are not finite.
    fn respond(&self, kinematics: &Kinematics) -> Response;

    /// Energy and first Piola–Kirchhoff stress, MPa.
    fn energy_and_stress(&self, kinematics: &Kinematics) -> (f64, Tensor) {
        let response = self.respond(kinematics);
        (response.energy, response.stress)
    }

    /// Cauchy stress σ = J⁻¹ P Fᵀ, MPa, without the volumetric pressure.
    fn cauchy_stress(&self, kinematics: &Kinematics) -> Tensor {
        let ((_, p), f) = (self.energy_and_stress(kinematics), &kinematics.gradient);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| p[i][k] * f[j][k]).sum::<f64>() / kinematics.jacobian)
        })
    }
}

/// The second derivative of J = det F by F, `[3i + j][3k + l]` = Σ ε_ikm ε_jln F_mn.
pub fn second_derivative_of_jacobian(f: &Tensor) -> Tangent {
    let mut out = [[0.0; 9]; 9];
    for i in 0..3 {
        for j in 0..3 {
            for (k, m, one) in [((i + 1) % 3, (i + 2) % 3, 1.0), ((i + 2) % 3, (i + 1) % 3, -1.0)] {
                for (l, n, other) in [((j + 1) % 3, (j + 2) % 3, 1.0), ((j + 2) % 3, (j + 1) % 3, -1.0)] {
                    out[3 * i + j][3 * k + l] = one * other * f[m][n];
                }
            }
        }
    }
    out
}

/// t ← t + factor a bᵀ, with the tensors as vectors of nine entries.
pub fn add_dyad(t: &mut Tangent, factor: f64, a: &Tensor, b: &Tensor) {
    for (row, x) in t.iter_mut().zip(a.as_flattened()) {
        for (entry, y) in row.iter_mut().zip(b.as_flattened()) {
            *entry += factor * x * y;
        }
    }
}

/// t ← t + factor s.
pub fn add_scaled(t: &mut Tangent, factor: f64, s: &Tangent) {
    for (entry, x) in t.as_flattened_mut().iter_mut().zip(s.as_flattened()) {
        *entry += factor * x;
    }
}
