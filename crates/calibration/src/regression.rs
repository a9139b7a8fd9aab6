//! Weighted linear least squares through QR and SVD, with the usual statistics.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Ratio of the smallest to the largest singular value (columns scaled to 1) below which constants are not determined.
const RANK_TOLERANCE: f64 = 1e-10;

/// Ax ≈ b with the rows weighted, reduced to as many rows as there are unknowns: ‖Ax − b‖² = ‖Rs − Qᵀb‖² + rest, x = s / scale.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// R of the QR factorisation of A with columns scaled to length 1.
    pub r: DMatrix<f64>,
    /// Qᵀ b.
    pub right: DVector<f64>,
    /// Lengths of the columns of A.
    pub scale: Vec<f64>,
    /// Σ w (Ax − b)² at the best x.
    pub rest: f64,
    /// Rows.
    pub rows: usize,
    /// Qᵀ D Q with the weights D over those that are inverse to the rows' variances.
    of_variances: DMatrix<f64>,
    /// tr D.
    sum_of_ratios: f64,
}

/// Standard errors of the unknowns and what follows from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Rows minus unknowns.
    pub degrees_of_freedom: usize,
    /// Standard errors.
    pub standard_errors: Vec<f64>,
    /// Half widths of the 95 % confidence intervals (Student's t).
    pub half_widths: Vec<f64>,
    /// Correlations of the estimates.
    pub correlation: Vec<Vec<f64>>,
}

