//! The Yeoh energy of a deformation gradient (theory §3).

use nalgebra::{SMatrix, SVector};
use pneuflex_model::{Invariant, Material};

use crate::differentiate::{Dual, Energy, cross, dot, gradient_of, hessian_of};

/// J = det G = r_x · (r_y × r_z); `g[i][j]` is ∂rᵢ/∂Xⱼ.
pub fn jacobian<D: Dual>(g: &[[D; 3]; 3]) -> D {
    let column = |j: usize| [g[0][j], g[1][j], g[2][j]];
    dot(column(0), cross(column(1), column(2)))
}

/// C₁₀, C₂₀, C₃₀, MPa; not numbers for a law that has no such constants.
pub fn constants(material: &Material) -> [f64; 3] {
    material.law.reduced_polynomial().unwrap_or([f64::NAN; 3])
}

/// Σ Cᵢ₀ (I − 3)ⁱ, MPa, with I = I₁ = tr(GᵀG) or I = J^(−2/3) I₁, as the material asks.
pub fn deviatoric<D: Dual>(material: &Material, g: &[[D; 3]; 3]) -> D {
    let i1 = g.iter().map(|row| dot(*row, *row)).fold(D::from(0.0), |sum, x| sum + x);
    let invariant = match material.invariant {
        Invariant::Full => i1,
        Invariant::Isochoric => jacobian(g).powf(-2.0 / 3.0) * i1,
    };
    let e = invariant - 3.0;
    let [c10, c20, c30] = constants(material);
    e * c10 + e * e * c20 + e * e * e * c30
}

/// The whole energy per reference volume, MPa: [`deviatoric`] + ½ κ (J − 1)².
pub fn energy_density<D: Dual>(material: &Material, g: &[[D; 3]; 3]) -> D {
    let dilatation = jacobian(g) - 1.0;
    deviatoric(material, g) + dilatation * dilatation * (0.5 * material.bulk_modulus)
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
            let [c10, c20, c30] = constants(&m);
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
    fn tangent_is_the_derivative_of_the_stress() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let (m, h) = (material(invariant), 1e-6);
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
