//! Ogden's hyperelasticity (Ogden 1972, *Proc. R. Soc. Lond. A* 326) in Abaqus's constants:
//!
//! ```text
//! W = Σ_p 2 μ_p/α_p² (λ̄₁^α_p + λ̄₂^α_p + λ̄₃^α_p − 3),   λ̄ᵢ = J^(−1/3) λᵢ
//! ```
//!
//! In the logarithms eᵢ = ln λᵢ, with ēᵢ = eᵢ − ⅓ Σ e, xᵢ = exp(α ēᵢ) and their mean m, the principal Kirchhoff stresses
//! and their derivatives are
//!
//! ```text
//! tᵢ  = ∂W/∂eᵢ  = Σ_p 2 μ/α (xᵢ − m)
//! Tᵢⱼ = ∂tᵢ/∂eⱼ = Σ_p 2 μ (xᵢ δᵢⱼ − xᵢ/3 − xⱼ/3 + m/3)
//! ```
//!
//! With the eigenvectors Nₐ of C, nₐ = F Nₐ and S = Σ tₐ/λₐ² Nₐ Nₐᵀ (Simo & Taylor 1991, *Comput. Methods Appl. Mech. Engrg.* 85),
//!
//! ```text
//! P = F S,   ∂P/∂F = 1 ⊗ S + Σₐᵦ (Tₐᵦ − 2 tₐ δₐᵦ)/(λₐ² λᵦ²) dₐ dᵦᵀ + Σ_{a<b} gₐᵦ hₐᵦ hₐᵦᵀ
//! dₐ = nₐ Nₐᵀ,   hₐᵦ = nₐ Nᵦᵀ + nᵦ Nₐᵀ,   gₐᵦ = (tₐ/λₐ² − tᵦ/λᵦ²) / (λₐ² − λᵦ²)
//! ```
//!
//! # Equal stretches
//!
//! The divided difference g has a form without cancellation. With δ = eₐ − eᵦ and t_m = ½ (tₐ + tᵦ),
//!
//! ```text
//! gₐᵦ = [cosh δ Σ_p 2 μ exp(α (ēₐ + ēᵦ)/2) sinh(αδ/2)/(α sinh δ) − t_m] / (λₐ² λᵦ²)
//! ```
//!
//! whose quotient of sines is smooth and even in δ, ½ at δ = 0. So equal stretches need no case of their own, and any eigenvectors
//! of theirs do.

mod eigen;

use pneuflex_material::{Hyperelastic, Kinematics, Response, Tangent, Tensor, add_dyad};
use pneuflex_model::OgdenTerm;

/// Ogden's law without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct Ogden {
    terms: Vec<OgdenTerm>,
}

/// The deformation along its principal directions.
struct Principal {
    /// ln λ̄ᵢ.
    isochoric: [f64; 3],
    /// λᵢ².
    squares: [f64; 3],
    /// Nₐ, one per row.
    directions: [[f64; 3]; 3],
}

impl Principal {
    fn new(kinematics: &Kinematics) -> Self {
        // The eigenvalues of C − 1 keep the digits of small strains.
        let (values, directions) = eigen::symmetric(&kinematics.right_cauchy_green_minus_1());
        let logarithms = values.map(|d| 0.5 * d.ln_1p());
        let mean = (logarithms[0] + logarithms[1] + logarithms[2]) / 3.0;
        Self { isochoric: logarithms.map(|e| e - mean), squares: values.map(|d| 1.0 + d), directions }
    }
}

impl Ogden {
    /// The law of up to three terms. The shear modulus at rest is Σ μ.
    pub fn new(terms: &[OgdenTerm]) -> Self {
        Self { terms: terms.to_vec() }
    }

    fn energy(&self, principal: &Principal) -> f64 {
        let energy = |term: &OgdenTerm| {
            let sum: f64 = principal.isochoric.iter().map(|e| (term.alpha * e).exp_m1()).sum();
            2.0 * term.mu / (term.alpha * term.alpha) * sum
        };
        self.terms.iter().map(energy).sum()
    }

    /// tᵢ.
    fn kirchhoff_stresses(&self, principal: &Principal) -> [f64; 3] {
        let mut t = [0.0; 3];
        for OgdenTerm { mu, alpha } in &self.terms {
            let x = principal.isochoric.map(|e| (alpha * e).exp_m1());
            let mean = (x[0] + x[1] + x[2]) / 3.0;
            for i in 0..3 {
                t[i] += 2.0 * mu / alpha * (x[i] - mean);
            }
        }
        t
    }

    /// Tᵢⱼ.
    fn kirchhoff_moduli(&self, principal: &Principal) -> Tensor {
        let mut moduli = [[0.0; 3]; 3];
        for OgdenTerm { mu, alpha } in &self.terms {
            let x = principal.isochoric.map(|e| (alpha * e).exp());
            let mean = (x[0] + x[1] + x[2]) / 3.0;
            for i in 0..3 {
                for j in 0..3 {
                    let own = if i == j { x[i] } else { 0.0 };
                    moduli[i][j] += 2.0 * mu * (own - (x[i] + x[j] - mean) / 3.0);
                }
            }
        }
        moduli
    }