impl Reduced {
    /// Reduces the problem; `None` if there are too few rows, columns without numbers, or columns that depend on each other. `ratios` are the
    /// weights over those that are inverse to the rows' variances: 1 for weights that follow from the noise alone.
    pub fn new(rows: &[Vec<f64>], right: &[f64], weights: &[f64], ratios: &[f64]) -> Option<Self> {
        let columns = rows.first()?.len();
        if rows.len() < columns {
            return None;
        }
        let mut a = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j] * weights[i].sqrt());
        let b = DVector::from_fn(rows.len(), |i, _| right[i] * weights[i].sqrt());
        let scale: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
        if !scale.iter().all(|s| s.is_finite() && *s > 0.0) || !b.norm().is_finite() {
            return None;
        }
        for (j, s) in scale.iter().enumerate() {
            a.column_mut(j).unscale_mut(*s);
        }
        let qr = a.qr();
        let mut rotated = b;
        qr.q_tr_mul(&mut rotated);
        let q = qr.q();
        let scaled = DMatrix::from_fn(rows.len(), columns, |i, j| ratios[i] * q[(i, j)]);
        let of_variances = q.tr_mul(&scaled);
        let r = qr.unpack_r();
        let singular = r.clone().svd(false, false).singular_values;
        if singular.min() < RANK_TOLERANCE * singular.max() {
            return None;
        }
        let rest = rotated.rows(columns, rotated.len() - columns).norm_squared();
        Some(Self {
            r,
            right: rotated.rows(0, columns).into_owned(),
            scale,
            rest,
            rows: rows.len(),
            of_variances,
            sum_of_ratios: ratios.iter().sum(),
        })
    }

    /// The unknowns that belong to s = R⁻¹ z.
    pub fn unknowns(&self, z: &DVector<f64>) -> Option<Vec<f64>> {
        let solved = self.r.solve_upper_triangular(z)?;
        Some(solved.iter().zip(&self.scale).map(|(s, scale)| s / scale).collect())
    }

    /// The best unknowns.
    pub fn solve(&self) -> Option<Vec<f64>> {
        self.unknowns(&self.right)
    }

    /// Statistics of the best unknowns, if rows are independent with the variances that were supposed: σ² R⁻¹ Qᵀ D Q R⁻ᵀ, with σ² from
    /// E ‖Ax − b‖² = σ² (tr D − tr Qᵀ D Q); `None` without a degree of freedom.
    pub fn statistics(&self) -> Option<Statistics> {
        let columns = self.scale.len();
        let degrees_of_freedom = self.rows.checked_sub(columns).filter(|d| *d > 0)?;
        let inverse = self.r.clone().try_inverse()?;
        let variance = self.rest / (self.sum_of_ratios - self.of_variances.trace());
        let covariance = &inverse * &self.of_variances * inverse.transpose();
        let deviation: Vec<f64> = (0..columns).map(|i| covariance[(i, i)].sqrt()).collect();
        let standard_errors: Vec<f64> = (0..columns).map(|i| variance.sqrt() * deviation[i] / self.scale[i]).collect();
        let quantile = StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).ok()?.inverse_cdf(0.975);
        let correlation = (0..columns)
            .map(|i| (0..columns).map(|j| covariance[(i, j)] / (deviation[i] * deviation[j])).collect())
            .collect();
        let half_widths = standard_errors.iter().map(|s| quantile * s).collect();
        Some(Statistics { degrees_of_freedom, standard_errors, half_widths, correlation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_has_the_textbooks_statistics() {
        // y = a + b x: b = Sxy / Sxx, se(b) = s / √Sxx, se(a) = s √(1/n + x̄² / Sxx), corr = −x̄ / √(Σx²/n).
        let x = [1.0, 2.0, 3.0, 4.0, 6.0];
        let y = [1.1, 1.9, 3.2, 3.9, 6.3];
        let n = 5.0;
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let sxx: f64 = x.iter().map(|v| (v - mx) * (v - mx)).sum();
        let sxy: f64 = x.iter().zip(y).map(|(v, w)| (v - mx) * (w - my)).sum();
        let b = sxy / sxx;
        let a = my - b * mx;
        let rest: f64 = x.iter().zip(y).map(|(v, w)| (w - a - b * v).powi(2)).sum();
        let s = (rest / 3.0).sqrt();
        let rows: Vec<Vec<f64>> = x.iter().map(|v| vec![1.0, *v]).collect();
        let reduced = Reduced::new(&rows, &y, &[1.0; 5], &[1.0; 5]).unwrap();
        let found = reduced.solve().unwrap();
        let statistics = reduced.statistics().unwrap();
        assert!((found[0] - a).abs() < 1e-13 && (found[1] - b).abs() < 1e-13);
        assert!((reduced.rest - rest).abs() < 1e-13);
        let errors = [s * (1.0 / n + mx * mx / sxx).sqrt(), s / sxx.sqrt()];
        for (i, error) in errors.into_iter().enumerate() {
            assert!((statistics.standard_errors[i] - error).abs() < 1e-13);
            // Two-sided 95 % quantile of Student's t with 3 degrees of freedom.
            assert!((statistics.half_widths[i] / error - 3.182_446_305_284_263).abs() < 1e-9);
        }
        let squares: f64 = x.iter().map(|v| v * v).sum();
        assert!((statistics.correlation[0][1] + mx / (squares / n).sqrt()).abs() < 1e-13);
        assert_eq!(statistics.degrees_of_freedom, 3);
    }

    #[test]
    fn a_weight_of_two_is_a_row_written_twice() {
        let rows = |twice: bool| {
            let mut rows = vec![vec![1.0, 1.0], vec![1.0, 2.0], vec![1.0, 4.0]];
            if twice {
                rows.push(rows[1].clone());
            }
            rows
        };
        let weighted = Reduced::new(&rows(false), &[1.0, 3.0, 4.0], &[1.0, 2.0, 1.0], &[1.0; 3]).unwrap();
        let repeated = Reduced::new(&rows(true), &[1.0, 3.0, 4.0, 3.0], &[1.0; 4], &[1.0; 4]).unwrap();
        for (a, b) in weighted.solve().unwrap().iter().zip(repeated.solve().unwrap()) {
            assert!((a - b).abs() < 1e-13);
        }
        assert!((weighted.rest - repeated.rest).abs() < 1e-13);
    }

    #[test]
    fn dependent_columns_and_missing_rows_are_noticed() {
        assert!(
            Reduced::new(&[vec![1.0, 2.0], vec![2.0, 4.0], vec![3.0, 6.0]], &[1.0; 3], &[1.0; 3], &[1.0; 3]).is_none()
        );
        assert!(Reduced::new(&[vec![1.0, 2.0]], &[1.0], &[1.0], &[1.0]).is_none());
        assert!(Reduced::new(&[vec![f64::INFINITY]], &[1.0], &[1.0], &[1.0]).is_none());
        let exact = Reduced::new(&[vec![1.0, 2.0], vec![2.0, 1.0]], &[1.0; 2], &[1.0; 2], &[1.0; 2]).unwrap();
        assert!(exact.statistics().is_none());
    }
}
