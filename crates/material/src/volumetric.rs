//! Energies U(J) of a change of volume.

use pneuflex_model::Volumetric;

/// U/κ and its first two derivatives by J at J − 1; not numbers where U is not defined.
///
/// * quadratic: ½ (J − 1)²,
/// * logarithmic: ½ (ln J)², which resists compression to nothing, but gives way beyond J = e, where its second derivative
///   changes sign.
pub fn evaluate(form: Volumetric, jacobian_minus_1: f64) -> [f64; 3] {
    match form {
        Volumetric::Quadratic => [0.5 * jacobian_minus_1 * jacobian_minus_1, jacobian_minus_1, 1.0],
        Volumetric::Logarithmic => {
            let (logarithm, jacobian) = (jacobian_minus_1.ln_1p(), 1.0 + jacobian_minus_1);
            [0.5 * logarithm * logarithm, logarithm / jacobian, (1.0 - logarithm) / (jacobian * jacobian)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_difference_quotients_and_the_bulk_modulus_at_rest_is_one() {
        for form in [Volumetric::Quadratic, Volumetric::Logarithmic] {
            assert_eq!(evaluate(form, 0.0), [0.0, 0.0, 1.0]);
            for x in [-0.6, -0.1, 0.3, 2.5] {
                let ([_, slope, curvature], h) = (evaluate(form, x), 1e-6);
                let (low, high) = (evaluate(form, x - h), evaluate(form, x + h));
                assert!(((high[0] - low[0]) / (2.0 * h) - slope).abs() < 1e-8, "{form:?} {x}");
                assert!(((high[1] - low[1]) / (2.0 * h) - curvature).abs() < 1e-8, "{form:?} {x}");
            }
        }
        assert!(evaluate(Volumetric::Logarithmic, 2.0)[2] < 0.0);
        assert!(evaluate(Volumetric::Logarithmic, -1.5)[0].is_nan());
    }
}
