//! Yeoh hyperelasticity (Yeoh 1993; theory §3): the part of the energy that does not penalise the change of volume.
//!
//! The energy density is `W(I₁, J) = Σᵢ Cᵢ₀ (Ī − 3)ⁱ`, i = 1…3, with `Ī = I₁` (the paper's *full* invariant) or
//! `Ī = J^(−2/3) I₁` (*isochoric*). The volumetric term ½ κ (J − 1)² belongs to the element, which decides where it is
//! evaluated; see the assembly crate.

mod limits;

use pneuflex_material::FirstInvariant;
use pneuflex_model::{Invariant, Material};

/// The Yeoh law without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct Yeoh {
    /// C₁₀, C₂₀, C₃₀, MPa.
    coefficients: [f64; 3],
    invariant: Invariant,
}

impl Yeoh {
    /// The law with constants C₁₀, C₂₀, C₃₀, MPa.
    pub fn new(coefficients: [f64; 3], invariant: Invariant) -> Self {
        Self { coefficients, invariant }
    }

    /// The law of a material; `None` if that is no polynomial of the first invariant.
    pub fn of(material: &Material) -> Option<Self> {
        Some(Self::new(material.law.reduced_polynomial()?, material.invariant))
    }
}

impl FirstInvariant for Yeoh {
    #[inline]
    fn invariant(&self) -> Invariant {
        self.invariant
    }

    /// φ(x) = Σ Cᵢ₀ xⁱ.
    #[inline]
    fn energy_of(&self, x: f64) -> [f64; 3] {
        let [c1, c2, c3] = self.coefficients;
        [x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + 3.0 * x * c3), 2.0 * c2 + 6.0 * x * c3]
    }

    fn zero_slope(&self) -> Option<f64> {
        limits::zero_slope(self.coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};
    use pneuflex_material::{Hyperelastic, InvariantDerivatives, Kinematics};

    fn law(invariant: Invariant) -> Yeoh {
        Yeoh::of(&Material { invariant, ..Material::default() }).unwrap()
    }

    #[test]
    fn it_passes_the_battery() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = law(invariant);
            battery::check_isotropic(&law, 0.3);
            battery::check_homogeneous(&law, |mode, l| {
                let slope = |[a, b, c]: [f64; 3]| law.energy_of(a * a + b * b + c * c - 3.0)[1];
                2.0 * slope(mode.stretches(l))
                    * match mode {
                        Mode::Uniaxial => l - l.powi(-2),
                        Mode::Equibiaxial => l - l.powi(-5),
                        Mode::Planar => l - l.powi(-3),
                    }
            });
        }
        battery::check_isochoric(&law(Invariant::Isochoric), 2.0 * 0.2712);
    }

    #[test]
    fn derivatives_by_invariants_match_finite_differences() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = law(invariant);
            let at = |i1: f64, j: f64| {
                law.evaluate(&Kinematics {
                    i1_minus_3: i1 - 3.0,
                    jacobian: j,
                    jacobian_minus_1: j - 1.0,
                    displacement_gradient: [[0.0; 3]; 3],
                    gradient: [[0.0; 3]; 3],
                    cofactor: [[0.0; 3]; 3],
                })
            };
            let (i1, j, h) = (4.3, 1.17, 1e-5);
            let here = at(i1, j);
            let by_i1 = |f: fn(&InvariantDerivatives) -> f64| (f(&at(i1 + h, j)) - f(&at(i1 - h, j))) / (2.0 * h);
            let by_j = |f: fn(&InvariantDerivatives) -> f64| (f(&at(i1, j + h)) - f(&at(i1, j - h))) / (2.0 * h);
            for (name, exact, difference) in [
                ("W1", here.w1, by_i1(|d| d.energy)),
                ("WJ", here.wj, by_j(|d| d.energy)),
                ("W11", here.w11, by_i1(|d| d.w1)),
                ("W1J", here.w1j, by_j(|d| d.w1)),
                ("WJ1", here.w1j, by_i1(|d| d.wj)),
                ("WJJ", here.wjj, by_j(|d| d.wj)),
            ] {
                assert!((exact - difference).abs() < 1e-8, "{invariant:?} {name}: {exact} against {difference}");
            }
        }
    }

    #[test]
    fn stress_at_rest_is_zero_for_the_isochoric_invariant_and_2_c10_for_the_full_one() {
        let rest = Kinematics::new(&[[0.0; 3]; 3]).unwrap();
        for (invariant, diagonal) in [(Invariant::Isochoric, 0.0), (Invariant::Full, 2.0 * 0.2712)] {
            let stress = law(invariant).energy_and_stress(&rest).1;
            for i in 0..3 {
                for j in 0..3 {
                    let expected = if i == j { diagonal } else { 0.0 };
                    assert!((stress[i][j] - expected).abs() < 1e-16, "{invariant:?}");
                }
            }
        }
    }

    /// Theory §9: nominal stress of homogeneous, incompressible states; the pressure follows from the free face.
    #[test]
    fn homogeneous_states_have_the_nominal_stress_of_the_theory() {
        let uniaxial = |l: f64| [l, 1.0 / l.sqrt(), 1.0 / l.sqrt()];
        let equibiaxial = |l: f64| [l, l, 1.0 / (l * l)];
        let pure_shear = |l: f64| [l, 1.0, 1.0 / l];
        type State = fn(f64) -> [f64; 3];
        let table: [(State, [f64; 3]); 3] = [
            (uniaxial, [0.646863, 1.359765, 3.609724]),
            (equibiaxial, [1.016334, 2.163505, 5.491638]),
            (pure_shear, [0.753572, 1.509338, 3.819412]),
        ];
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            for (state, expected) in &table {
                for (stretch, value) in [1.5, 2.0, 3.0].into_iter().zip(expected) {
                    let l = state(stretch);
                    let mut h = [[0.0; 3]; 3];
                    for i in 0..3 {
                        h[i][i] = l[i] - 1.0;
                    }
                    let p = law(invariant).energy_and_stress(&Kinematics::new(&h).unwrap()).1;
                    let nominal = p[0][0] - p[2][2] * l[2] / l[0];
                    assert!((nominal - value).abs() < 1e-6, "{invariant:?} {stretch}: {nominal} for {value}");
                }
            }
        }
    }
}
