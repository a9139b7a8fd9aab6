//! Where a law is stable in Drucker's sense.
//!
//! Incompressible, with a free face: along the principal axes the true stress is σ_α = ∂W/∂ε_α with the logarithmic strains
//! ε₁, ε₂ and ε₃ = −ε₁ − ε₂. Drucker's condition dσ : dε > 0 for every increment is that the matrix
//!
//! ```text
//! D = W₁ A₁ + W₂ A₂ + W₁₁ g gᵀ,   A₁ = ∇²I₁,  A₂ = ∇²I₂,  g = ∇I₁   (derivatives by ε₁, ε₂)
//! ```
//!
//! is positive definite. A₁ and A₂ always are. For laws of I₁ alone that is `W₁ > 0` and `W₁ + q W₁₁ > 0` with
//! `q = gᵀ A₁⁻¹ g = I₁ − 9 / I₂`; for Mooney-Rivlin it is `C₁₀ + m C₀₁ > 0` for both eigenvalues m of A₂ against A₁. Either
//! way the conditions are linear in the constants, which [`conditions`] returns.

use pneuflex_laws::law_of;

use crate::law::{Law, Mode};

/// Smallest and largest stretch that is looked at.
pub const SEARCHED: [f64; 2] = [0.05, 20.0];

/// Between two stretches that are looked at, ln λ differs by this.
const STEP: f64 = 1e-3;

/// The stretches around 1 for which a law is stable in a test.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct StableRange {
    /// The test.
    pub mode: Mode,
    /// Lower end; `None` if it is below the smallest stretch that is looked at ([`SEARCHED`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// Upper end; `None` if it is beyond the largest stretch that is looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
}

/// Linear forms in the constants that are all positive exactly where the law is stable; for Ogden's, only if it is.
pub fn conditions(law: Law, stretches: [f64; 3]) -> Vec<Vec<f64>> {
    let [a, b, c] = stretches.map(|l| l * l);
    match law {
        Law::NeoHookean => vec![vec![1.0]],
        // Stable as far as it goes.
        Law::Gent(jm) => vec![vec![if a + b + c - 3.0 < jm { 1.0 } else { -1.0 }]],
        // Enough for stability, and with one term needed: every term with a positive modulus is stable.
        Law::Ogden(_) => {
            let terms = law.constants().len();
            (0..terms).map(|i| (0..terms).map(|j| f64::from(i == j)).collect()).collect()
        }
        Law::Yeoh | Law::YeohOfTwoTerms => {
            let x = a + b + c - 3.0;
            let q = x + 3.0 - 9.0 / (a * b + b * c + c * a);
            let all = [[1.0, 2.0 * x, 3.0 * x * x], [1.0, 2.0 * (x + q), 3.0 * x * (x + 2.0 * q)]];
            all.map(|form| form[..law.constants().len()].to_vec()).into()
        }
        Law::MooneyRivlin => {
            // ∇²I₁ = 4 [[a + c, c], [c, b + c]], ∇²I₂ the same with the reciprocals.
            let [ra, rb, rc] = [a, b, c].map(f64::recip);
            let det_1 = a * b + b * c + c * a;
            let det_2 = ra * rb + rb * rc + rc * ra;
            let mixed = (a + c) * (rb + rc) + (b + c) * (ra + rc) - 2.0 * c * rc;
            let half = 0.5 * mixed / det_1;
            let root = (half * half - det_2 / det_1).max(0.0).sqrt();
            let large = half + root;
            // The product of both is det_2 / det_1.
            vec![vec![1.0, large], vec![1.0, det_2 / det_1 / large]]
        }
    }
}

/// The smallest of the conditions' values: positive where the law is stable, MPa.
pub fn margin(law: Law, constants: &[f64], stretches: [f64; 3]) -> f64 {
    let value = |form: Vec<f64>| form.iter().zip(constants).map(|(f, c)| f * c).sum::<f64>();
    conditions(law, stretches).into_iter().map(value).fold(f64::INFINITY, f64::min)
}

/// The stable stretches around rest; `None` if the law is not even stable at rest.
pub fn stable_range(law: Law, constants: &[f64], mode: Mode) -> Option<StableRange> {
    let is_stable = |log: f64| margin(law, constants, mode.stretches(log.exp())) > 0.0;
    if !is_stable(0.0) {
        return None;
    }
    let end = |limit: f64| {
        let limit = limit.ln();
        let steps = (limit.abs() / STEP).ceil();
        let at = |i: f64| limit * i / steps;
        let first = (1..=steps as usize).map(|i| i as f64).find(|&i| !is_stable(at(i)))?;
        let (mut good, mut bad) = (at(first - 1.0), at(first));
        for _ in 0..60 {
            let middle = 0.5 * (good + bad);
            if is_stable(middle) { good = middle } else { bad = middle }
        }
        Some(good.exp())
    };
    Some(StableRange { mode, low: end(SEARCHED[0]), high: end(SEARCHED[1]) })
}

