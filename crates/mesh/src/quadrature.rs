//! Gauss rules on reference elements and faces.

/// Abscissae and weights of the Gauss–Legendre rule with `n` points on [−1, 1] (n = 1 … 5).
///
/// # Panics
/// If `n` is 0 or above 5: rules are chosen by the program, never by its input.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    match n {
        1 => vec![(0.0, 2.0)],
        2 => symmetric(&[(1.0 / 3.0_f64.sqrt(), 1.0)], None),
        3 => symmetric(&[(0.6_f64.sqrt(), 5.0 / 9.0)], Some(8.0 / 9.0)),
        4 => {
            let (r, s) = (2.0 / 7.0 * 1.2_f64.sqrt(), 30.0_f64.sqrt() / 36.0);
            symmetric(&[((3.0 / 7.0 + r).sqrt(), 0.5 - s), ((3.0 / 7.0 - r).sqrt(), 0.5 + s)], None)
        }
        5 => {
            let (r, s) = (2.0 * (10.0_f64 / 7.0).sqrt(), 13.0 * 70.0_f64.sqrt());
            symmetric(
                &[((5.0 + r).sqrt() / 3.0, (322.0 - s) / 900.0), ((5.0 - r).sqrt() / 3.0, (322.0 + s) / 900.0)],
                Some(128.0 / 225.0),
            )
        }
        _ => panic!("no Gauss-Legendre rule with {n} points is tabulated"),
    }
}

/// Orders the rule from −1 to 1; `positive` runs from the outermost point inwards.
fn symmetric(positive: &[(f64, f64)], centre: Option<f64>) -> Vec<(f64, f64)> {
    let mut rule: Vec<_> = positive.iter().map(|&(x, w)| (-x, w)).collect();
    rule.extend(centre.map(|w| (0.0, w)));
    rule.extend(positive.iter().rev());
    rule
}

/// Tensor-product rule with `n`³ points on [−1, 1]³, ξ running fastest.
pub fn hexahedron(n: usize) -> Vec<([f64; 3], f64)> {
    let line = gauss_legendre(n);
    let mut rule = Vec::with_capacity(n * n * n);
    for &(z, wz) in &line {
        for &(y, wy) in &line {
            for &(x, wx) in &line {
                rule.push(([x, y, z], wx * wy * wz));
            }
        }
    }
    rule
}

/// Irons' rule of degree 5 with 14 points on [−1, 1]³: six on the axes, eight on the diagonals (Irons 1971, *Int. J. Numer.
/// Methods Engrg.* 3, "Quadrature rules for brick based finite elements").
pub fn hexahedron_14() -> Vec<([f64; 3], f64)> {
    let (axis, axis_weight) = ((19.0_f64 / 30.0).sqrt(), 320.0 / 361.0);
    let (corner, corner_weight) = ((19.0_f64 / 33.0).sqrt(), 121.0 / 361.0);
    let mut rule = Vec::with_capacity(14);
    for direction in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut xi = [0.0; 3];
            xi[direction] = sign * axis;
            rule.push((xi, axis_weight));
        }
    }
    for z in [-corner, corner] {
        for y in [-corner, corner] {
            for x in [-corner, corner] {
                rule.push(([x, y, z], corner_weight));
            }
        }
    }
    rule
}

/// Tensor-product rule with `n`² points on [−1, 1]², ξ running fastest.
pub fn quadrilateral(n: usize) -> Vec<([f64; 2], f64)> {
    let line = gauss_legendre(n);
    let mut rule = Vec::with_capacity(n * n);
    for &(y, wy) in &line {
        for &(x, wx) in &line {
            rule.push(([x, y], wx * wy));
        }
    }
    rule
}

/// Rule of degree 2 with four points on the unit tetrahedron (Keast 1986).
pub fn tetrahedron_4() -> Vec<([f64; 3], f64)> {
    let a = (5.0 - 5.0_f64.sqrt()) / 20.0;
    let b = 1.0 - 3.0 * a;
    [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|x| (x, 1.0 / 24.0)).to_vec()
}

/// Rule of degree 3 with eight points and positive weights on the unit tetrahedron: the corners and the centres of the
/// faces. The closed Newton–Cotes rule of third order (Silvester 1970, *Math. Comp.* 24): its weights on the edges vanish.
pub fn tetrahedron_8() -> Vec<([f64; 3], f64)> {
    const THIRD: f64 = 1.0 / 3.0;
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let centres = [[THIRD; 3], [0.0, THIRD, THIRD], [THIRD, 0.0, THIRD], [THIRD, THIRD, 0.0]];
    corners.map(|x| (x, 1.0 / 240.0)).into_iter().chain(centres.map(|x| (x, 9.0 / 240.0))).collect()
}

