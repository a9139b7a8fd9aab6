//! Where a set of Yeoh constants stops to describe a stable material.

/// Smallest Ī − 3 > 0 at which φ′ = C₁₀ + 2 C₂₀ x + 3 C₃₀ x² vanishes: beyond it the material gives way at once.
///
/// `None` if φ′ stays positive. The paper's constants have C₃₀ < 0 and reach it at 54.83 (theory §9).
pub fn zero_slope([c1, c2, c3]: [f64; 3]) -> Option<f64> {
    let [c, b, a] = [c1, 2.0 * c2, 3.0 * c3];
    if a == 0.0 {
        return (b < 0.0).then(|| -c / b);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // The citardauq form loses no digits when 4ac is small.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, if q == 0.0 { f64::INFINITY } else { c / q }]
        .into_iter()
        .filter(|x| *x > 0.0 && x.is_finite())
        .min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_model::Material;

    #[test]
    fn the_papers_constants_lose_their_slope_where_the_theory_says() {
        let limit = zero_slope(Material::default().law.reduced_polynomial().unwrap()).unwrap();
        assert!((limit - 54.83).abs() < 5e-3, "{limit}");
    }

    #[test]
    fn a_neo_hookean_material_never_does() {
        assert_eq!(zero_slope([0.2712, 0.0, 0.0]), None);
        assert_eq!(zero_slope([1.0, -0.5, 0.0]), Some(1.0));
    }
}
