//! Tensors as arrays, and a law's answer in them.

/// A second-order tensor; `[i][j]` belongs to ∂rᵢ/∂Xⱼ.
pub type Tensor = [[f64; 3]; 3];

/// A fourth-order tensor of derivatives by F; row and column 3i + j belong to ∂rᵢ/∂Xⱼ.
pub type Tangent = [[f64; 9]; 9];

/// Energy, stress and tangent at a deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Energy density W, MPa.
    pub energy: f64,
    /// First Piola–Kirchhoff stress P = ∂W/∂F, MPa.
    pub stress: Tensor,
    /// ∂P/∂F, MPa.
    pub tangent: Tangent,
}

/// The second derivative of J = det F by F, `[3i + j][3k + l]` = Σ ε_ikm ε_jln F_mn.
pub fn second_derivative_of_jacobian(f: &Tensor) -> Tangent {
    let mut out = [[0.0; 9]; 9];
    for i in 0..3 {
        for j in 0..3 {
            for (k, m, one) in [((i + 1) % 3, (i + 2) % 3, 1.0), ((i + 2) % 3, (i + 1) % 3, -1.0)] {
                for (l, n, other) in [((j + 1) % 3, (j + 2) % 3, 1.0), ((j + 2) % 3, (j + 1) % 3, -1.0)] {
                    out[3 * i + j][3 * k + l] = one * other * f[m][n];
                }
            }
        }
    }
    out
}

/// t ← t + factor a bᵀ, with the tensors as vectors of nine entries.
pub fn add_dyad(t: &mut Tangent, factor: f64, a: &Tensor, b: &Tensor) {
    for (row, x) in t.iter_mut().zip(a.as_flattened()) {
        for (entry, y) in row.iter_mut().zip(b.as_flattened()) {
            *entry += factor * x * y;
        }
    }
}

/// t ← t + factor s.
pub fn add_scaled(t: &mut Tangent, factor: f64, s: &Tangent) {
    for (entry, x) in t.as_flattened_mut().iter_mut().zip(s.as_flattened()) {
        *entry += factor * x;
    }
}
