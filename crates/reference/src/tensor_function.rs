//! Powers of symmetric positive definite 3 × 3 matrices of dual numbers.
//!
//! Without eigenvalues, whose derivatives do not exist where two of them meet: the logarithm by square roots (Denman & Beavers
//! 1976, *Appl. Math. Comput.* 2) and the series of artanh, the exponential by its series and squaring. The numbers of
//! iterations and terms are enough for eigenvalues from 10⁻² to 10² and exponents up to 5.

use crate::differentiate::{Dual, cross, dot};

/// A matrix, row by row.
pub type Matrix<D> = [[D; 3]; 3];

const ROOTS: i32 = 4;
const ROOT_ITERATIONS: usize = 10;
const LOGARITHM_TERMS: i32 = 12;
const SQUARINGS: i32 = 4;
const EXPONENTIAL_TERMS: i32 = 16;

fn identity<D: Dual>() -> Matrix<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| D::from(if i == j { 1.0 } else { 0.0 })))
}

fn combined<D: Dual>(a: &Matrix<D>, b: &Matrix<D>, f: impl Fn(D, D) -> D) -> Matrix<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| f(a[i][j], b[i][j])))
}

fn scaled<D: Dual>(a: &Matrix<D>, factor: f64) -> Matrix<D> {
    a.map(|row| row.map(|x| x * factor))
}

/// a b.
pub fn product<D: Dual>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

/// Sum of the diagonal.
pub fn trace<D: Dual>(a: &Matrix<D>) -> D {
    a[0][0] + a[1][1] + a[2][2]
}

fn inverse<D: Dual>(a: &Matrix<D>) -> Matrix<D> {
    // Columns of the inverse are cross products of the rows over the determinant.
    let columns = [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])];
    let determinant = dot(a[0], columns[0]);
    std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i] / determinant))
}

fn square_root<D: Dual>(a: &Matrix<D>) -> Matrix<D> {
    let (mut y, mut z) = (*a, identity());
    for _ in 0..ROOT_ITERATIONS {
        let mean = |a: D, b: D| (a + b) * 0.5;
        (y, z) = (combined(&y, &inverse(&z), mean), combined(&z, &inverse(&y), mean));
    }
    y
}

/// ln a.
pub fn logarithm<D: Dual>(a: &Matrix<D>) -> Matrix<D> {
    let mut root = *a;
    (0..ROOTS).for_each(|_| root = square_root(&root));
    // ln r = 2 artanh z, z = (r − 1) (r + 1)⁻¹.
    let z = product(
        &combined(&root, &identity(), |r, one| r - one),
        &inverse(&combined(&root, &identity(), |r, one| r + one)),
    );
    let square = product(&z, &z);
    let (mut power, mut sum) = (z, z);
    for k in 1..LOGARITHM_TERMS {
        power = product(&power, &square);
        sum = combined(&sum, &power, |s, p| s + p / f64::from(2 * k + 1));
    }
    scaled(&sum, 2.0 * 2.0_f64.powi(ROOTS))
}

/// exp a.
pub fn exponential<D: Dual>(a: &Matrix<D>) -> Matrix<D> {
    let small = scaled(a, 0.5_f64.powi(SQUARINGS));
    let (mut power, mut sum) = (identity(), identity());
    for k in 1..EXPONENTIAL_TERMS {
        power = scaled(&product(&power, &small), 1.0 / f64::from(k));
        sum = combined(&sum, &power, |s, p| s + p);
    }
    (0..SQUARINGS).for_each(|_| sum = product(&sum, &sum));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_a_matrix_with_known_eigenvectors() {
        let q = [[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]].map(|row: [f64; 3]| row.map(|x| x / 3.0));
        let with = |d: [f64; 3]| -> Matrix<f64> {
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| d[k] * q[k][i] * q[k][j]).sum()))
        };
        for values in [[0.3, 1.7, 4.1], [2.0, 2.0, 0.25], [1.1, 1.1, 1.1], [0.05, 20.0, 1.0]] {
            let [found, back] = [logarithm(&with(values)), exponential(&logarithm(&with(values)))];
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                assert!((found[i][j] - with(values.map(f64::ln))[i][j]).abs() < 1e-13, "{values:?}");
                assert!((back[i][j] - with(values)[i][j]).abs() < 1e-12, "{values:?}");
            }
        }
    }
}
