//! Sums over all blocks of a contact model.

use pneuflex_contact::{ContactModel, Touching, evaluate_block};

/// Sums over a whole model.
pub struct Total {
    /// mJ.
    pub energy: f64,
    /// Forces, N.
    pub gradient: Vec<f64>,
    /// Stiffness, N/mm.
    pub hessian: Vec<Vec<f64>>,
}

/// Energy, forces and stiffness of all that touches.
pub fn total(model: &ContactModel, positions: &[[f64; 3]]) -> Total {
    let n = 3 * positions.len();
    let mut total = Total { energy: 0.0, gradient: vec![0.0; n], hessian: vec![vec![0.0; n]; n] };
    let Touching { blocks, averages } = model.search(positions);
    for gap in averages {
        total.energy += gap.energy();
        let dofs: Vec<(usize, f64)> = (gap.nodes.iter().zip(&gap.gradient))
            .flat_map(|(&node, gradient)| (0..3).map(move |k| (3 * node as usize + k, gradient[k])))
            .collect();
        for &(p, of_row) in &dofs {
            for &(q, of_column) in &dofs {
                total.hessian[p][q] += gap.tangent_factor() * of_row * of_column;
            }
        }
    }
    for block in blocks {
        let out = evaluate_block(model, &block, positions, true);
        total.energy += out.energy;
        let dofs: Vec<usize> =
            block.nodes.iter().flat_map(|&node| (0..3).map(move |k| 3 * node as usize + k)).collect();
        for (i, &p) in dofs.iter().enumerate() {
            total.gradient[p] += out.residual[i];
            for (j, &q) in dofs.iter().enumerate() {
                total.hessian[p][q] += out.tangent[i * dofs.len() + j];
            }
        }
    }
    total
}
