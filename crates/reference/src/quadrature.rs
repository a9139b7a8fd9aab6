//! Gauss–Legendre rules by the method of Golub and Welsch: eigenvalues of the Jacobi matrix; rules on simplices.

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

/// The tensor rule on [0, 1]ᵈ, collapsed onto the unit simplex: d = 2 or 3.
///
/// The map (s, t, u) ↦ (s, t (1 − s), u (1 − s)(1 − t)) has the determinant (1 − s)ᵈ⁻¹ (1 − t)ᵈ⁻²: with `n` points per
/// direction, polynomials up to degree 2n − d are integrated exactly. First coordinate fastest.
pub fn collapsed<const DIM: usize>(n: usize) -> Vec<([f64; DIM], f64)> {
    tensor::<DIM>(n)
        .into_iter()
        .map(|(x, weight)| {
            // What is left of the unit after the coordinates so far.
            let (mut rest, mut point, mut weight) = (1.0, [0.0; DIM], weight);
            for d in 0..DIM {
                let share = 0.5 * (1.0 + x[d]);
                weight *= 0.5 * rest;
                point[d] = share * rest;
                rest *= 1.0 - share;
            }
            (point, weight)
        })
        .collect()
}

/// Four points on the unit tetrahedron's medians, of degree 2.
///
/// At centroid + τ (corner − centroid) with equal weights, constants and linear functions are integrated for any τ by
/// symmetry. The mean of x² is 1/10; that of the points is 1/16 + 3 τ²/16: τ = 1/√5. (Products x y follow, as the
/// barycentric coordinates add up to one.)
pub fn tetrahedron_of_degree_2() -> Vec<([f64; 3], f64)> {
    let tau = 0.2_f64.sqrt();
    let at = |corner: usize| std::array::from_fn(|d| 0.25 + tau * (if corner == d { 0.75 } else { -0.25 }));
    // Corner 3 is the origin: none of the coordinates is one there.
    [3, 0, 1, 2].map(|corner| (at(corner), 1.0 / 24.0)).to_vec()
}

/// Fourteen points on the unit tetrahedron, of degree 5 and the same for all orders of its corners (Grundmann & Möller 1978): four each on
/// two sets of the medians, and six between the middles of opposite edges.
pub fn tetrahedron_of_degree_5() -> Vec<([f64; 3], f64)> {
    let mut rule: Vec<([f64; 3], f64)> = Vec::new();
    for (a, weight) in
        [(0.310_885_919_263_300_6, 0.018_781_320_953_002_642), (0.092_735_250_310_891_23, 0.012_248_840_519_393_658)]
    {
        // Corner 3 is the origin.
        rule.extend(
            (0..4).map(|corner| (std::array::from_fn(|d| if d == corner { 1.0 - 3.0 * a } else { a }), weight)),
        );
    }
    let (c, weight) = (0.045_503_704_125_649_65, 0.007_091_003_462_846_911);
    for (i, j) in (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j))) {
        rule.push((std::array::from_fn(|d| if d == i || d == j { c } else { 0.5 - c }), weight));
    }
    rule
}

/// Sixteen points on the unit triangle, of degree 8 and the same for all orders of its corners (Dunavant 1985): all permutations of barycentric
/// coordinates of which two are given.
pub fn triangle_of_degree_8() -> Vec<([f64; 2], f64)> {
    const THIRD: f64 = 1.0 / 3.0;
    let orbits = [
        (THIRD, THIRD, 0.144_315_607_677_787),
        (0.459_292_588_292_723, 0.081_414_823_414_554, 0.095_091_634_267_285),
        (0.170_569_307_751_760, 0.658_861_384_496_480, 0.103_217_370_534_718),
        (0.050_547_228_317_031, 0.898_905_543_365_938, 0.032_458_497_623_198),
        (0.263_112_829_634_638, 0.008_394_777_409_958, 0.027_230_314_174_435),
    ];
    let mut rule: Vec<([f64; 2], f64)> = Vec::new();
    for (a, b, weight) in orbits {
        let coordinates = [a, b, 1.0 - a - b];
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).filter(|(i, j)| i != j) {
            let point = [coordinates[i], coordinates[j]];
            let is_known = rule.iter().any(|(known, _)| (0..2).all(|d| (known[d] - point[d]).abs() < 1e-12));
            if !is_known {
                rule.push((point, 0.5 * weight));
            }
        }
    }
    rule
}

/// Seven points of degree 5 on the unit triangle (Radon 1948), in numbers.
pub fn triangle_of_degree_5() -> Vec<([f64; 2], f64)> {
    let mut rule = vec![([1.0 / 3.0; 2], 0.1125)];
    for (a, w) in
        [(0.101_286_507_323_456_34, 0.062_969_590_272_413_58), (0.470_142_064_105_115_1, 0.066_197_076_394_253_1)]
    {
        let b = 1.0 - 2.0 * a;
        rule.extend([([a, a], w), ([b, a], w), ([a, b], w)]);
    }
    rule
}

/// A rule on the unit triangle times Gauss's with three points along the third axis.
pub fn prism(triangle: &[([f64; 2], f64)]) -> Vec<([f64; 3], f64)> {
    let line = gauss(3);
    line.iter().flat_map(|&(z, v)| triangle.iter().map(move |&([x, y], w)| ([x, y, z], v * w))).collect()
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
        // ∫ xⁱ yʲ zᵏ = i! j! k! / (i + j + k + 3)!
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (rule, degree) in [(collapsed::<3>(3), 3), (tetrahedron_of_degree_2(), 2), (tetrahedron_of_degree_5(), 5)] {
            for (i, j, k) in (0..=degree)
                .flat_map(|i| (0..=degree - i).flat_map(move |j| (0..=degree - i - j).map(move |k| (i, j, k))))
            {
                let sum: f64 = rule.iter().map(|&([x, y, z], w)| w * x.powi(i) * y.powi(j) * z.powi(k)).sum();
                let exact = factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
                assert!((sum - exact).abs() < 1e-14, "x^{i} y^{j} z^{k}");
            }
        }
        for (i, j) in (0..=4).flat_map(|i| (0..=4 - i).map(move |j| (i, j))) {
            let sum: f64 = collapsed::<2>(3).iter().map(|&([x, y], w)| w * x.powi(i) * y.powi(j)).sum();
            assert!((sum - factorial(i) * factorial(j) / factorial(i + j + 2)).abs() < 1e-14);
        }
        for (i, j) in (0..=8).flat_map(|i| (0..=8 - i).map(move |j| (i, j))) {
            let sum: f64 = triangle_of_degree_8().iter().map(|&([x, y], w)| w * x.powi(i) * y.powi(j)).sum();
            assert!((sum - factorial(i) * factorial(j) / factorial(i + j + 2)).abs() < 1e-13, "x^{i} y^{j}: {sum}");
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