/// A barycentric rule on the unit tetrahedron: every permutation of these coordinates, each with the weight.
fn tetrahedral(orbits: &[([f64; 4], f64)]) -> Vec<([f64; 3], f64)> {
    let mut rule: Vec<([f64; 3], f64)> = Vec::new();
    for &(at, weight) in orbits {
        let mut points: Vec<[f64; 3]> = Vec::new();
        for (i, j, k) in (0..64).map(|code| (code / 16, code / 4 % 4, code % 4)) {
            let point = [at[i], at[j], at[k]];
            if i != j && j != k && i != k && !points.contains(&point) {
                points.push(point);
            }
        }
        rule.extend(points.into_iter().map(|point| (point, weight)));
    }
    rule
}

/// Rule of degree 5 with 14 points and positive weights on the unit tetrahedron (Grundmann & Möller 1978, *SIAM J. Numer. Anal.* 15; Walkington
/// 2000).
pub fn tetrahedron_14() -> Vec<([f64; 3], f64)> {
    let [a, b] = [0.310_885_919_263_300_6, 0.092_735_250_310_891_23];
    let c = 0.045_503_704_125_649_65;
    tetrahedral(&[
        ([1.0 - 3.0 * a, a, a, a], 0.018_781_320_953_002_642),
        ([1.0 - 3.0 * b, b, b, b], 0.012_248_840_519_393_658),
        ([c, c, 0.5 - c, 0.5 - c], 0.007_091_003_462_846_911),
    ])
}

/// Rule of degree 6 with 24 points and positive weights on the unit tetrahedron (Keast 1986, *Comput. Methods Appl. Mech. Engrg.* 55).
pub fn tetrahedron_24() -> Vec<([f64; 3], f64)> {
    let [a, b, c] = [0.214_602_871_259_152_03, 0.040_673_958_534_611_35, 0.322_337_890_142_275_5];
    let [d, e] = [0.063_661_001_875_017_53, 0.269_672_331_458_315_8];
    tetrahedral(&[
        ([1.0 - 3.0 * a, a, a, a], 0.006_653_791_709_694_582),
        ([1.0 - 3.0 * b, b, b, b], 0.001_679_535_175_886_774),
        ([1.0 - 3.0 * c, c, c, c], 0.009_226_196_923_942_454),
        ([d, d, e, 1.0 - 2.0 * d - e], 0.008_035_714_285_714_286),
    ])
}

/// Collapsed rule with 4³ points and positive weights on the unit tetrahedron: the cube's rule with three of its sides drawn together.
pub fn tetrahedron_64() -> Vec<([f64; 3], f64)> {
    let collapse = |(x, w): ([f64; 3], f64)| {
        let [s, t, u] = x.map(|t| 0.5 * (1.0 + t));
        ([s, t * (1.0 - s), u * (1.0 - s) * (1.0 - t)], 0.125 * w * (1.0 - s).powi(2) * (1.0 - t))
    };
    hexahedron(4).into_iter().map(collapse).collect()
}

/// Rule of degree 8 with 16 points and positive weights on the unit triangle (Dunavant 1985). It is the same for every order of the corners: what
/// touches does not depend on how a mesh numbers its nodes.
pub fn triangle_16() -> Vec<([f64; 2], f64)> {
    let mut rule = vec![([1.0 / 3.0; 2], 0.5 * 0.144_315_607_677_787)];
    for (a, w) in [
        (0.459_292_588_292_723, 0.095_091_634_267_285),
        (0.170_569_307_751_760, 0.103_217_370_534_718),
        (0.050_547_228_317_031, 0.032_458_497_623_198),
    ] {
        let b = 1.0 - 2.0 * a;
        rule.extend([[a, a], [a, b], [b, a]].map(|x| (x, 0.5 * w)));
    }
    let [a, b] = [0.263_112_829_634_638, 0.008_394_777_409_958];
    let c = 1.0 - a - b;
    rule.extend([[a, b], [b, a], [a, c], [c, a], [b, c], [c, b]].map(|x| (x, 0.5 * 0.027_230_314_174_435)));
    rule
}

/// Rule of degree 5 with seven points and positive weights on the unit triangle (Radon 1948; Dunavant 1985).
pub fn triangle_7() -> Vec<([f64; 2], f64)> {
    let root = 15.0_f64.sqrt();
    let mut rule = vec![([1.0 / 3.0; 2], 9.0 / 80.0)];
    for (a, w) in [((6.0 - root) / 21.0, (155.0 - root) / 2400.0), ((6.0 + root) / 21.0, (155.0 + root) / 2400.0)] {
        let b = 1.0 - 2.0 * a;
        rule.extend([[a, a], [a, b], [b, a]].map(|x| (x, w)));
    }
    rule
}

