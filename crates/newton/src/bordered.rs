//! Unknowns beside the displacements border the tangent (theory §6.5): pressures of cavities whose volume or gas is given, multipliers of linear
//! equations. Their equations are the contributions' ([`BorderedEquation`]); here they are solved.
//!
//! With g linearised as g + s Bᵀδu + h δy, the columns Y = −K⁻¹B, and a = −K⁻¹r the bordered system leaves
//! (h + s BᵀY) δy = −g − s Bᵀa, a system as small as there are such unknowns, and δu = a + Y δy.
//!
//! The inertia of the whole is that of K and of the Schur complement: the equilibrium is stable under its constraints if K and
//! h/s + BᵀY have as many negative eigenvalues together as there are unknowns here.

use nalgebra::{DMatrix, DVector};
use pneuflex_assembly::BorderedEquation;

/// δy for the columns Y and the correction a; `None` if the small system is singular.
pub fn eliminate(equations: &[BorderedEquation], responses: &[Vec<f64>], correction: &[f64]) -> Option<Vec<f64>> {
    let m = equations.len();
    let matrix = DMatrix::from_fn(m, m, |i, j| {
        let own = if i == j { equations[i].by_unknown } else { 0.0 };
        own + equations[i].along_column * dot(equations[i].column.as_flattened(), &responses[j])
    });
    let rhs = DVector::from_fn(m, |i, _| {
        -equations[i].value - equations[i].along_column * dot(equations[i].column.as_flattened(), correction)
    });
    let solution = matrix.lu().solve(&rhs)?;
    solution.iter().all(|x| x.is_finite()).then(|| solution.iter().copied().collect())
}

/// Negative eigenvalues of the Schur complement h/s + BᵀY.
pub fn negative_eigenvalues(equations: &[BorderedEquation], responses: &[Vec<f64>]) -> usize {
    let m = equations.len();
    let entry = |i: usize, j: usize| dot(equations[i].column.as_flattened(), &responses[j]);
    let schur = DMatrix::from_fn(m, m, |i, j| {
        let own = if i == j { equations[i].by_unknown / equations[i].along_column } else { 0.0 };
        own + 0.5 * (entry(i, j) + entry(j, i))
    });
    schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count()
}

/// Largest violation of the equations, relative to what they are small against.
pub fn violation(equations: &[BorderedEquation]) -> f64 {
    equations.iter().fold(0.0, |largest, equation| largest.max(equation.value.abs() / equation.scale))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// K = 2 · 1, one equation g + Bᵀδu = 0 with B along the first axis: the solution is exact.
    #[test]
    fn a_bordered_system_is_solved_and_its_inertia_found() {
        let column = vec![[1.0, 0.0, 0.0], [0.0; 3]];
        let equation = BorderedEquation { value: 3.0, along_column: 1.0, by_unknown: 0.0, scale: 2.0, column };
        let responses = vec![vec![-0.5, 0.0, 0.0, 0.0, 0.0, 0.0]];
        let correction = [1.0, 0.0, 0.0, 0.0, 0.0, 4.0];
        let found = eliminate(std::slice::from_ref(&equation), &responses, &correction).unwrap();
        assert_eq!(found, [8.0]);
        // δu = a + Y δy satisfies the equation.
        assert_eq!(equation.value + correction[0] + responses[0][0] * found[0], 0.0);
        assert_eq!(negative_eigenvalues(std::slice::from_ref(&equation), &responses), 1);
        assert_eq!(violation(std::slice::from_ref(&equation)), 1.5);
        let repeated = [equation.clone(), equation];
        let twice = [responses[0].clone(), responses[0].clone()];
        assert_eq!(eliminate(&repeated, &twice, &correction), None);
    }
}
