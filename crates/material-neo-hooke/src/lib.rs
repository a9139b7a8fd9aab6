//! Neo-Hookean hyperelasticity: W = C₁₀ (Ī − 3), with Ī = I₁ (the *full* invariant) or Ī = J^(−2/3) I₁ (*isochoric*).

use pneuflex_material::{Hyperelastic, InvariantDerivatives, Kinematics, Response, Tensor};
use pneuflex_model::Invariant;

/// The neo-Hookean law without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct NeoHooke {
    c10: f64,
    invariant: Invariant,
}

impl NeoHooke {
    /// The law with the constant C₁₀, MPa, half the shear modulus at rest.
    pub fn new(c10: f64, invariant: Invariant) -> Self {
        Self { c10, invariant }
    }

    /// Energy density and derivatives by I₁ and J.
    pub fn evaluate(&self, kinematics: &Kinematics) -> InvariantDerivatives {
        let c10 = self.c10;
        match self.invariant {
            Invariant::Full => {
                InvariantDerivatives { energy: c10 * kinematics.i1_minus_3, w1: c10, ..Default::default() }
            }
            Invariant::Isochoric => {
                let j = kinematics.jacobian;
                // Ī − 3 = s (I₁ − 3) + 3 (s − 1) keeps its digits near the undeformed state.
                let exponent = -2.0 / 3.0 * kinematics.jacobian_minus_1.ln_1p();
                let (s, s_minus_1) = (exponent.exp(), exponent.exp_m1());
                let bar_minus_3 = s * kinematics.i1_minus_3 + 3.0 * s_minus_1;
                let bar = bar_minus_3 + 3.0;
                InvariantDerivatives {
                    energy: c10 * bar_minus_3,
                    w1: c10 * s,
                    wj: -2.0 / 3.0 * c10 * bar / j,
                    w11: 0.0,
                    w1j: -2.0 / 3.0 * c10 * s / j,
                    wjj: 10.0 / 9.0 * c10 * bar / (j * j),
                }
            }
        }
    }
}

impl Hyperelastic for NeoHooke {
    #[inline]
    fn by_invariants(&self, kinematics: &Kinematics) -> Option<InvariantDerivatives> {
        Some(self.evaluate(kinematics))
    }

    fn respond(&self, kinematics: &Kinematics) -> Response {
        self.evaluate(kinematics).response(kinematics)
    }

    fn energy_and_stress(&self, kinematics: &Kinematics) -> (f64, Tensor) {
        let d = self.evaluate(kinematics);
        (d.energy, d.stress(kinematics))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};

    #[test]
    fn it_passes_the_battery() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = NeoHooke::new(0.2712, invariant);
            battery::check_isotropic(&law, 0.3);
            battery::check_homogeneous(&law, |mode, l| {
                2.0 * 0.2712
                    * match mode {
                        Mode::Uniaxial => l - l.powi(-2),
                        Mode::Equibiaxial => l - l.powi(-5),
                        Mode::Planar => l - l.powi(-3),
                    }
            });
        }
        battery::check_isochoric(&NeoHooke::new(0.2712, Invariant::Isochoric), 2.0 * 0.2712);
    }
}
