//! Elements that are turned inside out at rest.

use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{Mesh, shape};

/// Elements whose Jacobian is not positive at every point where their energy is integrated, each with its smallest.
pub(crate) fn inverted_elements(mesh: &Mesh) -> Vec<(usize, f64)> {
    let rule = (mesh.kind.volume_rule)();
    let gradients: Vec<_> = rule.iter().map(|(xi, _)| shape::tabulate(mesh.kind, *xi).1).collect();
    let inverted = |element: usize| {
        let jacobians: Vec<f64> =
            gradients.iter().map(|gradients| determinant(&mesh.jacobian(element, gradients))).collect();
        // Overflow leaves no number.
        let is_good = jacobians.iter().all(|&jacobian| jacobian > 0.0 && jacobian.is_finite());
        (!is_good).then(|| (element, jacobians.into_iter().fold(f64::INFINITY, f64::min)))
    };
    (0..mesh.num_elements()).filter_map(inverted).collect()
}
