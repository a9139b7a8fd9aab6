//! Sums over all blocks of a contact model.

use pneuflex_contact::{ContactModel, Touching, evaluate_block};

/// Sums over a whole model.
pub struct Total {
    /// mJ.
    pub energy: f64,
    /// Forces, N.
    pub gradient: Vec<f64>,
    /// Stiffness, N/mm; empty if it was not asked for.
    pub hessian: Vec<Vec<f64>>,
}

/// Energy, forces and stiffness of all that touches.
pub fn total(model: &ContactModel, positions: &[[f64; 3]]) -> Total {
    let n = 3 * positions.len();
    sum(model, positions, vec![vec![0.0; n]; n])
}

/// Energy and forces of all that touches: what differences need, in a tenth of the time.
fn forces(model: &ContactModel, positions: &[[f64; 3]]) -> Total {
    sum(model, positions, Vec::new())
}

fn sum(model: &ContactModel, positions: &[[f64; 3]], hessian: Vec<Vec<f64>>) -> Total {
    let with_tangent = !hessian.is_empty();
    let mut total = Total { energy: 0.0, gradient: vec![0.0; 3 * positions.len()], hessian };
    let Touching { blocks, averages } = model.search(positions);
    for gap in averages {
        total.energy += gap.energy();
        let dofs: Vec<(usize, f64)> = (gap.nodes.iter().zip(&gap.gradient))
            .flat_map(|(&node, gradient)| (0..3).map(move |k| (3 * node as usize + k, gradient[k])))
            .collect();
        for &(p, of_row) in &dofs {
            for &(q, of_column) in dofs.iter().filter(|_| with_tangent) {
                total.hessian[p][q] += gap.tangent_factor() * of_row * of_column;
            }
        }
    }
    for block in blocks {
        let out = evaluate_block(model, &block, positions, with_tangent);
        total.energy += out.energy;
        let dofs: Vec<usize> =
            block.nodes.iter().flat_map(|&node| (0..3).map(move |k| 3 * node as usize + k)).collect();
        for (i, &p) in dofs.iter().enumerate() {
            total.gradient[p] += out.residual[i];
            for (j, &q) in dofs.iter().enumerate().filter(|_| with_tangent) {
                total.hessian[p][q] += out.tangent[i * dofs.len() + j];
            }
        }
    }
    total
}

/// Directions in which every node moves, without a pattern: a wrong entry shows in all of them.
fn directions(num_dofs: usize) -> impl Iterator<Item = Vec<f64>> {
    const COUNT: usize = 8;
    // Weyl's sequence, of which no two directions have the same part.
    let value = |i: usize| 2.0 * (0.618_033_988_749_895 * (i + 1) as f64).fract() - 1.0;
    (0..COUNT).map(move |k| (0..num_dofs).map(|dof| value(k * num_dofs + dof)).collect())
}

/// Force and tangent against central differences of energy and force, in a state in which there is something to differentiate.
#[track_caller]
pub fn check_derivatives(model: &ContactModel, positions: &[[f64; 3]], what: &str) {
    let here = total(model, positions);
    let largest = here.gradient.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let stiffest = here.hessian.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(here.energy > 1e-3 && largest > 1e-2 && stiffest > 0.1, "nothing touches: {what}");
    for (k, direction) in directions(3 * positions.len()).enumerate() {
        let shifted = |by: f64| {
            let mut moved = positions.to_vec();
            moved.as_flattened_mut().iter_mut().zip(&direction).for_each(|(x, d)| *x += by * d);
            forces(model, &moved)
        };
        let along = |row: &[f64]| -> f64 { row.iter().zip(&direction).map(|(value, d)| value * d).sum() };
        let h = 1e-6;
        let (low, high) = (shifted(-h), shifted(h));
        let (slope, exact) = ((high.energy - low.energy) / (2.0 * h), along(&here.gradient));
        assert!((slope - exact).abs() < 1e-7 * largest.max(1.0), "{what} force along {k}: {exact} against {slope}");
        for (dof, row) in here.hessian.iter().enumerate() {
            let (slope, exact) = ((high.gradient[dof] - low.gradient[dof]) / (2.0 * h), along(row));
            assert!((slope - exact).abs() < 1e-6 * stiffest, "{what} tangent {dof} along {k}: {exact} against {slope}");
        }
    }
    for (p, row) in here.hessian.iter().enumerate() {
        for (q, value) in row.iter().enumerate() {
            assert!((value - here.hessian[q][p]).abs() < 1e-12 * stiffest, "{what} {p} {q}");
        }
    }
}
