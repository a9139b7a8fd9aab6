//! The interface of hyperelastic laws.

use std::fmt::Debug;

use crate::invariants::InvariantDerivatives;
use crate::kinematics::Kinematics;
use crate::tensor::{Response, Tensor};

/// An isotropic hyperelastic law without its volumetric energy.
pub trait Hyperelastic: Debug + Send + Sync {
    /// The law as a function of I₁ and J, if it is one: elements have a faster kernel for these.
    #[inline]
    fn by_invariants(&self, _kinematics: &Kinematics) -> Option<InvariantDerivatives> {
        None
    }

    /// The value of I₁ − 3 (Ī₁ − 3 for an isochoric law) beyond which the law has no stiffness left, so that stresses mean nothing there;
    /// `None` if there is none, or if the law is none in the first invariant alone: for others see [`crate::drucker`].
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
