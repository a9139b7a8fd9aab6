//! Exponents of growth.

/// Exponent b of y = a xᵇ through points (x, y), both positive: the slope of the least-squares line of ln y over ln x.
/// `None` for fewer than two different x, or a number that is not positive.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    if points.iter().any(|&(x, y)| !(x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite())) {
        return None;
    }
    let logarithms: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
    let n = logarithms.len() as f64;
    let mean_x = logarithms.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = logarithms.iter().map(|p| p.1).sum::<f64>() / n;
    let covariance: f64 = logarithms.iter().map(|&(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logarithms.iter().map(|&(x, _)| (x - mean_x).powi(2)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_gives_its_exponent() {
        let points: Vec<(f64, f64)> = [4.0, 8.0, 16.0, 64.0].map(|x: f64| (x, 0.3 * x.powf(1.15))).to_vec();
        assert!((exponent(&points).unwrap() - 1.15).abs() < 1e-12);
    }

    #[test]
    fn scatter_is_averaged() {
        // ln y off the line y = x by (+d, −2d, +d) at equidistant ln x: the slope stays 1.
        let d = 0.1_f64;
        let points = [(1.0, d.exp()), (2.0, 2.0 * (-2.0 * d).exp()), (4.0, 4.0 * d.exp())];
        assert!((exponent(&points).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn too_little_gives_nothing() {
        assert_eq!(exponent(&[]), None);
        assert_eq!(exponent(&[(4.0, 1.0)]), None);
        assert_eq!(exponent(&[(4.0, 1.0), (4.0, 2.0)]), None);
        assert_eq!(exponent(&[(4.0, 1.0), (8.0, 0.0)]), None);
    }
}
