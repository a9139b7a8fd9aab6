//! Drucker's condition: a law is stable at a deformation if every further strain takes more stress.
//!
//! For changes of shape alone, along the principal axes with the logarithmic strains ε₁, ε₂ and ε₃ = −ε₁ − ε₂, it is that
//!
//! ```text
//! D = Bᵀ H B,   H_ij = ∂²W/∂ε_i∂ε_j = λ_i λ_j A_iijj + δ_ij λ_i P_ii,   B = [1 0; 0 1; −1 −1]
//! ```
//!
//! is positive definite, with the principal stretches λ, the law's stress P and tangent A at F = diag(λ). A change of volume drops out of D.

use crate::hyperelastic::Hyperelastic;
use crate::kinematics::Kinematics;
use pneuflex_model::Mode;

/// Largest stretch that is looked at.
pub const SEARCHED: f64 = 20.0;

/// Between two stretches that are looked at, ln λ differs by this.
const STEP: f64 = 5e-3;

/// Whether a law is stable at principal stretches. What overflows is not.
pub fn is_stable(law: &dyn Hyperelastic, stretches: [f64; 3]) -> bool {
    let mut gradient = [[0.0; 3]; 3];
    (0..3).for_each(|i| gradient[i][i] = stretches[i] - 1.0);
    let Ok(kinematics) = Kinematics::new(&gradient) else { return false };
    let response = law.respond(&kinematics);
    let second = |i: usize, j: usize| {
        let geometric = if i == j { stretches[i] * response.stress[i][i] } else { 0.0 };
        stretches[i] * stretches[j] * response.tangent[4 * i][4 * j] + geometric
    };
    let h = |i: usize, j: usize| second(i, j) - second(i, 2) - second(2, j) + second(2, 2);
    let (a, b, c) = (h(0, 0), h(1, 1), h(0, 1));
    a > 0.0 && b > 0.0 && a * b > c * c
}

/// The stretch up to which a law is stable in a test; `None` if that is beyond [`SEARCHED`].
pub fn stable_up_to(law: &dyn Hyperelastic, mode: Mode) -> Option<f64> {
    let is_stable = |log: f64| is_stable(law, mode.stretches(log.exp()));
    let steps = (SEARCHED.ln() / STEP).ceil() as usize;
    let first = (0..=steps).find(|&i| !is_stable(STEP * i as f64))?;
    let (mut good, mut bad) = (STEP * first.saturating_sub(1) as f64, STEP * first as f64);
    for _ in 0..50 {
        let middle = 0.5 * (good + bad);
        if is_stable(middle) { good = middle } else { bad = middle }
    }
    Some(good.exp())
}

impl Kinematics {
    /// Principal stretches, in no order: square roots of the eigenvalues of C = FᵀF (Smith 1961, *Communications of the ACM* 4, 168).
    pub fn principal_stretches(&self) -> [f64; 3] {
        let d = self.right_cauchy_green_minus_1();
        let mean = (d[0][0] + d[1][1] + d[2][2]) / 3.0;
        let b: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| d[i][j] - if i == j { mean } else { 0.0 }));
        let radius = (b.as_flattened().iter().map(|x| x * x).sum::<f64>() / 6.0).sqrt();
        if radius == 0.0 {
            return [(1.0 + mean).sqrt(); 3];
        }
        let determinant = b[0][0] * (b[1][1] * b[2][2] - b[1][2] * b[2][1])
            - b[0][1] * (b[1][0] * b[2][2] - b[1][2] * b[2][0])
            + b[0][2] * (b[1][0] * b[2][1] - b[1][1] * b[2][0]);
        let angle = (0.5 * determinant / radius.powi(3)).clamp(-1.0, 1.0).acos() / 3.0;
        let third = 2.0 * std::f64::consts::FRAC_PI_3;
        // Rounding may leave less than nothing of a stretch that is next to nothing.
        [0.0, 1.0, 2.0].map(|k| (1.0 + mean + 2.0 * radius * (angle + k * third).cos()).max(f64::MIN_POSITIVE).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_those_of_a_turned_diagonal() {
        let q = [[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]].map(|row: [f64; 3]| row.map(|x| x / 3.0));
        for wanted in [[0.5, 1.0, 2.0], [1.0, 1.0, 1.0], [0.8, 0.8, 1.6], [1.0 + 1e-9, 1.0, 1.0], [7.0, 0.4, 0.36]] {
            // F = R U with R = q and U along other axes.
            let turned: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).map(|k| q[(i + 1) % 3][k] * wanted[k] * q[j][k]).sum())
            });
            let sign = if Kinematics::new(&minus_one(&turned)).is_ok() { 1.0 } else { -1.0 };
            let found =
                Kinematics::new(&minus_one(&turned.map(|row| row.map(|x| sign * x)))).unwrap().principal_stretches();
            let sorted = |mut x: [f64; 3]| {
                x.sort_by(f64::total_cmp);
                x
            };
            for (a, b) in sorted(found).into_iter().zip(sorted(wanted)) {
                assert!((a - b).abs() < 1e-7, "{found:?} for {wanted:?}");
            }
        }
    }

    fn minus_one(f: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - if i == j { 1.0 } else { 0.0 }))
    }
}
