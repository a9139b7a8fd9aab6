//! Yeoh hyperelasticity (Yeoh 1993; theory §3): the part of the energy that does not penalise the change of volume.
//!
//! The energy density is `W(I₁, J) = Σᵢ Cᵢ₀ (Ī − 3)ⁱ`, i = 1…3, with `Ī = I₁` (the paper's *full* invariant) or
//! `Ī = J^(−2/3) I₁` (*isochoric*). The volumetric term ½ κ (J − 1)² belongs to the element, which decides where it is
//! evaluated; see the assembly crate.
//!
//! Everything isotropic in (I₁, J) has the same stress and tangent:
//!
//! ```text
//! P      = 2 W₁ F + W_J J F⁻ᵀ
//! δF:∂P/∂F:δF = 2 W₁ δF:δF + W₁₁ (2F:δF)² + 2 W₁J (2F:δF)(J F⁻ᵀ:δF) + W_JJ (J F⁻ᵀ:δF)² + W_J δ²J
//! ```
//!
//! so a material returns only the six numbers of [`InvariantDerivatives`].

pub mod kinematics;
pub mod limits;

pub use kinematics::{InvalidJacobian, Kinematics};
use pneuflex_model::{Invariant, Material};

/// The Yeoh law without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct Yeoh {
    /// C₁₀, C₂₀, C₃₀, MPa.
    coefficients: [f64; 3],
    invariant: Invariant,
}

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

impl Yeoh {
    /// The law with constants C₁₀, C₂₀, C₃₀, MPa.
    pub fn new(coefficients: [f64; 3], invariant: Invariant) -> Self {
        Self { coefficients, invariant }
    }

    /// The law of a material; `None` if that is no polynomial of the first invariant.
    pub fn of(material: &Material) -> Option<Self> {
        Some(Self::new(material.law.reduced_polynomial()?, material.invariant))
    }

    /// Energy density and derivatives at a deformation.
    pub fn evaluate(&self, kinematics: &Kinematics) -> InvariantDerivatives {
        match self.invariant {
            Invariant::Full => {
                let [w, w1, w11] = self.energy_of(kinematics.i1_minus_3);
                InvariantDerivatives { energy: w, w1, w11, ..Default::default() }
            }
            Invariant::Isochoric => {
                let j = kinematics.jacobian;
                // Ī − 3 = s (I₁ − 3) + 3 (s − 1) keeps its digits near the undeformed state.
                let exponent = -2.0 / 3.0 * kinematics.jacobian_minus_1.ln_1p();
                let (s, s_minus_1) = (exponent.exp(), exponent.exp_m1());
                let bar_minus_3 = s * kinematics.i1_minus_3 + 3.0 * s_minus_1;
                let bar = bar_minus_3 + 3.0;
                let [w, d1, d2] = self.energy_of(bar_minus_3);
                let bar_j = -2.0 / 3.0 * bar / j;
                InvariantDerivatives {
                    energy: w,
                    w1: d1 * s,
                    wj: d1 * bar_j,
                    w11: d2 * s * s,
                    w1j: d2 * s * bar_j - d1 * 2.0 / 3.0 * s / j,
                    wjj: d2 * bar_j * bar_j + d1 * 10.0 / 9.0 * bar / (j * j),
                }
            }
        }
    }

    /// First Piola-Kirchhoff stress P = 2 W₁ F + W_J J F⁻ᵀ, MPa; rows are the directions of the force.
    pub fn first_piola_kirchhoff_stress(&self, kinematics: &Kinematics) -> [[f64; 3]; 3] {
        let d = self.evaluate(kinematics);
        let (f, c) = (&kinematics.gradient, &kinematics.cofactor);
        std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * d.w1 * f[i][j] + d.wj * c[i][j]))
    }

    /// Cauchy stress σ = J⁻¹ P Fᵀ = (2 W₁ / J) F Fᵀ + W_J 1, MPa, without the volumetric pressure.
    pub fn cauchy_stress(&self, kinematics: &Kinematics) -> [[f64; 3]; 3] {
        let d = self.evaluate(kinematics);
        let f = &kinematics.gradient;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let b: f64 = (0..3).map(|k| f[i][k] * f[j][k]).sum();
                2.0 * d.w1 / kinematics.jacobian * b + if i == j { d.wj } else { 0.0 }
            })
        })
    }

    /// φ(x) = Σ Cᵢ₀ xⁱ and its first two derivatives, at x = Ī − 3.
    pub fn energy_of(&self, x: f64) -> [f64; 3] {
        let [c1, c2, c3] = self.coefficients;
        [x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + 3.0 * x * c3), 2.0 * c2 + 6.0 * x * c3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(invariant: Invariant) -> Yeoh {
        Yeoh::of(&Material { invariant, ..Material::default() }).unwrap()
    }

    const H: [[f64; 3]; 3] = [[0.31, -0.22, 0.15], [0.08, -0.17, 0.21], [-0.12, 0.19, 0.26]];

    fn energy(law: &Yeoh, h: &[[f64; 3]; 3]) -> f64 {
        law.evaluate(&Kinematics::new(h).unwrap()).energy
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = law(invariant);
            let stress = law.first_piola_kirchhoff_stress(&Kinematics::new(&H).unwrap());
            let largest = stress.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!(largest > 0.1, "the check would be empty");
            for i in 0..3 {
                for j in 0..3 {
                    let (mut low, mut high) = (H, H);
                    low[i][j] -= 1e-6;
                    high[i][j] += 1e-6;
                    let difference = (energy(&law, &high) - energy(&law, &low)) / 2e-6;
                    assert!((difference - stress[i][j]).abs() < 1e-8 * largest, "{invariant:?} P{i}{j}");
                }
            }
        }
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
    fn energy_does_not_change_under_rotation() {
        let (c, s) = (0.6, 0.8);
        let rotation = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let f: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| H[i][j] + if i == j { 1.0 } else { 0.0 }));
        let product = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
        };
        let displacement = |f: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - if i == j { 1.0 } else { 0.0 }))
        };
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = law(invariant);
            let reference = energy(&law, &H);
            let rotated = energy(&law, &displacement(product(&rotation, &f)));
            let turned_material = energy(&law, &displacement(product(&f, &rotation)));
            assert!((rotated - reference).abs() < 1e-13 && (turned_material - reference).abs() < 1e-13);
        }
    }

    #[test]
    fn stress_at_rest_is_zero_for_the_isochoric_invariant_and_2_c10_for_the_full_one() {
        let rest = Kinematics::new(&[[0.0; 3]; 3]).unwrap();
        for (invariant, diagonal) in [(Invariant::Isochoric, 0.0), (Invariant::Full, 2.0 * 0.2712)] {
            let stress = law(invariant).first_piola_kirchhoff_stress(&rest);
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
                    let p = law(invariant).first_piola_kirchhoff_stress(&Kinematics::new(&h).unwrap());
                    let nominal = p[0][0] - p[2][2] * l[2] / l[0];
                    assert!((nominal - value).abs() < 1e-6, "{invariant:?} {stretch}: {nominal} for {value}");
                }
            }
        }
    }
}
