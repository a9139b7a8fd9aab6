//! Eigenvalues and eigenvectors of symmetric 3 × 3 matrices by Jacobi's method (Golub & Van Loan, *Matrix Computations*, §8.5).
//!
//! The vectors are orthonormal to rounding for equal eigenvalues, too, and a fixed number of sweeps ends on any input.

/// Sweeps; four or five reach rounding.
const SWEEPS: usize = 12;

/// Eigenvalues and, row by row, their eigenvectors.
pub fn symmetric(matrix: &[[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut a = *matrix;
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        if [a[0][1], a[0][2], a[1][2]] == [0.0; 3] {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

/// Makes the entry (p, q) vanish.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let entry = a[p][q];
    // Below the rounding of either diagonal entry it changes neither.
    if a[p][p] + entry == a[p][p] && a[q][q] + entry == a[q][q] {
        (a[p][q], a[q][p]) = (0.0, 0.0);
        return;
    }
    let ratio = (a[q][q] - a[p][p]) / (2.0 * entry);
    // The smaller root of t² + 2 ratio t − 1 = 0.
    let t = 1.0_f64.copysign(ratio) / (ratio.abs() + ratio.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    let r = 3 - p - q;
    (a[p][p], a[q][q]) = (a[p][p] - t * entry, a[q][q] + t * entry);
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let (x, y) = (a[p][r], a[q][r]);
    (a[p][r], a[q][r]) = (c * x - s * y, s * x + c * y);
    (a[r][p], a[r][q]) = (a[p][r], a[q][r]);
    for k in 0..3 {
        let (x, y) = (vectors[p][k], vectors[q][k]);
        (vectors[p][k], vectors[q][k]) = (c * x - s * y, s * x + c * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_put_together_again_by_orthonormal_vectors() {
        let turned = |d: [f64; 3]| -> [[f64; 3]; 3] {
            let q = [[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]].map(|row: [f64; 3]| row.map(|x| x / 3.0));
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| d[k] * q[k][i] * q[k][j]).sum()))
        };
        let matrices = [
            turned([3.0, -0.5, 0.2]),
            turned([0.7, 0.7, -0.4]),
            turned([0.3, 0.3 + 1e-14, 0.3]),
            turned([1e-9, 2e-9, -1e-9]),
            turned([1e12, 1.0, -1.0]),
            [[0.0; 3]; 3],
            [[1.0, 1e-300, 0.0], [1e-300, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ];
        for m in matrices {
            let (values, v) = symmetric(&m);
            let size = m.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let again: f64 = (0..3).map(|k| values[k] * v[k][i] * v[k][j]).sum();
                assert!((again - m[i][j]).abs() <= 1e-15 * size * 4.0, "{m:?}: {again} {}", m[i][j]);
                let product: f64 = (0..3).map(|k| v[i][k] * v[j][k]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 2e-15, "{m:?}");
            }
        }
    }
}
