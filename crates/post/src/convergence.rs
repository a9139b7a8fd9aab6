//! What a sequence of meshes says about the exact answer: Richardson extrapolation with an error bar.
//!
//! Source: Celik et al. 2008, "Procedure for estimation and reporting of uncertainty due to discretization in CFD
//! applications", *J. Fluids Engrg.* 130, 078001 (the ASME procedure), after Roache's grid convergence index.

use serde::Serialize;

/// Orders outside this range are not believed: the meshes are not yet in the range where the error falls like a power of h.
const CREDIBLE_ORDER: [f64; 2] = [0.5, 4.0];

/// Factor of safety with an order observed on three meshes, and without one.
const SAFETY: [f64; 2] = [1.25, 3.0];

/// A value on the finest of some meshes, and what is known of its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extrapolated {
    /// Value on the finest mesh.
    pub finest: f64,
    /// Value extrapolated to elements of no size; the finest one where no order was observed.
    pub extrapolated: f64,
    /// Half width of the error bar about the finest value.
    pub error_bar: f64,
    /// Observed order of convergence; left out where the values do not approach a limit with a credible one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
}

/// Extrapolates values computed with elements of the sizes `h`, which fall; the last three count.
///
/// With three values that approach a limit by an order from 0.5 to 4 the error bar is 1.25 times the distance to the
/// extrapolated value. Otherwise it is 3 times the difference of the last two.
/// `None` for fewer than two values, or sizes that do not fall.
pub fn extrapolate(h: &[f64], values: &[f64]) -> Option<Extrapolated> {
    let n = values.len().min(h.len());
    if n < 2 || h.windows(2).any(|pair| pair[0].is_nan() || pair[1].is_nan() || pair[1] >= pair[0]) {
        return None;
    }
    let finest = values[n - 1];
    let order = if n < 3 { None } else { observed_order(&h[n - 3..n], &values[n - 3..n]) };
    if let Some(order) = order {
        let gain = (h[n - 2] / h[n - 1]).powf(order) - 1.0;
        let step = (finest - values[n - 2]) / gain;
        let error_bar = SAFETY[0] * step.abs();
        return Some(Extrapolated { finest, extrapolated: finest + step, error_bar, order: Some(order) });
    }
    let change = (finest - values[n - 2]).abs();
    Some(Extrapolated { finest, extrapolated: finest, error_bar: SAFETY[1] * change, order: None })
}

/// The order p with f = f₀ + C hᵖ through three points, by bisection over the credible range.
fn observed_order(h: &[f64], f: &[f64]) -> Option<f64> {
    let ratio = (f[2] - f[1]) / (f[1] - f[0]);
    // (h₂ᵖ − h₃ᵖ) / (h₁ᵖ − h₂ᵖ) falls with p, from ln(h₂/h₃) / ln(h₁/h₂) at p = 0.
    let excess = |p: f64| (h[1].powf(p) - h[2].powf(p)) / (h[0].powf(p) - h[1].powf(p)) - ratio;
    let [mut low, mut high] = CREDIBLE_ORDER;
    if !ratio.is_finite() || excess(low) < 0.0 || excess(high) > 0.0 {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_exactly() {
        let h = [1.0, 0.7, 0.45];
        for order in [0.6, 1.0, 2.0, 3.7] {
            let values = h.map(|h| 5.0 - 0.3 * f64::powf(h, order));
            let found = extrapolate(&h, &values).unwrap();
            assert!((found.order.unwrap() - order).abs() < 1e-9);
            assert!((found.extrapolated - 5.0).abs() < 1e-9);
            assert!((found.error_bar - 1.25 * (5.0 - values[2])).abs() < 1e-9);
        }
    }

    #[test]
    fn values_without_a_credible_order_get_a_wide_bar() {
        for values in [[1.0, 2.0, 1.5], [1.0, 1.1, 2.0], [1.0, 2.0, 2.0 + 1e-9]] {
            let found = extrapolate(&[4.0, 2.0, 1.0], &values).unwrap();
            assert_eq!((found.order, found.extrapolated), (None, values[2]));
            assert_eq!(found.error_bar, 3.0 * (values[2] - values[1]).abs());
        }
        assert_eq!(extrapolate(&[2.0, 1.0], &[1.0, 1.5]).unwrap().error_bar, 1.5);
        let constant = extrapolate(&[4.0, 2.0, 1.0], &[1.0; 3]).unwrap();
        assert_eq!((constant.order, constant.error_bar), (None, 0.0));
    }

    #[test]
    fn sequences_that_say_nothing_are_refused() {
        assert_eq!(extrapolate(&[1.0], &[1.0]), None);
        assert_eq!(extrapolate(&[1.0, 1.0], &[1.0, 2.0]), None);
        assert_eq!(extrapolate(&[1.0, f64::NAN, 0.5], &[1.0, 2.0, 3.0]), None);
    }
}