/// A rule on the unit triangle times the Gauss–Legendre rule with `n` points along \[−1, 1\], the triangle's points running fastest.
pub fn wedge(triangle: &[([f64; 2], f64)], n: usize) -> Vec<([f64; 3], f64)> {
    let layer = |(z, along): (f64, f64)| triangle.iter().map(move |&([x, y], w)| ([x, y, z], along * w));
    gauss_legendre(n).into_iter().flat_map(layer).collect()
}

/// Rule of degree 5 with 21 points and positive weights on the unit triangle times \[−1, 1\].
pub fn wedge_21() -> Vec<([f64; 3], f64)> {
    wedge(&triangle_7(), 3)
}

/// Rule of degree 7 with 64 points and positive weights on the unit triangle times \[−1, 1\].
pub fn wedge_64() -> Vec<([f64; 3], f64)> {
    wedge(&triangle_16(), 4)
}

/// Rule of degree 4 with six points on the unit triangle (Dunavant 1985).
pub fn triangle_6() -> Vec<([f64; 2], f64)> {
    let mut rule = Vec::new();
    for (a, w) in [(0.445_948_490_915_965, 0.223_381_589_678_011), (0.091_576_213_509_771, 0.109_951_743_655_322)] {
        let b = 1.0 - 2.0 * a;
        rule.extend([[a, a], [a, b], [b, a]].map(|x| (x, 0.5 * w)));
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_integrates_polynomials_up_to_degree_2n_minus_1() {
        for n in 1..=5 {
            for degree in 0..2 * n {
                let sum: f64 = gauss_legendre(n).iter().map(|&(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "n = {n}, degree {degree}: {sum}");
            }
        }
    }

    #[test]
    fn fourteen_points_integrate_polynomials_up_to_degree_5() {
        let exact = |n: i32| if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 };
        for i in 0..=5 {
            for j in 0..=5 - i {
                for k in 0..=5 - i - j {
                    let sum: f64 =
                        hexahedron_14().iter().map(|&([x, y, z], w)| w * x.powi(i) * y.powi(j) * z.powi(k)).sum();
                    assert!((sum - exact(i) * exact(j) * exact(k)).abs() < 1e-14, "x^{i} y^{j} z^{k}: {sum}");
                }
            }
        }
    }

    #[test]
    fn simplex_rules_integrate_their_degree() {
        for (rule, degree) in [(triangle_6(), 4), (triangle_7(), 5), (triangle_16(), 8)] {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let sum: f64 = rule.iter().map(|&([x, y], w)| w * x.powi(i) * y.powi(j)).sum();
                    // ∫ xⁱ yʲ = i! j! / (i + j + 2)!
                    let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                    assert!((sum - exact).abs() < 1e-13, "x^{i} y^{j}: {sum} for {exact}");
                }
            }
        }
        for (rule, degree) in [
            (tetrahedron_4(), 2),
            (tetrahedron_8(), 3),
            (tetrahedron_14(), 5),
            (tetrahedron_24(), 6),
            (tetrahedron_64(), 5),
        ] {
            assert!(rule.iter().all(|(_, w)| *w > 0.0));
            for i in 0..=degree {
                for j in 0..=degree - i {
                    for k in 0..=degree - i - j {
                        let sum: f64 = rule.iter().map(|&([x, y, z], w)| w * x.powi(i) * y.powi(j) * z.powi(k)).sum();
                        let exact = factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
                        assert!((sum - exact).abs() < 1e-14, "x^{i} y^{j} z^{k}: {sum} for {exact}");
                    }
                }
            }
        }
    }

    #[test]
    fn wedge_rules_integrate_their_degree() {
        for (rule, degree) in [(wedge_21(), 5), (wedge_64(), 7)] {
            for (i, j, k) in (0..512).map(|code| (code / 64, code / 8 % 8, code % 8)) {
                if i + j <= degree && k <= degree {
                    let sum: f64 = rule.iter().map(|&([x, y, z], w)| w * x.powi(i) * y.powi(j) * z.powi(k)).sum();
                    let along = if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
                    let exact = along * factorial(i) * factorial(j) / factorial(i + j + 2);
                    assert!((sum - exact).abs() < 1e-13, "x^{i} y^{j} z^{k}: {sum} for {exact}");
                }
            }
        }
    }

    #[test]
    fn rules_on_triangles_know_no_first_corner() {
        for rule in [triangle_6(), triangle_7(), triangle_16()] {
            for &([x, y], w) in &rule {
                let is_there = |x: f64, y: f64| {
                    rule.iter().any(|([a, b], v)| (a - x).abs() < 1e-14 && (b - y).abs() < 1e-14 && *v == w)
                };
                assert!(w > 0.0 && is_there(y, x) && is_there(1.0 - x - y, x), "{x} {y}");
            }
        }
    }

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }
}
