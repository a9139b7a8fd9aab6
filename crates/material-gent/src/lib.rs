//! Gent's hyperelasticity (Gent 1996, *Rubber Chem. Technol.* 69), for materials that lock: their chains cannot be stretched further.
//!
//! ```text
//! W = φ(x) = −½ μ J_m ln(1 − x/J_m),   x = Ī₁ − 3 = J^(−2/3) I₁ − 3
//! φ′ = ½ μ / (1 − x/J_m),   φ″ = φ′ / (J_m − x)
//! ```
//!
//! The energy is infinite from x = J_m on: there is no such state of the material, and energy, stress and tangent are not finite there, which
//! the solver takes as a step that goes too far. Below, φ′ and φ″ are positive, so that the law is stable in every deformation. For
//! J_m → ∞ it is neo-Hooke's.

use pneuflex_material::FirstInvariant;
use pneuflex_model::Invariant;

/// Gent's law without its volumetric term, in the isochoric invariant.
#[derive(Clone, Debug, PartialEq)]
pub struct Gent {
    /// μ, MPa.
    shear_modulus: f64,
    /// J_m, the value of Ī₁ − 3 that is never reached.
    jm: f64,
}

impl Gent {
    /// The law with the shear modulus at rest μ > 0, MPa, and J_m > 0, the value of Ī₁ − 3 at which it locks.
    pub fn new(shear_modulus: f64, jm: f64) -> Self {
        Self { shear_modulus, jm }
    }
}

impl FirstInvariant for Gent {
    #[inline]
    fn invariant(&self) -> Invariant {
        Invariant::Isochoric
    }

    #[inline]
    fn energy_of(&self, x: f64) -> [f64; 3] {
        let left = 1.0 - x / self.jm;
        // Beyond J_m the formula has a value again, of the wrong sign.
        if left <= 0.0 {
            return [f64::INFINITY; 3];
        }
        let slope = 0.5 * self.shear_modulus / left;
        [-0.5 * self.shear_modulus * self.jm * (-x / self.jm).ln_1p(), slope, slope / (self.jm * left)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};
    use pneuflex_material::{Hyperelastic, Kinematics};

    #[test]
    fn it_passes_the_battery() {
        // The battery's largest states have Ī₁ − 3 = 15.
        let (shear_modulus, jm) = (0.54, 40.0);
        let law = Gent::new(shear_modulus, jm);
        battery::check_isotropic(&law, 0.3);
        battery::check_isochoric(&law, shear_modulus);
        battery::check_homogeneous(&law, |mode, l| {
            let [a, b, c] = mode.stretches(l);
            let x = a * a + b * b + c * c - 3.0;
            shear_modulus * jm / (jm - x)
                * match mode {
                    Mode::Uniaxial => l - l.powi(-2),
                    Mode::Equibiaxial => l - l.powi(-5),
                    Mode::Planar => l - l.powi(-3),
                }
        });
    }

    /// Stretched to λ with the sides free, Ī₁ − 3 = λ² + 2/λ − 3 is J_m = 8 at λ = 3.2217
    #[test]
    fn there_is_no_state_from_the_locking_stretch_on() {
        let law = Gent::new(0.5, 8.0);
        let at = |l: f64| {
            let across = 1.0 / l.sqrt() - 1.0;
            law.respond(&Kinematics::new(&[[l - 1.0, 0.0, 0.0], [0.0, across, 0.0], [0.0, 0.0, across]]).unwrap())
        };
        let (below, beyond) = (at(3.2216), at(3.2218));
        assert!(below.energy > 10.0 && below.energy.is_finite() && below.stress[0][0] > 100.0, "{below:?}");
        assert!(below.tangent.as_flattened().iter().all(|a| a.is_finite()));
        assert_eq!((beyond.energy, at(5.0).energy), (f64::INFINITY, f64::INFINITY));
        assert!(!beyond.stress[0][0].is_finite());
    }

    #[test]
    fn it_is_neo_hookean_where_it_never_locks() {
        let h = [[0.31, -0.22, 0.15], [0.08, -0.17, 0.21], [-0.12, 0.19, 0.26]];
        let kinematics = Kinematics::new(&h).unwrap();
        let bar_minus_3 = kinematics.jacobian.powf(-2.0 / 3.0) * (kinematics.i1_minus_3 + 3.0) - 3.0;
        let energy = Gent::new(0.6, 1e9).respond(&kinematics).energy;
        assert!((energy / (0.3 * bar_minus_3) - 1.0).abs() < 1e-8, "{energy}");
    }
}
