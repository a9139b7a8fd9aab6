//! Where searches begin, and which of their ends is the best one.

use pneuflex_sweep::space::sobol_points;

use crate::minimise::{Judged, TOLERANCE};

/// Starts that a search may have.
pub const MOST_STARTS: i64 = 100;

/// Points that are tried for a start that has results.
const TRIES: usize = 5;

/// Seed of the points.
const SEED: u64 = 0;

/// Points between bounds at which searches may begin, the given one first and then those of a scrambled Sobol sequence: more than are asked for,
/// because some make no body.
pub fn points(given: &[f64], bounds: &[[f64; 2]], starts: usize) -> Vec<Vec<f64>> {
    let count = if starts > 1 { TRIES * starts } else { 0 };
    let between = |(x, [from, to]): (f64, &[f64; 2])| (from + x * (to - from)).clamp(*from, *to);
    let point = |unit: Vec<f64>| unit.into_iter().zip(bounds).map(between).collect();
    std::iter::once(given.to_vec()).chain(sobol_points(bounds.len(), count, SEED).into_iter().map(point)).collect()
}

/// Whether a design is better than another one: nearer to holding all limits, and of those that hold them with the lesser objective.
pub fn is_better(one: &Judged, other: &Judged) -> bool {
    let rank = |judged: &Judged| (judged.violation().max(TOLERANCE), judged.objective());
    let ((broken, objective), (other_broken, other_objective)) = (rank(one), rank(other));
    broken < other_broken || broken == other_broken && objective < other_objective
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn points_lie_between_the_bounds_and_more_of_them_begin_with_the_same() {
        let bounds = [[1.0, 2.0], [-3.0, -1.0]];
        let few = points(&[1.5, -2.0], &bounds, 2);
        assert_eq!((few.len(), &few[0]), (11, &vec![1.5, -2.0]));
        for point in &few {
            assert!(point.iter().zip(bounds).all(|(x, [from, to])| (from..=to).contains(x)), "{point:?}");
        }
        assert_eq!(points(&[1.5, -2.0], &bounds, 4)[..11], few[..]);
        assert_eq!(points(&[1.5, -2.0], &bounds, 1).len(), 1);
    }

    #[test]
    fn limits_count_before_the_objective() {
        let judged = |extreme: f64, limit: f64| Judged {
            residuals: DVector::zeros(0),
            jacobian: DMatrix::zeros(0, 1),
            extreme,
            extreme_slope: DVector::zeros(1),
            limits: DVector::from_vec(vec![limit]),
            limit_slopes: DMatrix::zeros(1, 1),
            is_met: false,
        };
        assert!(is_better(&judged(2.0, -1.0), &judged(1.0, 0.5)));
        assert!(is_better(&judged(1.0, -1.0), &judged(2.0, -2.0)));
        assert!(is_better(&judged(9.0, 0.1), &judged(1.0, 0.2)));
        assert!(!is_better(&judged(1.0, 0.0), &judged(1.0, 0.0)));
    }
}
