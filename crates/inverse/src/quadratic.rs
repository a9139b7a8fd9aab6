//! The quadratic programme of a step.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

/// Shares of the largest curvature that every direction has at the least: of two numbers that do the same, both change.
const LEAST_CURVATURE: f64 = 1e-10;

/// ½ p·Hp + g·p + ν Σ max(0, c + Cp), to be made small by p between two ends.
#[derive(Clone, Debug)]
pub struct Programme<'a> {
    /// H, symmetric and positive semidefinite.
    pub curvature: &'a DMatrix<f64>,
    /// g.
    pub slope: &'a DVector<f64>,
    /// c.
    pub limits: &'a DVector<f64>,
    /// C.
    pub limit_slopes: &'a DMatrix<f64>,
    /// ν.
    pub penalty: f64,
    /// Ends of p.
    pub ends: &'a [[f64; 2]],
}

impl Programme<'_> {
    /// p and the multipliers of the limits, from 0 to ν; `None` if the solver fails.
    pub fn solve(&self) -> Option<(DVector<f64>, DVector<f64>)> {
        let (n, m) = (self.slope.len(), self.limits.len());
        let most = self.curvature.diagonal().amax();
        let scale = 1.0 / self.slope.amax().max(most).max(f64::MIN_POSITIVE);
        // Unknowns are p and the excess t ≥ 0 of every limit.
        let mut curvature = vec![vec![0.0; n + m]; n + m];
        for i in 0..n {
            for j in i..n {
                curvature[i][j] = scale * self.curvature[(i, j)];
            }
            curvature[i][i] += LEAST_CURVATURE * scale * most;
        }
        let linear: Vec<f64> =
            self.slope.iter().map(|g| scale * g).chain(std::iter::repeat_n(scale * self.penalty, m)).collect();
        let (mut rows, mut bounds) = (Vec::new(), Vec::new());
        let mut add = |entries: &[(usize, f64)], bound: f64| {
            let mut row = vec![0.0; n + m];
            entries.iter().for_each(|(column, value)| row[*column] = *value);
            rows.push(row);
            bounds.push(bound);
        };
        for (i, [low, high]) in self.ends.iter().enumerate() {
            add(&[(i, 1.0)], *high);
            add(&[(i, -1.0)], -low);
        }
        for j in 0..m {
            add(&[(n + j, -1.0)], 0.0);
        }
        for j in 0..m {
            let slopes = (0..n).map(|i| (i, self.limit_slopes[(j, i)]));
            add(&slopes.chain([(n + j, -1.0)]).collect::<Vec<_>>(), -self.limits[j]);
        }
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-12,
            tol_gap_rel: 1e-12,
            tol_feas: 1e-12,
            ..DefaultSettings::default()
        };
        let cones = [SupportedConeT::NonnegativeConeT(rows.len())];
        let (curvature, rows) = (CscMatrix::from(&curvature), CscMatrix::from(&rows));
        let mut solver = DefaultSolver::new(&curvature, &linear, &rows, &bounds, &cones, settings).ok()?;
        solver.solve();
        // "Almost" means short of digits that a step does not need: it is judged by the design to which it leads.
        let is_solved = matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
        );
        let p = solver.solution.x.get(..n)?.iter().zip(self.ends).map(|(p, [low, high])| p.clamp(*low, *high));
        let p = DVector::from_iterator(n, p);
        let multipliers = solver.solution.z.iter().skip(2 * n + m).map(|z| (z / scale).max(0.0));
        let multipliers = DVector::from_iterator(m, multipliers);
        (is_solved && p.iter().all(|p| p.is_finite())).then_some((p, multipliers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_hold_where_they_can_and_are_exceeded_least_where_they_cannot() {
        // The nearest point to (3, 2) with x + y ≤ 1 is (1, 0), by Lagrange with the multiplier 2.
        let curvature = DMatrix::identity(2, 2);
        let slope = DVector::from_vec(vec![-3.0, -2.0]);
        let limits = DVector::from_vec(vec![-1.0]);
        let limit_slopes = DMatrix::from_row_slice(1, 2, &[1.0, 1.0]);
        let with = |penalty: f64, ends: [[f64; 2]; 2]| {
            let programme = Programme {
                curvature: &curvature,
                slope: &slope,
                limits: &limits,
                limit_slopes: &limit_slopes,
                penalty,
                ends: &ends,
            };
            let (p, multipliers) = programme.solve().unwrap();
            [p[0], p[1], multipliers[0]]
        };
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
        let wide = [[-9.0, 9.0]; 2];
        assert!(near(with(100.0, wide), [1.0, 0.0, 2.0]));
        // A limit that costs less than what it is worth gives way.
        assert!(near(with(0.5, wide), [2.5, 1.5, 0.5]));
        // Where no point holds it: the nearest one to it.
        assert!(near(with(100.0, [[1.0, 2.0], [1.0, 2.0]]), [1.0, 1.0, 100.0]));
    }
}
