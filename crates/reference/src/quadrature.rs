//! Gauss–Legendre rules by the method of Golub and Welsch: eigenvalues of the Jacobi matrix.

use nalgebra::{DMatrix, SymmetricEigen};

/// Points and weights of the `n`-point Gauss–Legendre rule on [−1, 1], in ascending order.
///
/// The Jacobi matrix of the Legendre polynomials has zeros on the diagonal and k/√(4k² − 1) beside it. Its eigenvalues
/// are the points; the weights are twice the squares of the eigenvectors' first components.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let mut jacobi = DMatrix::zeros(n, n);
    for k in 1..n {
        let beta = k as f64 / ((4 * k * k - 1) as f64).sqrt();
        jacobi[(k - 1, k)] = beta;
        jacobi[(k, k - 1)] = beta;
    }
    let eigen = SymmetricEigen::new(jacobi);
    let mut rule: Vec<(f64, f64)> =
        (0..n).map(|i| (eigen.eigenvalues[i], 2.0 * eigen.eigenvectors[(0, i)].powi(2))).collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule
}

/// Tensor product of the `n`-point rule on [−1, 1]ᵈ, first coordinate fastest.
pub fn tensor<const DIM: usize>(n: usize) -> Vec<([f64; DIM], f64)> {
    let line = gauss(n);
    (0..n.pow(DIM as u32))
        .map(|code| {
            let index = |d: usize| code / n.pow(d as u32) % n;
            (std::array::from_fn(|d| line[index(d)].0), (0..DIM).map(|d| line[index(d)].1).product())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_integrate_polynomials_up_to_degree_2n_minus_1() {
        for n in 1..=4 {
            for degree in 0..2 * n {
                let sum: f64 = gauss(n).iter().map(|&(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-13, "n = {n}, degree {degree}: {sum}");
            }
        }
        let volume: f64 = tensor::<3>(2).iter().map(|&(x, w)| w * x[0].powi(2) * x[1].powi(2)).sum();
        assert!((volume - 8.0 / 9.0).abs() < 1e-13);
    }
}