/// The I₁ − 3 at which the slope of the energy vanishes, as the solver itself finds it; `None` if it never does.
pub fn zero_slope(law: Law, constants: &[f64]) -> Option<f64> {
    law_of(&law.with_constants(constants).into()).limit()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∇²W by (ε₁, ε₂) from differences of the energy itself.
    fn hessian(energy: &dyn Fn([f64; 3]) -> f64, stretches: [f64; 3]) -> [f64; 3] {
        let at = |d1: f64, d2: f64| {
            energy([stretches[0] * d1.exp(), stretches[1] * d2.exp(), stretches[2] * (-d1 - d2).exp()])
        };
        let h = 1e-3;
        let second = |f: &dyn Fn(f64) -> f64| (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h);
        let d11 = second(&|d| at(d, 0.0));
        let d22 = second(&|d| at(0.0, d));
        let d12 = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4.0 * h * h);
        [d11, d22, d12]
    }

    #[test]
    fn the_sign_is_that_of_the_hessian_of_the_energy() {
        let laws: [(Law, &[f64]); 4] = [
            (Law::Yeoh, &[0.2712, 0.03053, -0.0004013]),
            (Law::Yeoh, &[0.2, -0.03, 0.002]),
            (Law::MooneyRivlin, &[0.2, -0.03]),
            (Law::MooneyRivlin, &[-0.02, 0.1]),
        ];
        let (mut stable, mut unstable) = (0, 0);
        for (law, c) in laws {
            let energy = |l: [f64; 3]| {
                let i1: f64 = l.iter().map(|x| x * x).sum::<f64>() - 3.0;
                let i2: f64 = l.iter().map(|x| x.powi(-2)).sum::<f64>() - 3.0;
                match law {
                    Law::MooneyRivlin => c[0] * i1 + c[1] * i2,
                    _ => i1 * (c[0] + i1 * (c[1] + i1 * c[2])),
                }
            };
            for (l1, l2) in
                [(1.1, 1.0), (1.5, 1.2), (2.0, 0.7), (4.0, 0.5), (0.4, 1.6), (2.5, 2.5), (6.0, 0.4), (1.0, 3.0)]
            {
                let stretches = [l1, l2, 1.0 / (l1 * l2)];
                let [d11, d22, d12] = hessian(&energy, stretches);
                let smallest = 0.5 * (d11 + d22) - (0.25 * (d11 - d22).powi(2) + d12 * d12).sqrt();
                let found = margin(law, c, stretches);
                assert_eq!(found > 0.0, smallest > 0.0, "{law:?} {stretches:?}: {found} {smallest}");
                if found > 0.0 { stable += 1 } else { unstable += 1 }
            }
        }
        assert!(stable > 5 && unstable > 5, "{stable} {unstable}");
    }

    #[test]
    fn neo_hookean_and_convex_laws_are_always_stable() {
        for mode in Mode::ALL {
            let all = Some(StableRange { mode, low: None, high: None });
            assert_eq!(stable_range(Law::NeoHookean, &[0.3], mode), all);
            assert_eq!(stable_range(Law::Yeoh, &[0.3, 0.01, 0.001], mode), all);
            assert_eq!(stable_range(Law::MooneyRivlin, &[0.3, 0.1], mode), all);
            assert_eq!(stable_range(Law::NeoHookean, &[-0.3], mode), None);
        }
    }

    #[test]
    fn mooney_rivlin_ends_where_the_closed_form_says() {
        // Uniaxial, increments across the load: C₁₀/λ + C₀₁ λ = 0 at λ = √(−C₁₀/C₀₁).
        let range = stable_range(Law::MooneyRivlin, &[0.4, -0.1], Mode::Uniaxial).unwrap();
        assert!((range.high.unwrap() - 2.0).abs() < 1e-12, "{range:?}");
    }

    #[test]
    fn a_yeoh_law_of_two_constants_ends_at_the_root_of_its_cubic() {
        // Planar: q = x (x + 6) / (x + 3), x = I₁ − 3; C₁₀ + 2 C₂₀ (x + q) = 0 with C₁₀ / (2 C₂₀) = −6.5 is a quadratic.
        let range = stable_range(Law::Yeoh, &[1.3, -0.1, 0.0], Mode::Planar).unwrap();
        // x + x (x + 6)/(x + 3) = 6.5: 2x² + 2.5x − 19.5 = 0, x = 2.559…
        let x = (-2.5 + (2.5_f64 * 2.5 + 8.0 * 19.5).sqrt()) / 4.0;
        assert!((Mode::Planar.i1_minus_3(range.high.unwrap()) - x).abs() < 1e-10);
        // Shear the other way is the same test.
        assert!((range.low.unwrap() * range.high.unwrap() - 1.0).abs() < 1e-10);
    }

    #[test]
    fn the_slope_is_the_solvers() {
        let limit = zero_slope(Law::Yeoh, &[0.2712, 0.03053, -0.0004013]).unwrap();
        assert!((limit - 54.83).abs() < 5e-3);
        assert_eq!(zero_slope(Law::NeoHookean, &[0.2]), None);
    }
}