    /// λₐ² λᵦ² gₐᵦ.
    fn shear_modulus(&self, principal: &Principal, t: &[f64; 3], a: usize, b: usize) -> f64 {
        let [one, other] = [principal.isochoric[a], principal.isochoric[b]];
        let apart = one - other;
        let quotient = |alpha: f64| {
            if apart == 0.0 { 0.5 } else { (0.5 * alpha * apart).sinh() / (alpha * apart.sinh()) }
        };
        let difference: f64 = self
            .terms
            .iter()
            .map(|&OgdenTerm { mu, alpha }| 2.0 * mu * (0.5 * alpha * (one + other)).exp() * quotient(alpha))
            .sum();
        apart.cosh() * difference - 0.5 * (t[a] + t[b])
    }
}

/// P = Σ tₐ/λₐ² nₐ Nₐᵀ.
fn stress(t: &[f64; 3], principal: &Principal, images: &[[f64; 3]; 3]) -> Tensor {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..3).map(|a| t[a] / principal.squares[a] * images[a][i] * principal.directions[a][j]).sum()
        })
    })
}

/// nₐ = F Nₐ.
fn images(kinematics: &Kinematics, principal: &Principal) -> [[f64; 3]; 3] {
    let f = &kinematics.gradient;
    principal.directions.map(|n| std::array::from_fn(|i| (0..3).map(|j| f[i][j] * n[j]).sum()))
}

fn dyad(a: &[f64; 3], b: &[f64; 3]) -> Tensor {
    a.map(|x| b.map(|y| x * y))
}

impl Hyperelastic for Ogden {
    fn respond(&self, kinematics: &Kinematics) -> Response {
        let principal = Principal::new(kinematics);
        let (t, moduli) = (self.kirchhoff_stresses(&principal), self.kirchhoff_moduli(&principal));
        let (n, images, squares) = (&principal.directions, images(kinematics, &principal), &principal.squares);
        let mut tangent: Tangent = [[0.0; 9]; 9];
        for a in 0..3 {
            let own = dyad(&images[a], &n[a]);
            for b in 0..3 {
                let twice = if a == b { 2.0 * t[a] } else { 0.0 };
                let factor = (moduli[a][b] - twice) / (squares[a] * squares[b]);
                add_dyad(&mut tangent, factor, &own, &dyad(&images[b], &n[b]));
            }
            for b in 0..a {
                let (one, other) = (dyad(&images[a], &n[b]), dyad(&images[b], &n[a]));
                let sum = std::array::from_fn(|i| std::array::from_fn(|j| one[i][j] + other[i][j]));
                let factor = self.shear_modulus(&principal, &t, a, b) / (squares[a] * squares[b]);
                add_dyad(&mut tangent, factor, &sum, &sum);
            }
            // 1 ⊗ S.
            for (j, l) in (0..9).map(|k| (k / 3, k % 3)) {
                let s = t[a] / squares[a] * n[a][j] * n[a][l];
                for i in 0..3 {
                    tangent[3 * i + j][3 * i + l] += s;
                }
            }
        }
        Response { energy: self.energy(&principal), stress: stress(&t, &principal, &images), tangent }
    }

    fn energy_and_stress(&self, kinematics: &Kinematics) -> (f64, Tensor) {
        let principal = Principal::new(kinematics);
        let t = self.kirchhoff_stresses(&principal);
        (self.energy(&principal), stress(&t, &principal, &images(kinematics, &principal)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};

    fn ogden(terms: &[(f64, f64)]) -> Ogden {
        Ogden::new(&terms.iter().map(|&(mu, alpha)| OgdenTerm { mu, alpha }).collect::<Vec<_>>())
    }

    #[test]
    fn it_passes_the_battery() {
        // The last is Treloar's rubber (Ogden 1972) in these constants: μ α/2 of 0.63, 0.0012, −0.01 MPa and 1.3, 5, −2.
        let treloar = [(0.4095, 1.3), (0.003, 5.0), (0.01, -2.0)];
        for terms in [&[(0.5, 2.0)][..], &[(0.6, 3.4), (-0.1, -1.7)], &treloar] {
            let law = ogden(terms);
            battery::check_isotropic(&law, 0.3);
            battery::check_isochoric(&law, terms.iter().map(|(mu, _)| mu).sum());
            battery::check_homogeneous(&law, |mode, l| {
                let exponent = match mode {
                    Mode::Uniaxial => -0.5,
                    Mode::Equibiaxial => -2.0,
                    Mode::Planar => -1.0,
                };
                terms.iter().map(|&(mu, a)| 2.0 * mu / a * (l.powf(a) - l.powf(exponent * a)) / l).sum()
            });
        }
    }

    /// Exponents 2 and −2 are Mooney–Rivlin: μ₁ = 2 C₁₀ and μ₂ = 2 C₀₁.
    #[test]
    fn exponents_of_two_are_the_invariants() {
        let law = ogden(&[(0.4, 2.0), (0.14, -2.0)]);
        let h = [[0.31, -0.22, 0.15], [0.08, -0.17, 0.21], [-0.12, 0.19, 0.26]];
        let k = Kinematics::new(&h).unwrap();
        let (i1, i2) = (k.i1_minus_3 + 3.0, k.i2_minus_3() + 3.0);
        let exact = 0.2 * (i1 * k.jacobian.powf(-2.0 / 3.0) - 3.0) + 0.07 * (i2 * k.jacobian.powf(-4.0 / 3.0) - 3.0);
        assert!((law.respond(&k).energy - exact).abs() < 1e-15);
    }
}
