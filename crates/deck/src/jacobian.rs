//! Elements that are turned inside out at rest.

use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{Mesh, shape};

/// Elements whose Jacobian is not positive at every point where their energy is integrated, each with its smallest.
pub(crate) fn inverted_elements(mesh: &Mesh) -> Vec<(usize, f64)> {
    let gradients = mesh.per_kind(|kind| {
        let rule = (kind.volume_rule)();
        rule.iter().map(|(xi, _)| shape::tabulate(kind, *xi).1).collect::<Vec<_>>()
    });
    let inverted = |element: usize| {
        let jacobians: Vec<f64> =
            gradients[mesh.kind_of(element)].iter().map(|at| determinant(&mesh.jacobian(element, at))).collect();
        // Overflow leaves no number.
        let is_good = jacobians.iter().all(|&jacobian| jacobian > 0.0 && jacobian.is_finite());
        (!is_good).then(|| (element, jacobians.into_iter().fold(f64::INFINITY, f64::min)))
    };
    (0..mesh.num_elements()).filter_map(inverted).collect()
}
