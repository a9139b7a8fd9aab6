//! Laws in the first invariant alone.

use std::fmt::Debug;

use pneuflex_model::Invariant;

use crate::hyperelastic::Hyperelastic;
use crate::invariants::InvariantDerivatives;
use crate::kinematics::Kinematics;
use crate::tensor::{Response, Tensor};

/// A law W = φ(Ī − 3), which is all that there is to say of it: everything else follows ([`Hyperelastic`]).
pub trait FirstInvariant: Debug + Send + Sync {
    /// Which invariant Ī is: I₁ or J^(−2/3) I₁.
    fn invariant(&self) -> Invariant;

    /// φ(x) and its first two derivatives, MPa, at x = Ī − 3; infinite where there is no such state of the material.
    fn energy_of(&self, x: f64) -> [f64; 3];

    /// See [`Hyperelastic::limit`].
    fn zero_slope(&self) -> Option<f64> {
        None
    }

    /// Energy density and derivatives by I₁ and J.
    #[inline]
    fn evaluate(&self, kinematics: &Kinematics) -> InvariantDerivatives {
        match self.invariant() {
            Invariant::Full => {
                let [energy, w1, w11] = self.energy_of(kinematics.i1_minus_3);
                InvariantDerivatives { energy, w1, w11, ..Default::default() }
            }
            Invariant::Isochoric => {
                let j = kinematics.jacobian;
                // Ī − 3 = s (I₁ − 3) + 3 (s − 1) keeps its digits near the undeformed state.
                let exponent = -2.0 / 3.0 * kinematics.jacobian_minus_1.ln_1p();
                let (s, s_minus_1) = (exponent.exp(), exponent.exp_m1());
                let bar_minus_3 = s * kinematics.i1_minus_3 + 3.0 * s_minus_1;
                let bar = bar_minus_3 + 3.0;
                let [energy, d1, d2] = self.energy_of(bar_minus_3);
                let bar_j = -2.0 / 3.0 * bar / j;
                InvariantDerivatives {
                    energy,
                    w1: d1 * s,
                    wj: d1 * bar_j,
                    w11: d2 * s * s,
                    w1j: d2 * s * bar_j - d1 * 2.0 / 3.0 * s / j,
                    wjj: d2 * bar_j * bar_j + d1 * 10.0 / 9.0 * bar / (j * j),
                }
            }
        }
    }
}

impl<L: FirstInvariant> Hyperelastic for L {
    #[inline]
    fn by_invariants(&self, kinematics: &Kinematics) -> Option<InvariantDerivatives> {
        Some(self.evaluate(kinematics))
    }

    fn limit(&self) -> Option<f64> {
        self.zero_slope()
    }

    fn respond(&self, kinematics: &Kinematics) -> Response {
        self.evaluate(kinematics).response(kinematics)
    }

    fn energy_and_stress(&self, kinematics: &Kinematics) -> (f64, Tensor) {
        let d = self.evaluate(kinematics);
        (d.energy, d.stress(kinematics))
    }

    fn cauchy_stress(&self, kinematics: &Kinematics) -> Tensor {
        self.evaluate(kinematics).cauchy_stress(kinematics)
    }
}
