//! The generalised minimal residual method (Saad & Schultz 1986, *SIAM J. Sci. Stat. Comput.* 7, 856), for the few unsymmetric terms
//! that the factor of a symmetric tangent lacks: with that factor as preconditioner the operator is the identity plus something of low
//! rank, and a few dozen vectors do.

/// Relative residual that is aimed at.
const TOLERANCE: f64 = 1e-11;

/// Relative residual up to which a correction of Newton's method still contracts as well as an exact one does for all practical purposes.
const ACCEPTED: f64 = 1e-6;

/// Vectors at the most.
const MOST_VECTORS: usize = 200;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// x.
    pub x: Vec<f64>,
    /// ‖A x − b‖ / ‖b‖.
    pub relative_residual: f64,
}

/// The residual is not small enough to be of use.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the unsymmetric part of the tangent is too large to be solved with the factor of the symmetric one \
     (relative residual {relative_residual:.1e} after {MOST_VECTORS} vectors at the most)"
)]
pub struct NotConverged {
    /// What is left, relative to the right-hand side.
    pub relative_residual: f64,
}

impl Solution {
    /// The solution, if its residual is small enough for a correction of Newton's method.
    ///
    /// # Errors
    /// [`NotConverged`] if it is not.
    pub fn or_not_converged(self) -> Result<Vec<f64>, NotConverged> {
        // Written so that a NaN is refused too.
        if self.relative_residual <= ACCEPTED {
            Ok(self.x)
        } else {
            Err(NotConverged { relative_residual: self.relative_residual })
        }
    }
}

/// Solves A x = b for x, starting at zero; what was reached is returned if b was not.
///
/// # Errors
/// Those of `apply`, which yields A times a vector.
pub fn solve<E>(rhs: &[f64], mut apply: impl FnMut(&[f64]) -> Result<Vec<f64>, E>) -> Result<Solution, E> {
    let norm = dot(rhs, rhs).sqrt();
    if norm == 0.0 || !norm.is_finite() {
        return Ok(Solution { x: rhs.to_vec(), relative_residual: 0.0 * norm });
    }
    let mut basis = vec![rhs.iter().map(|x| x / norm).collect::<Vec<f64>>()];
    // Upper triangle, column by column, and the rotations that made it one.
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<[f64; 2]> = Vec::new();
    let mut projected = vec![norm];
    while triangle.len() < MOST_VECTORS {
        let mut next = apply(&basis[triangle.len()])?;
        let mut column = Vec::with_capacity(basis.len() + 1);
        for vector in &basis {
            let part = dot(vector, &next);
            subtract(&mut next, part, vector);
            column.push(part);
        }
        // Once more, for what rounding left.
        for (vector, sum) in basis.iter().zip(&mut column) {
            let part = dot(vector, &next);
            subtract(&mut next, part, vector);
            *sum += part;
        }
        let mut length = dot(&next, &next).sqrt();
        for (i, &[cosine, sine]) in rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (cosine * a + sine * b, cosine * b - sine * a);
        }
        let last = column.len() - 1;
        let hypotenuse = column[last].hypot(length);
        if hypotenuse == 0.0 || !hypotenuse.is_finite() {
            break;
        }
        let [cosine, sine] = [column[last] / hypotenuse, length / hypotenuse];
        column[last] = hypotenuse;
        rotations.push([cosine, sine]);
        triangle.push(column);
        projected.push(-sine * projected[last]);
        projected[last] *= cosine;
        if projected[last + 1].abs() <= TOLERANCE * norm {
            break;
        }
        length = length.max(f64::MIN_POSITIVE);
        basis.push(next.iter().map(|x| x / length).collect());
    }
    let mut solution = vec![0.0; rhs.len()];
    let mut coefficients = vec![0.0; triangle.len()];
    for i in (0..triangle.len()).rev() {
        let known: f64 = (i + 1..triangle.len()).map(|j| triangle[j][i] * coefficients[j]).sum();
        coefficients[i] = (projected[i] - known) / triangle[i][i];
        subtract(&mut solution, -coefficients[i], &basis[i]);
    }
    // The estimate that comes with the projection is no use where A is nearly singular.
    let mut left = apply(&solution)?;
    subtract(&mut left, 1.0, rhs);
    Ok(Solution { x: solution, relative_residual: dot(&left, &left).sqrt() / norm })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], factor: f64, vector: &[f64]) {
    for (x, y) in from.iter_mut().zip(vector) {
        *x -= factor * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full matrix in as many steps as it has rows; the identity plus a skew part of rank two in three.
    #[test]
    fn small_systems_are_solved() {
        let n = 12;
        let full = |i: usize, j: usize| (0.7 * i as f64 - 0.3 * (j * j) as f64).sin() + if i == j { 2.0 } else { 0.0 };
        let (u, v) = (|i: usize| (i as f64).cos(), |i: usize| 1.0 / (1.0 + i as f64));
        let low_rank = |i: usize, j: usize| f64::from(u8::from(i == j)) + 5.0 * (u(i) * v(j) - v(i) * u(j));
        let check = |matrix: &dyn Fn(usize, usize) -> f64, most: usize| {
            let row = |i: usize, x: &[f64]| -> f64 { (0..n).map(|j| matrix(i, j) * x[j]).sum() };
            let product = |x: &[f64]| -> Vec<f64> { (0..n).map(|i| row(i, x)).collect() };
            let exact: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sqrt()).collect();
            let mut products = 0;
            let found = solve::<()>(&product(&exact), |x| {
                products += 1;
                Ok(product(x))
            });
            for (a, b) in found.unwrap().or_not_converged().unwrap().iter().zip(&exact) {
                assert!((a - b).abs() < 1e-9, "{a} {b}");
            }
            assert!(products <= most, "{products}");
        };
        // One product more, for the residual.
        check(&full, 13);
        check(&low_rank, 4);
        assert_eq!(solve::<()>(&[0.0; 3], |_| Err(())).unwrap().x, vec![0.0; 3]);
    }

    /// A singular system has no solution, and says so.
    #[test]
    fn what_is_not_solved_is_said() {
        // A projection onto the plane x = 0.
        let found = solve::<()>(&[1.0, 1.0, 0.0], |x| Ok(vec![0.0, x[1], x[2]])).unwrap();
        assert!(found.relative_residual > 0.5, "{found:?}");
        assert!(found.or_not_converged().is_err());
        let undefined = solve::<()>(&[f64::NAN, 1.0], |x| Ok(x.to_vec())).unwrap();
        assert!(undefined.or_not_converged().is_err());
    }
}
