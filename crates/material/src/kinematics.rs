//! Deformation measures computed from the displacement gradient without loss of digits near the undeformed state.

pub use pneuflex_mesh::mesh::cofactor;

/// The deformation at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// Displacement gradient H = F − 1.
    pub displacement_gradient: [[f64; 3]; 3],
    /// Deformation gradient F = 1 + ∂u/∂X; `[i][j] = ∂xᵢ/∂Xⱼ`.
    pub gradient: [[f64; 3]; 3],
    /// Cofactor J F⁻ᵀ = ∂J/∂F.
    pub cofactor: [[f64; 3]; 3],
    /// J = det F.
    pub jacobian: f64,
    /// J − 1.
    pub jacobian_minus_1: f64,
    /// I₁ − 3 = F:F − 3.
    pub i1_minus_3: f64,
}

/// det F is not positive (or not a number): the material is turned inside out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("det F = {0:.3e} is not positive")]
pub struct InvalidJacobian(pub f64);

impl Kinematics {
    /// From the displacement gradient `h[i][j] = ∂uᵢ/∂Xⱼ`.
    ///
    /// I₁ − 3 = 2 tr H + H:H and J − 1 = tr H + II(H) + det H are exact expansions that avoid subtracting 3 and 1 from
    /// numbers close to them.
    ///
    /// # Errors
    /// [`InvalidJacobian`] if det F ≤ 0.
    pub fn new(h: &[[f64; 3]; 3]) -> Result<Self, InvalidJacobian> {
        let trace = h[0][0] + h[1][1] + h[2][2];
        let squares: f64 = h.as_flattened().iter().map(|x| x * x).sum();
        let minor = |a: usize, b: usize| h[a][a] * h[b][b] - h[a][b] * h[b][a];
        let second = minor(0, 1) + minor(1, 2) + minor(0, 2);
        let determinant = h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1])
            - h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0])
            + h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
        let jacobian_minus_1 = trace + second + determinant;
        let jacobian = 1.0 + jacobian_minus_1;
        // Written so that a NaN is refused too.
        if !(jacobian > 0.0 && jacobian.is_finite()) {
            return Err(InvalidJacobian(jacobian));
        }
        let mut f = *h;
        for i in 0..3 {
            f[i][i] += 1.0;
        }
        Ok(Self {
            displacement_gradient: *h,
            gradient: f,
            cofactor: cofactor(&f),
            jacobian,
            jacobian_minus_1,
            i1_minus_3: 2.0 * trace + squares,
        })
    }

    /// C − 1 = H + Hᵀ + HᵀH, twice the Green–Lagrange strain.
    pub fn right_cauchy_green_minus_1(&self) -> [[f64; 3]; 3] {
        let h = &self.displacement_gradient;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| h[i][j] + h[j][i] + (0..3).map(|k| h[k][i] * h[k][j]).sum::<f64>())
        })
    }

    /// I₂ − 3 = 2 tr D + II(D) with D = C − 1, I₂ = ½ ((tr C)² − tr C²).
    pub fn i2_minus_3(&self) -> f64 {
        let d = self.right_cauchy_green_minus_1();
        let minor = |a: usize, b: usize| d[a][a] * d[b][b] - d[a][b] * d[b][a];
        2.0 * (d[0][0] + d[1][1] + d[2][2]) + minor(0, 1) + minor(1, 2) + minor(0, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_deformations_keep_their_digits() {
        let mut h = [[0.0; 3]; 3];
        h[0][0] = 1e-12;
        let k = Kinematics::new(&h).unwrap();
        assert_eq!(k.jacobian_minus_1, 1e-12);
        assert!((k.i1_minus_3 - (2e-12 + 1e-24)).abs() < 1e-27);
        assert!((k.i2_minus_3() - 2.0 * (2e-12 + 1e-24)).abs() < 1e-27);
    }

    /// I₂ is the sum of the squares of the cofactor's entries.
    #[test]
    fn the_second_invariant_is_that_of_the_cofactor() {
        let k = Kinematics::new(&[[0.31, -0.22, 0.15], [0.08, -0.17, 0.21], [-0.12, 0.19, 0.26]]).unwrap();
        let squares: f64 = k.cofactor.as_flattened().iter().map(|x| x * x).sum();
        assert!((k.i2_minus_3() + 3.0 - squares).abs() < 1e-14);
    }

    #[test]
    fn inverted_and_undefined_deformations_are_errors() {
        let mut h = [[0.0; 3]; 3];
        h[1][1] = -1.5;
        assert_eq!(Kinematics::new(&h).unwrap_err().0, -0.5);
        h[1][1] = f64::NAN;
        assert!(Kinematics::new(&h).is_err());
    }
}
