//! How far the body is stretched at its nodes.

use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::vector::{cross, norm, sub};
use pneuflex_mesh::{Facet, Mesh, PerKind, shape};

/// Rounds of Jacobi's method, after which a 3 × 3 matrix is diagonal to the last bit.
const SWEEPS: usize = 12;

type Matrix = [[f64; 3]; 3];

/// The largest principal stretch at every node: the mean of those of the elements around it, each with its own deformation gradient there.
pub fn largest_stretch(mesh: &Mesh, displacement: &[[f64; 3]]) -> Vec<f64> {
    let (gradients, mut means) = (gradients_at_nodes(mesh), Means::new(mesh));
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        for (local, at_node) in gradients[mesh.kind_of(element)].iter().enumerate() {
            let [rest, moved] = jacobians(mesh, element, at_node, displacement);
            // F = (dx/dξ)(dX/dξ)⁻¹; a corner where an element is degenerate has none.
            let Some(inverse) = inverse(&rest) else { continue };
            let f: Matrix =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| moved[i][k] * inverse[k][j]).sum()));
            let c = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| f[k][i] * f[k][j]).sum()));
            means.add(nodes[local], largest_eigenvalue(c).max(0.0).sqrt());
        }
    }
    means.or(1.0)
}

/// By how much the material has become thicker across the surface at every node of `walls`, facets of the surface, relative to rest: two
/// layers of material that are parallel to the surface there and a small distance apart have the distance 1 + this times as large afterwards
/// (−0.2: a fifth thinner). With the surface's normal N at rest and the deformation gradient F it is 1/|F⁻ᵀN| − 1, which is
/// also J over the growth of the surface's area, less 1 (Nanson's formula). Nodes of several faces, at edges too, have the mean; nodes that are
/// not on the surface have 0.
pub fn thickness_change(mesh: &Mesh, walls: &[Facet], displacement: &[[f64; 3]]) -> Vec<f64> {
    let (gradients, mut means) = (gradients_at_nodes(mesh), Means::new(mesh));
    for facet in walls {
        let element = facet.element as usize;
        let kind = mesh.kind_of(element);
        let locals = kind.face_nodes(usize::from(facet.face));
        let corner = |i: usize| kind.nodes[locals[i]];
        // Across the face of the reference element.
        let normal = cross(sub(corner(1), corner(0)), sub(corner(2), corner(0)));
        for &local in locals {
            // F⁻ᵀN is (dx/dξ)⁻ᵀn over the length of (dX/dξ)⁻ᵀn.
            let [rest, moved] = jacobians(mesh, element, &gradients[kind][local], displacement);
            let across = |jacobian: &Matrix| {
                let inverse = inverse(jacobian)?;
                Some(norm(std::array::from_fn(|i| (0..3).map(|k| inverse[k][i] * normal[k]).sum())))
            };
            if let (Some(rest), Some(moved)) = (across(&rest), across(&moved)) {
                means.add(mesh.element(element)[local], rest / moved - 1.0);
            }
        }
    }
    means.or(0.0)
}

/// Means of values at nodes.
struct Means(Vec<(f64, f64)>);

impl Means {
    fn new(mesh: &Mesh) -> Self {
        Self(vec![(0.0, 0.0); mesh.num_nodes()])
    }

    fn add(&mut self, node: u32, value: f64) {
        let (count, sum) = &mut self.0[node as usize];
        *count += 1.0;
        *sum += value;
    }

    /// The means, and a value of their own for nodes without any.
    fn or(self, otherwise: f64) -> Vec<f64> {
        self.0.into_iter().map(|(count, sum)| if count > 0.0 { sum / count } else { otherwise }).collect()
    }
}

/// Gradients of the shape functions at every node of an element of each kind.
fn gradients_at_nodes(mesh: &Mesh) -> PerKind<Vec<Vec<[f64; 3]>>> {
    mesh.per_kind(|kind| kind.nodes.iter().map(|&xi| shape::tabulate(kind, xi).1).collect())
}

/// dX/dξ and dx/dξ, at rest and deformed.
fn jacobians(mesh: &Mesh, element: usize, gradients: &[[f64; 3]], displacement: &[[f64; 3]]) -> [Matrix; 2] {
    let rest = mesh.jacobian(element, gradients);
    let mut moved = rest;
    for (&node, gradient) in mesh.element(element).iter().zip(gradients) {
        let u = displacement[node as usize];
        for i in 0..3 {
            (0..3).for_each(|j| moved[i][j] += u[i] * gradient[j]);
        }
    }
    [rest, moved]
}

fn inverse(a: &Matrix) -> Option<Matrix> {
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
fn largest_eigenvalue(mut c: Matrix) -> f64 {
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
    #[test]
    fn a_wall_is_as_much_thinner_as_it_is_whatever_turns_it() {
        // Thicker by 1.25 across z, sheared along the wall, which changes nothing, and turned.
        let (s, c) = 0.8_f64.sin_cos();
        let f = |x: [f64; 3]| [1.1 * x[0] + 0.3 * x[2], 0.9 * x[1], 1.25 * x[2]];
        let turn = |x: [f64; 3]| [c * x[0] + s * x[2], x[1], c * x[2] - s * x[0]];
        for formulation in Formulation::ALL {
            let problem = two_chambers(formulation);
            let mesh = &problem.mesh;
            let height = mesh.nodes.iter().map(|x| x[2]).fold(0.0, f64::max);
            let is_top = |n: &u32| mesh.nodes[*n as usize][2] == height;
            let top = mesh.boundary_facets().into_iter().filter(|&facet| mesh.facet_nodes(facet).iter().all(is_top));
            let u = displaced(&problem, |x| {
                let moved = turn(f(x));
                std::array::from_fn(|i| moved[i] - x[i])
            });
            let found = thickness_change(mesh, &top.collect::<Vec<_>>(), &u);
            for (n, change) in found.iter().enumerate() {
                let expected = if is_top(&(n as u32)) { 0.25 } else { 0.0 };
                assert!((change - expected).abs() < 1e-9, "{formulation}: {change} at {:?}", mesh.nodes[n]);
            }
        }
    }
}
