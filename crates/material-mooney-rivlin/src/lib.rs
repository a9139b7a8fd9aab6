//! Mooney–Rivlin hyperelasticity and its extension to second order (Mooney 1940, *J. Appl. Phys.* 11; Rivlin & Saunders 1951,
//! *Phil. Trans. R. Soc. A* 243):
//!
//! ```text
//! W = C₁₀ x + C₀₁ y + C₂₀ x² + C₁₁ x y + C₀₂ y²,   x = J^(−2/3) I₁ − 3,   y = J^(−4/3) I₂ − 3
//! ```
//!
//! With F as a vector of nine entries,
//!
//! ```text
//! ∂I₁/∂F = 2F,   ∂I₂/∂F = 2 (I₁ F − F C),   ∂J/∂F = cof F
//! δF:∂²I₂/∂F²:δF = 4 (F:δF)² + 2 I₁ δF:δF − 2 (δF C + F δFᵀ F + F Fᵀ δF):δF
//! ```

use pneuflex_material::{
    Hyperelastic, Kinematics, Response, Tangent, Tensor, add_dyad, add_scaled, second_derivative_of_jacobian,
};

/// A polynomial of order 2 in the isochoric invariants, without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct MooneyRivlin {
    /// C₁₀, C₀₁, C₂₀, C₁₁, C₀₂, MPa.
    coefficients: [f64; 5],
}

/// An isochoric invariant less 3, and its derivatives by (invariant, J).
struct Scaled {
    minus_3: f64,
    by_invariant: f64,
    by_jacobian: f64,
    mixed: f64,
    by_jacobian_twice: f64,
}

impl Scaled {
    /// J^n I − 3.
    fn new(n: f64, invariant_minus_3: f64, kinematics: &Kinematics) -> Self {
        let j = kinematics.jacobian;
        // Keeps its digits near the undeformed state.
        let exponent = n * kinematics.jacobian_minus_1.ln_1p();
        let (s, s_minus_1) = (exponent.exp(), exponent.exp_m1());
        let minus_3 = s * invariant_minus_3 + 3.0 * s_minus_1;
        let bar = minus_3 + 3.0;
        Self {
            minus_3,
            by_invariant: s,
            by_jacobian: n * bar / j,
            mixed: n * s / j,
            by_jacobian_twice: n * (n - 1.0) * bar / (j * j),
        }
    }

    /// The invariant's derivative by F, with that of the unscaled one given.
    fn gradient(&self, unscaled: &Tensor, cofactor: &Tensor) -> Tensor {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| self.by_invariant * unscaled[i][j] + self.by_jacobian * cofactor[i][j])
        })
    }

    /// Adds the second derivative by F, but for the parts of ∂²I/∂F² and ∂²J/∂F².
    fn add_curvature(&self, tangent: &mut Tangent, factor: f64, unscaled: &Tensor, cofactor: &Tensor) {
        add_dyad(tangent, factor * self.mixed, unscaled, cofactor);
        add_dyad(tangent, factor * self.mixed, cofactor, unscaled);
        add_dyad(tangent, factor * self.by_jacobian_twice, cofactor, cofactor);
    }
}

/// The two invariants and what their derivatives are made of.
struct State {
    x: Scaled,
    y: Scaled,
    /// ∂I₁/∂F, ∂I₂/∂F.
    by_gradient: [Tensor; 2],
    /// C = FᵀF.
    right_cauchy_green: Tensor,
}

impl State {
    fn new(kinematics: &Kinematics) -> Self {
        let f = &kinematics.gradient;
        let c: Tensor = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| f[k][i] * f[k][j]).sum()));
        let i1 = kinematics.i1_minus_3 + 3.0;
        let second = |i: usize, j: usize| 2.0 * (i1 * f[i][j] - (0..3).map(|k| f[i][k] * c[k][j]).sum::<f64>());
        Self {
            x: Scaled::new(-2.0 / 3.0, kinematics.i1_minus_3, kinematics),
            y: Scaled::new(-4.0 / 3.0, kinematics.i2_minus_3(), kinematics),
            by_gradient: [
                f.map(|row| row.map(|x| 2.0 * x)),
                std::array::from_fn(|i| std::array::from_fn(|j| second(i, j))),
            ],
            right_cauchy_green: c,
        }
    }
}

impl MooneyRivlin {
    /// The law with constants C₁₀, C₀₁, C₂₀, C₁₁, C₀₂, MPa; the first two alone are Mooney–Rivlin. The shear modulus at rest is
    /// 2 (C₁₀ + C₀₁).
    pub fn new(coefficients: [f64; 5]) -> Self {
        Self { coefficients }
    }

