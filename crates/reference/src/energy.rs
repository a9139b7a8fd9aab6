//! Energies of a deformation gradient (theory §3 for Yeoh's).

use nalgebra::{SMatrix, SVector};
use pneuflex_model::{Invariant, Law, Material, OgdenTerm, Volumetric};

use crate::differentiate::{Dual, Energy, cross, dot, gradient_of, hessian_of};
use crate::error::{ReferenceError, Unmodelled};
use crate::tensor_function::{exponential, logarithm, product, trace};

/// Refuses a material whose energy is another one than [`energy_density`]; `name` says whose it is.
///
/// # Errors
/// [`Unmodelled::FullInvariant`].
pub fn check(name: &str, material: &Material) -> Result<(), ReferenceError> {
    // Weights are loads.
    let Material { law, bulk_modulus: _, volumetric: _, invariant, density: _, fitted_to: _ } = material;
    match (law, invariant) {
        (Law::Yeoh { .. } | Law::NeoHooke { .. }, _) | (_, Invariant::Isochoric) => Ok(()),
        (Law::Polynomial { .. } | Law::Ogden { .. } | Law::Gent { .. }, Invariant::Full) => {
            Err(ReferenceError::NotModelled { part: Unmodelled::FullInvariant, name: name.into() })
        }
    }
}

/// J = det G = r_x · (r_y × r_z); `g[i][j]` is ∂rᵢ/∂Xⱼ.
pub fn jacobian<D: Dual>(g: &[[D; 3]; 3]) -> D {
    let column = |j: usize| [g[0][j], g[1][j], g[2][j]];
    dot(column(0), cross(column(1), column(2)))
}

/// The material's energy of a change of shape per reference volume, MPa; see [`Law`] for the formulas.
pub fn deviatoric<D: Dual>(material: &Material, g: &[[D; 3]; 3]) -> D {
    let scale = jacobian(g).powf(-2.0 / 3.0);
    let i1 = g.iter().map(|row| dot(*row, *row)).fold(D::from(0.0), |sum, x| sum + x);
    match &material.law {
        Law::Yeoh { .. } | Law::NeoHooke { .. } => {
            let [c10, c20, c30] = material.law.reduced_polynomial().unwrap_or_default();
            let e = match material.invariant {
                Invariant::Full => i1,
                Invariant::Isochoric => scale * i1,
            } - 3.0;
            e * c10 + e * e * c20 + e * e * e * c30
        }
        Law::Polynomial { c10, c01, c20, c11, c02 } => {
            let c = right_cauchy_green(g);
            let i2 = (i1 * i1 - trace(&product(&c, &c))) * 0.5;
            let (x, y) = (scale * i1 - 3.0, scale * scale * i2 - 3.0);
            x * *c10 + y * *c01 + x * x * *c20 + x * y * *c11 + y * y * *c02
        }
        Law::Gent { shear_modulus, jm } => {
            let left = (scale * i1 - 3.0) * (-1.0 / jm) + 1.0;
            left.ln() * (-0.5 * shear_modulus * jm)
        }
        // λ̄₁^α + λ̄₂^α + λ̄₃^α = tr exp(α/2 ln C̄).
        Law::Ogden { terms } => {
            let logarithm = logarithm(&right_cauchy_green(g));
            let mean = trace(&logarithm) / 3.0;
            let sum_of_powers = |alpha: f64| {
                let bar = |i: usize, j: usize| if i == j { logarithm[i][j] - mean } else { logarithm[i][j] };
                trace(&exponential(&std::array::from_fn(|i| std::array::from_fn(|j| bar(i, j) * (0.5 * alpha)))))
            };
            let energy = |term: &OgdenTerm| (sum_of_powers(term.alpha) - 3.0) * (2.0 * term.mu / term.alpha.powi(2));
            terms.iter().map(energy).fold(D::from(0.0), |sum, x| sum + x)
        }
    }
}

fn right_cauchy_green<D: Dual>(g: &[[D; 3]; 3]) -> [[D; 3]; 3] {
    let column = |j: usize| [g[0][j], g[1][j], g[2][j]];
    std::array::from_fn(|i| std::array::from_fn(|j| dot(column(i), column(j))))
}

/// The energy of a change of volume per reference volume over κ, at J − 1.
pub fn volumetric<D: Dual>(form: Volumetric, dilatation: D) -> D {
    match form {
        Volumetric::Quadratic => dilatation * dilatation * 0.5,
        Volumetric::Logarithmic => {
            let logarithm = (dilatation + 1.0).ln();
            logarithm * logarithm * 0.5
        }
    }
}

/// The whole energy per reference volume, MPa: [`deviatoric`] + κ [`volumetric`].
pub fn energy_density<D: Dual>(material: &Material, g: &[[D; 3]; 3]) -> D {
    let dilatation = jacobian(g) - 1.0;
    deviatoric(material, g) + volumetric(material.volumetric, dilatation) * material.bulk_modulus
}

/// First Piola–Kirchhoff stress P = ∂W/∂G of [`energy_density`], MPa; `[i][j]` belongs to ∂rᵢ/∂Xⱼ.
pub fn first_piola_kirchhoff(material: &Material, g: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let (_, p) = gradient_of(&Density(material), &flatten(g));
    std::array::from_fn(|i| std::array::from_fn(|j| p[3 * i + j]))
}

