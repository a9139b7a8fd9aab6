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

/// Irons' rule of degree 5 with 14 points on [−1, 1]³: weight a at distance r from the centre along the axes, weight b at
/// (±s, ±s, ±s).
///
/// The monomials 1, x², x⁴ and x²y² ask for 6a + 8b = 8, 2ar² + 8bs² = 8/3, 2ar⁴ + 8bs⁴ = 8/5 and 8bs⁴ = 8/9. With
/// x = 1/(3s²) they reduce to 15 (1 − x) = 4 (1 + x), so x = 11/19; the rest follows.
pub fn irons() -> Vec<([f64; 3], f64)> {
    let s = (19.0_f64 / 33.0).sqrt();
    let b = 1.0 / (9.0 * s.powi(4));
    let a = (8.0 - 8.0 * b) / 6.0;
    let r = ((8.0 / 3.0 - 8.0 * b * s * s) / (2.0 * a)).sqrt();
    let on_axes = (0..6).map(|i| {
        let mut point = [0.0; 3];
        point[i / 2] = if i % 2 == 0 { -r } else { r };
        (point, a)
    });
    let on_diagonals = tensor::<3>(2).into_iter().map(|(x, _)| (x.map(|t| s.copysign(t)), b));
    on_axes.chain(on_diagonals).collect()
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

    #[test]
    fn the_fourteen_points_integrate_polynomials_up_to_degree_5() {
        let exact = |n: i32| if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 };
        let powers = (0..=5).flat_map(|i| (0..=5 - i).flat_map(move |j| (0..=5 - i - j).map(move |k| [i, j, k])));
        for p in powers {
            let term = |x: &[f64; 3]| x[0].powi(p[0]) * x[1].powi(p[1]) * x[2].powi(p[2]);
            let sum: f64 = irons().iter().map(|(x, w)| w * term(x)).sum();
            assert!((sum - exact(p[0]) * exact(p[1]) * exact(p[2])).abs() < 1e-13, "{p:?}: {sum}");
        }
    }
}