    /// W, ∂W/∂x and ∂W/∂y.
    fn polynomial(&self, x: f64, y: f64) -> [f64; 3] {
        let [c10, c01, c20, c11, c02] = self.coefficients;
        [
            x * (c10 + c20 * x + c11 * y) + y * (c01 + c02 * y),
            c10 + 2.0 * c20 * x + c11 * y,
            c01 + c11 * x + 2.0 * c02 * y,
        ]
    }
}

impl Hyperelastic for MooneyRivlin {
    fn respond(&self, kinematics: &Kinematics) -> Response {
        let (f, cofactor) = (&kinematics.gradient, &kinematics.cofactor);
        let State { x, y, by_gradient: [first, second], right_cauchy_green: c } = State::new(kinematics);
        let [energy, wx, wy] = self.polynomial(x.minus_3, y.minus_3);
        let [.., c20, c11, c02] = self.coefficients;
        let (gx, gy) = (x.gradient(&first, cofactor), y.gradient(&second, cofactor));
        let stress = std::array::from_fn(|i| std::array::from_fn(|j| wx * gx[i][j] + wy * gy[i][j]));

        let mut tangent = [[0.0; 9]; 9];
        add_dyad(&mut tangent, 2.0 * c20, &gx, &gx);
        add_dyad(&mut tangent, c11, &gx, &gy);
        add_dyad(&mut tangent, c11, &gy, &gx);
        add_dyad(&mut tangent, 2.0 * c02, &gy, &gy);
        x.add_curvature(&mut tangent, wx, &first, cofactor);
        y.add_curvature(&mut tangent, wy, &second, cofactor);
        let of_jacobian = second_derivative_of_jacobian(f);
        add_scaled(&mut tangent, wx * x.by_jacobian + wy * y.by_jacobian, &of_jacobian);
        let of_second = wy * y.by_invariant;
        let diagonal = 2.0 * wx * x.by_invariant + 2.0 * (kinematics.i1_minus_3 + 3.0) * of_second;
        for k in 0..9 {
            tangent[k][k] += diagonal;
        }
        add_dyad(&mut tangent, 4.0 * of_second, f, f);
        let delta = |a: usize, b: usize| f64::from(u8::from(a == b));
        for (row, column) in (0..81).map(|n| (n / 9, n % 9)) {
            let (i, j, k, l) = (row / 3, row % 3, column / 3, column % 3);
            let left_cauchy_green: f64 = (0..3).map(|m| f[i][m] * f[k][m]).sum();
            tangent[row][column] -=
                2.0 * of_second * (delta(i, k) * c[j][l] + f[i][l] * f[k][j] + left_cauchy_green * delta(j, l));
        }
        Response { energy, stress, tangent }
    }

    fn energy_and_stress(&self, kinematics: &Kinematics) -> (f64, Tensor) {
        let cofactor = &kinematics.cofactor;
        let State { x, y, by_gradient: [first, second], .. } = State::new(kinematics);
        let [energy, wx, wy] = self.polynomial(x.minus_3, y.minus_3);
        let (gx, gy) = (x.gradient(&first, cofactor), y.gradient(&second, cofactor));
        (energy, std::array::from_fn(|i| std::array::from_fn(|j| wx * gx[i][j] + wy * gy[i][j])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};

    #[test]
    fn it_passes_the_battery() {
        for coefficients in [[0.2, 0.07, 0.0, 0.0, 0.0], [0.2, 0.07, 0.03, -0.004, 0.002], [0.3, -0.05, 0.0, 0.01, 0.0]]
        {
            let law = MooneyRivlin::new(coefficients);
            battery::check_isotropic(&law, 0.3);
            battery::check_isochoric(&law, 2.0 * (coefficients[0] + coefficients[1]));
            // 2 (W₁ + λ_t² W₂) (λ − 1/(λ … )): Rivlin's relations.
            battery::check_homogeneous(&law, |mode, l| {
                let [a, b, c] = mode.stretches(l).map(|l| l * l);
                let [_, w1, w2] = law.polynomial(a + b + c - 3.0, 1.0 / a + 1.0 / b + 1.0 / c - 3.0);
                match mode {
                    Mode::Uniaxial => 2.0 * (w1 + w2 / l) * (l - l.powi(-2)),
                    Mode::Equibiaxial => 2.0 * (w1 + w2 * l * l) * (l - l.powi(-5)),
                    Mode::Planar => 2.0 * (w1 + w2) * (l - l.powi(-3)),
                }
            });
        }
    }
}