/// ∂P/∂G of [`energy_density`], MPa; row and column 3i + j belong to ∂rᵢ/∂Xⱼ.
pub fn tangent(material: &Material, g: &[[f64; 3]; 3]) -> SMatrix<f64, 9, 9> {
    hessian_of(&Density(material), &flatten(g)).2
}

struct Density<'a>(&'a Material);

impl Energy<9> for Density<'_> {
    fn energy<D: Dual>(&self, v: &[D; 9]) -> D {
        energy_density(self.0, &gradient_from(v))
    }
}

/// The first nine entries of `v` as a deformation gradient, row by row.
pub fn gradient_from<D: Dual>(v: &[D]) -> [[D; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| v[3 * i + j]))
}

fn flatten(g: &[[f64; 3]; 3]) -> SVector<f64, 9> {
    SVector::from_fn(|k, _| g[k / 3][k % 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEFORMED: [[f64; 3]; 3] = [[1.2, 0.1, -0.05], [0.03, 0.9, 0.2], [-0.1, 0.07, 1.1]];

    fn material(invariant: Invariant) -> Material {
        Material { bulk_modulus: 7.0, invariant, ..Material::default() }
    }

    /// The formulas of theory §3, by hand.
    #[test]
    fn stress_is_the_one_written_in_the_theory() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let m = material(invariant);
            let g = nalgebra::Matrix3::from_fn(|i, j| DEFORMED[i][j]);
            let (j, i1) = (g.determinant(), g.norm_squared());
            let inverse_transpose = g.try_inverse().unwrap().transpose();
            let scale = if invariant == Invariant::Full { 1.0 } else { j.powf(-2.0 / 3.0) };
            let e = scale * i1 - 3.0;
            let [c10, c20, c30] = m.law.reduced_polynomial().unwrap();
            let slope = c10 + 2.0 * c20 * e + 3.0 * c30 * e * e;
            let direction = if invariant == Invariant::Full { g } else { g - inverse_transpose * (i1 / 3.0) };
            let expected = direction * (2.0 * slope * scale) + inverse_transpose * (m.bulk_modulus * (j - 1.0) * j);
            let found = first_piola_kirchhoff(&m, &DEFORMED);
            for a in 0..3 {
                for b in 0..3 {
                    assert!((found[a][b] - expected[(a, b)]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn the_full_invariant_is_refused_where_the_law_has_none() {
        let ogden = Law::Ogden { terms: vec![OgdenTerm { mu: 0.5, alpha: 3.4 }] };
        let polynomial = Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.0, c11: 0.0, c02: 0.0 };
        let with = |law: &Law, invariant| Material { invariant, ..law.clone().into() };
        for law in [ogden, polynomial] {
            assert_eq!(check("base", &with(&law, Invariant::Isochoric)), Ok(()));
            let part = Unmodelled::FullInvariant;
            let expected = Err(ReferenceError::NotModelled { part, name: "base".into() });
            assert_eq!(check("base", &with(&law, Invariant::Full)), expected);
        }
        assert_eq!(check("base", &material(Invariant::Full)), Ok(()));
    }

    /// Exponents 2 and −2 of Ogden's law are Mooney–Rivlin, also where stretches are equal.
    #[test]
    fn ogden_contains_mooney_rivlin() {
        let term = |mu: f64, alpha: f64| OgdenTerm { mu, alpha };
        let ogden: Material = Law::Ogden { terms: vec![term(0.4, 2.0), term(0.14, -2.0)] }.into();
        let law = Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.0, c11: 0.0, c02: 0.0 };
        let mooney_rivlin = Material { bulk_modulus: ogden.bulk_modulus, ..law.into() };
        for g in [
            DEFORMED,
            [[1.3, 0.0, 0.0], [0.0, 1.3, 0.0], [0.0, 0.0, 0.6]],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ] {
            let [a, b] = [&ogden, &mooney_rivlin].map(|m| tangent(m, &g));
            assert!((a - b).norm() < 1e-12 * b.norm(), "{:.1e}", (a - b).norm());
            let [p, q] = [&ogden, &mooney_rivlin].map(|m| first_piola_kirchhoff(m, &g));
            let apart = p.as_flattened().iter().zip(q.as_flattened()).fold(0.0_f64, |d, (p, q)| d.max((p - q).abs()));
            assert!(apart < 1e-12, "{apart:.1e}");
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_stress() {
        let ogden = Law::Ogden { terms: vec![OgdenTerm { mu: 0.5, alpha: 3.4 }] };
        let polynomial = Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.03, c11: -0.01, c02: 0.004 };
        let soft = |law: Law| Material { bulk_modulus: 7.0, volumetric: Volumetric::Logarithmic, ..law.into() };
        for m in [material(Invariant::Full), material(Invariant::Isochoric), soft(polynomial), soft(ogden)] {
            let h = 1e-6;
            let exact = tangent(&m, &DEFORMED);
            assert!(exact.norm() > 1.0);
            for k in 0..9 {
                let (mut low, mut high) = (DEFORMED, DEFORMED);
                low[k / 3][k % 3] -= h;
                high[k / 3][k % 3] += h;
                let (low, high) = (first_piola_kirchhoff(&m, &low), first_piola_kirchhoff(&m, &high));
                for r in 0..9 {
                    let slope = (high[r / 3][r % 3] - low[r / 3][r % 3]) / (2.0 * h);
                    assert!((exact[(r, k)] - slope).abs() < 1e-7);
                }
            }
        }
    }
}
