//! How far the body is stretched at its nodes.

use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{Mesh, shape};

/// Rounds of Jacobi's method, after which a 3 × 3 matrix is diagonal to the last bit.
const SWEEPS: usize = 12;

/// The largest principal stretch at every node: the mean of those of the elements around it, each with its own deformation gradient there.
pub fn largest_stretch(mesh: &Mesh, displacement: &[[f64; 3]]) -> Vec<f64> {
    let gradients = mesh.per_kind(|kind| kind.nodes.iter().map(|&xi| shape::tabulate(kind, xi).1).collect::<Vec<_>>());
    let mut sums = vec![(0.0, 0.0_f64); mesh.num_nodes()];
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        for (local, at_node) in gradients[mesh.kind_of(element)].iter().enumerate() {
            let rest = mesh.jacobian(element, at_node);
            let mut moved = rest;
            for (&node, gradient) in nodes.iter().zip(at_node) {
                let u = displacement[node as usize];
                for i in 0..3 {
                    (0..3).for_each(|j| moved[i][j] += u[i] * gradient[j]);
                }
            }
            // F = (dx/dξ)(dX/dξ)⁻¹; a corner where an element is degenerate has none.
            let Some(inverse) = inverse(&rest) else { continue };
            let f: [[f64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| moved[i][k] * inverse[k][j]).sum()));
            let c = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| f[k][i] * f[k][j]).sum()));
            let (count, sum) = &mut sums[nodes[local] as usize];
            *count += 1.0;
            *sum += largest_eigenvalue(c).max(0.0).sqrt();
        }
    }
    sums.into_iter().map(|(count, sum)| if count > 0.0 { sum / count } else { 1.0 }).collect()
}

fn inverse(a: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let determinant = determinant(a);
    let cofactor = |i: usize, j: usize| {
        let [r, s] = [(i + 1) % 3, (i + 2) % 3];
        let [p, q] = [(j + 1) % 3, (j + 2) % 3];
        a[r][p] * a[s][q] - a[r][q] * a[s][p]
    };
    let found = std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant));
    (determinant != 0.0).then_some(found)
}

/// By Jacobi's rotations; they lose no digits where eigenvalues are close.
fn largest_eigenvalue(mut c: [[f64; 3]; 3]) -> f64 {
    for sweep in 0..3 * SWEEPS {
        let (p, q) = [(0, 1), (0, 2), (1, 2)][sweep % 3];
        if c[p][q] == 0.0 {
            continue;
        }
        let angle = 0.5 * (2.0 * c[p][q]).atan2(c[q][q] - c[p][p]);
        let (sin, cos) = angle.sin_cos();
        for k in 0..3 {
            let (a, b) = (c[k][p], c[k][q]);
            (c[k][p], c[k][q]) = (cos * a - sin * b, sin * a + cos * b);
        }
        for k in 0..3 {
            let (a, b) = (c[p][k], c[q][k]);
            (c[p][k], c[q][k]) = (cos * a - sin * b, sin * a + cos * b);
        }
    }
    c[0][0].max(c[1][1]).max(c[2][2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displaced, two_chambers};
    use pneuflex_model::Formulation;

    #[test]
    fn a_stretch_is_found_whatever_rotation_follows_it_and_whatever_the_element() {
        // Stretched by 1.4, 0.9 and 1.1 along turned axes, then turned by a large angle.
        let (s, c) = 0.6_f64.sin_cos();
        let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let (s, c) = 2.1_f64.sin_cos();
        let after = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]];
        let times = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
        };
        let transposed = std::array::from_fn(|i| std::array::from_fn(|j| turn[j][i]));
        let stretch = [[1.4, 0.0, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 1.1]];
        let f = times(after, times(turn, times(stretch, transposed)));
        for formulation in Formulation::ALL {
            let problem = two_chambers(formulation);
            let u =
                displaced(&problem, |x| std::array::from_fn(|i| (0..3).map(|j| f[i][j] * x[j]).sum::<f64>() - x[i]));
            let found = largest_stretch(&problem.mesh, &u);
            assert!(found.iter().all(|stretch| (stretch - 1.4).abs() < 1e-9), "{formulation}");
        }
    }
}
