//! What hyperelastic laws have in common.
//!
//! A law is the energy density W(F) of a change of shape, in MPa per reference volume; the energy U(J) of a change of volume
//! belongs to the element, which decides where it is evaluated (see the assembly crate). [`Hyperelastic`] is the interface
//! that the laws in the sibling crates offer, [`battery`] the tests that each of them passes, [`volumetric`] U and its
//! derivatives.
//!
//! Laws in the first invariant alone say no more than φ(Ī − 3) ([`FirstInvariant`]). Laws in the invariants I₁ and J return the six numbers of [`InvariantDerivatives`], of which stress and tangent follow:
//!
//! ```text
//! P           = 2 W₁ F + W_J cof F
//! δF:∂P/∂F:δF = 2 W₁ δF:δF + W₁₁ (2F:δF)² + 2 W₁J (2F:δF)(cof F:δF) + W_JJ (cof F:δF)² + W_J δ²J
//! ```

pub mod battery;
pub mod drucker;
mod first_invariant;
mod hyperelastic;
mod invariants;
pub mod kinematics;
mod tensor;
pub mod volumetric;

pub use first_invariant::FirstInvariant;
pub use hyperelastic::Hyperelastic;
pub use invariants::InvariantDerivatives;
pub use kinematics::{InvalidJacobian, Kinematics, cofactor};
pub use tensor::{Response, Tangent, Tensor, add_dyad, add_scaled, second_derivative_of_jacobian};
