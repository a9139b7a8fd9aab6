//! Unknowns beside the displacements: pressures of cavities whose volume or amount of gas is given, multipliers of linear equations.
//!
//! Each comes with one equation g(u, y) = 0 and acts on the body along a column B of forces, r(u, y) = r(u) + y B(u):
//!
//! | unknown y | equation g | column B |
//! |---|---|---|
//! | pressure p (volume given) | V − V₀ − ΔV(t) | −∂V/∂u |
//! | pressure p (gas given) | p + p₀ − m(t) p₀ (V₀/V)ⁿ | −∂V/∂u |
//! | multiplier | cᵀu − b(t) | c |
//!
//! With g linearised as g + s Bᵀδu + h δy, the columns Y = −K⁻¹B, and a = −K⁻¹r the bordered system leaves
//! (h + s BᵀY) δy = −g − s Bᵀa, a system as small as there are such unknowns, and δu = a + Y δy.
//!
//! The inertia of the whole is that of K and of the Schur complement: the equilibrium is stable under its constraints if K and
//! h/s + BᵀY have as many negative eigenvalues together as there are unknowns here.

use nalgebra::{DMatrix, DVector};
use pneuflex_model::{Curve, Gas};

/// One equation at a state.
#[derive(Clone, Debug)]
pub struct Row {
    /// g, in the unit of `scale`.
    pub value: f64,
    /// s: derivative of g along the column.
    pub along_column: f64,
    /// h: derivative of g by the unknown itself.
    pub by_unknown: f64,
    /// What g is small against.
    pub scale: f64,
    /// B over all degrees of freedom, N per unit of the unknown.
    pub column: Vec<[f64; 3]>,
}

/// What determines the pressure of a cavity that is no given function of time.
#[derive(Clone, Debug)]
pub enum Supply {
    /// Change of the volume, mm³.
    Volume(Curve),
    /// Gas.
    Gas(Gas),
}

impl Supply {
    /// g, s and h at a time for a volume (mm³), its value at rest and a pressure (MPa); the column is −∂V/∂u.
    pub fn row(&self, time: f64, [volume, at_rest]: [f64; 2], pressure: f64, column: Vec<[f64; 3]>) -> Row {
        match self {
            Self::Volume(change) => Row {
                value: volume - at_rest - change.at(time),
                along_column: -1.0,
                by_unknown: 0.0,
                scale: at_rest,
                column,
            },
            Self::Gas(Gas { atmosphere, exponent, amount }) => {
                // A volume that a bad guess turns negative has the pressure of a very small one.
                let ratio = at_rest / volume.max(1e-3 * at_rest);
                let absolute = amount.at(time) * atmosphere * ratio.powf(*exponent);
                Row {
                    value: pressure + atmosphere - absolute,
                    along_column: -exponent * absolute * ratio / at_rest,
                    by_unknown: 1.0,
                    scale: *atmosphere,
                    column,
                }
            }
        }
    }
}

/// δy for the columns Y and the correction a; `None` if the small system is singular.
pub fn eliminate(rows: &[Row], responses: &[Vec<f64>], correction: &[f64]) -> Option<Vec<f64>> {
    let m = rows.len();
    let matrix = DMatrix::from_fn(m, m, |i, j| {
        let own = if i == j { rows[i].by_unknown } else { 0.0 };
        own + rows[i].along_column * dot(rows[i].column.as_flattened(), &responses[j])
    });
    let rhs = DVector::from_fn(m, |i, _| {
        -rows[i].value - rows[i].along_column * dot(rows[i].column.as_flattened(), correction)
    });
    let solution = matrix.lu().solve(&rhs)?;
    solution.iter().all(|x| x.is_finite()).then(|| solution.iter().copied().collect())
}

/// Negative eigenvalues of the Schur complement h/s + BᵀY.
pub fn negative_eigenvalues(rows: &[Row], responses: &[Vec<f64>]) -> usize {
    let m = rows.len();
    let entry = |i: usize, j: usize| dot(rows[i].column.as_flattened(), &responses[j]);
    let schur = DMatrix::from_fn(m, m, |i, j| {
        let own = if i == j { rows[i].by_unknown / rows[i].along_column } else { 0.0 };
        own + 0.5 * (entry(i, j) + entry(j, i))
    });
    schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_linearised_by_their_derivatives() {
        let gas = Gas { atmosphere: 0.1, exponent: 1.4, amount: Curve::constant(1.7) };
        for supply in [Supply::Volume(Curve::Proportional(3.0)), Supply::Gas(gas)] {
            let at = |volume: f64, pressure: f64| supply.row(2.0, [volume, 50.0], pressure, Vec::new());
            let (here, h) = (at(60.0, 0.02), 1e-4);
            assert!(here.value.abs() > 1e-3, "the check would be empty");
            // The column is −∂V/∂u: along it the volume falls.
            let by_volume = (at(60.0 + h, 0.02).value - at(60.0 - h, 0.02).value) / (2.0 * h);
            let by_pressure = (at(60.0, 0.02 + h).value - at(60.0, 0.02 - h).value) / (2.0 * h);
            assert!((by_volume + here.along_column).abs() < 1e-9, "{by_volume}");
            assert!((by_pressure - here.by_unknown).abs() < 1e-9);
        }
    }
}
