//! Linear least squares under linear inequalities, as a quadratic programme.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

use crate::regression::Reduced;

/// The unknowns that fit best among those with `form · x ≥ bound` for every form; `None` if there are none or the solver stops.
///
/// With z = R s the programme is ½‖z‖² − (Qᵀb)·z under G R⁻¹ z ≥ h: a projection, as well conditioned as it can be.
pub fn solve(reduced: &Reduced, forms: &[Vec<f64>], bound: f64) -> Option<Vec<f64>> {
    let n = reduced.scale.len();
    let length = reduced.right.norm();
    if length == 0.0 {
        return None;
    }
    let inverse = reduced.r.clone().try_inverse()?;
    let forms = DMatrix::from_fn(forms.len(), n, |i, j| forms[i][j] / reduced.scale[j]) * inverse;
    let mut rows = Vec::with_capacity(forms.nrows());
    let mut bounds = Vec::with_capacity(forms.nrows());
    for form in forms.row_iter() {
        let norm = form.norm();
        // Signs as the solver wants them: −G z + slack = −h, slack ≥ 0.
        rows.push(form.iter().map(|g| -g / norm).collect::<Vec<f64>>());
        bounds.push(-bound / (norm * length));
    }
    let linear: Vec<f64> = reduced.right.iter().map(|b| -b / length).collect();
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-13,
        tol_gap_rel: 1e-13,
        tol_feas: 1e-13,
        ..DefaultSettings::default()
    };
    let matrix = CscMatrix::from(&rows);
    let cones = [SupportedConeT::NonnegativeConeT(rows.len())];
    let mut solver = DefaultSolver::new(&CscMatrix::identity(n), &linear, &matrix, &bounds, &cones, settings).ok()?;
    solver.solve();
    // "Almost" means short of digits that a fit does not need; the caller checks the conditions.
    if !matches!(
        solver.solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
    ) {
        return None;
    }
    reduced.unknowns(&(DVector::from_vec(solver.solution.x.clone()) * length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Reduced {
        Reduced::new(&[vec![1.0, 0.0], vec![0.0, 2.0]], &[3.0, -4.0], &[1.0, 1.0], &[1.0, 1.0]).unwrap()
    }

    #[test]
    fn the_nearest_point_of_a_half_plane_is_found() {
        // minimise (x − 3)² + (2y + 4)² with x + y ≥ 4: Lagrange gives x = 3 + m/2, y = −2 + m/8, m = 24/5.
        let found = solve(&identity(), &[vec![1.0, 1.0]], 4.0).unwrap();
        assert!((found[0] - 5.4).abs() < 1e-9 && (found[1] + 1.4).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn conditions_that_hold_anyway_change_nothing_and_contradictions_are_refused() {
        let found = solve(&identity(), &[vec![1.0, 0.0], vec![0.0, 1.0]], -5.0).unwrap();
        assert!((found[0] - 3.0).abs() < 1e-9 && (found[1] + 2.0).abs() < 1e-9, "{found:?}");
        assert!(solve(&identity(), &[vec![1.0, 0.0], vec![-1.0, 0.0]], 1.0).is_none());
    }
}
