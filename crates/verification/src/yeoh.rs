//! The Yeoh law once more, for exact solutions: written down from theory §3, apart from the solver's.

use pneuflex_mesh::quadrature::gauss_legendre;
use pneuflex_model::{Invariant, Material};

/// C₁₀, C₂₀, C₃₀, MPa; not numbers for a law that has no such constants.
fn constants(m: &Material) -> [f64; 3] {
    m.law.reduced_polynomial().unwrap_or([f64::NAN; 3])
}

/// dW/dI₁ of the incompressible law, MPa, at e = I₁ − 3.
pub fn slope(m: &Material, e: f64) -> f64 {
    let [c10, c20, c30] = constants(m);
    c10 + 2.0 * c20 * e + 3.0 * c30 * e * e
}

/// ∫ f over [a, b] by composite Gauss rules, good to rounding for smooth functions.
pub fn integrate(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PANELS: usize = 20;
    let width = (b - a) / PANELS as f64;
    let rule = gauss_legendre(5);
    (0..PANELS)
        .flat_map(|panel| {
            rule.iter().map(move |&(x, w)| (a + width * (panel as f64 + 0.5 * (1.0 + x)), 0.5 * w * width))
        })
        .map(|(x, w)| w * f(x))
        .sum()
}

/// The root of an increasing function between `low` and `high`, by bisection down to neighbouring numbers.
pub fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
}

/// First Piola–Kirchhoff stress, MPa; `[i][j]` belongs to ∂rᵢ/∂Xⱼ:
/// P = 2φ′(Ī₁) J^(−2/3) (F − ⅓ I₁ F⁻ᵀ) + κ (J − 1) cof F, with the full invariant 2φ′(I₁) F + κ (J − 1) cof F.
pub fn first_piola_kirchhoff(m: &Material, f: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        f[a][c] * f[b][d] - f[a][d] * f[b][c]
    };
    let j: f64 = (0..3).map(|k| f[0][k] * minor(0, k)).sum();
    let i1: f64 = f.as_flattened().iter().map(|x| x * x).sum();
    let (scale, along_inverse) = match m.invariant {
        Invariant::Full => (1.0, 0.0),
        Invariant::Isochoric => (j.powf(-2.0 / 3.0), i1 / 3.0),
    };
    let factor = 2.0 * slope(m, scale * i1 - 3.0) * scale;
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let cofactor = minor(a, b);
            factor * (f[a][b] - along_inverse * cofactor / j) + m.bulk_modulus * (j - 1.0) * cofactor
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::material;

    #[test]
    fn integrals_and_roots() {
        assert!((integrate(0.0, 2.0, f64::exp) - (2.0_f64.exp() - 1.0)).abs() < 1e-13);
        assert!((root(0.0, 2.0, |x| x * x - 2.0) - 2.0_f64.sqrt()).abs() < 1e-15);
    }

    /// P:δF is the change of the energy φ(Ī₁) + ½ κ (J − 1)².
    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        let f = [[1.2, 0.1, -0.05], [0.03, 0.9, 0.2], [-0.1, 0.07, 1.1]];
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let m = Material { invariant, ..material(7.0) };
            let [c10, c20, c30] = constants(&m);
            let energy = |f: &[[f64; 3]; 3]| {
                let j = pneuflex_mesh::mesh::determinant(f);
                let i1: f64 = f.as_flattened().iter().map(|x| x * x).sum();
                let e = if invariant == Invariant::Full { i1 } else { i1 * j.powf(-2.0 / 3.0) } - 3.0;
                c10 * e + c20 * e * e + c30 * e.powi(3) + 0.5 * m.bulk_modulus * (j - 1.0) * (j - 1.0)
            };
            let p = first_piola_kirchhoff(&m, &f);
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let moved = |by: f64| {
                    let mut g = f;
                    g[i][j] += by;
                    energy(&g)
                };
                assert!(((moved(1e-6) - moved(-1e-6)) / 2e-6 - p[i][j]).abs() < 1e-8);
            }
        }
    }
}
