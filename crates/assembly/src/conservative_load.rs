//! Nodal forces of loads that keep their direction and size, whatever the body does.

use pneuflex_mesh::{Facet, Mesh, PerFaceKind, mesh::determinant, shape};
use pneuflex_model::load::Load;
use pneuflex_model::{Curve, LoadParameter, Problem};

use crate::contribution::{Contribution, Frozen, Position};
use crate::local::{LocalContribution, LocalError};

/// Forces, tractions and weights.
#[derive(Clone, Debug)]
pub struct ConservativeLoads {
    /// Forces on the nodes, N, and their factor along the load path.
    loads: Vec<(Vec<[f64; 3]>, Curve)>,
    parameter: LoadParameter,
}

impl ConservativeLoads {
    /// Those of a problem.
    pub fn of(problem: &Problem) -> Self {
        let loads = problem.loads.iter().filter_map(|load| forces_of(problem, load)).collect();
        Self { loads, parameter: LoadParameter::default() }
    }
}

impl Contribution for ConservativeLoads {
    fn name(&self) -> &'static str {
        "conservative loads"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.parameter = position.parameter;
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        None
    }

    fn is_load(&self) -> bool {
        true
    }

    /// Areas and volumes at rest depend on the positions; without loads there is nothing.
    fn add_shape_slope(&self, _frozen: &Frozen<'_>, _slope: &mut [[f64; 3]]) -> Result<bool, LocalError> {
        Ok(self.loads.is_empty())
    }

    fn add_forces(&self, residual: &mut [[f64; 3]]) {
        for (forces, curve) in &self.loads {
            let factor = -curve.at(self.parameter);
            for (sum, &force) in residual.iter_mut().zip(forces) {
                add_scaled(sum, factor, force);
            }
        }
    }
}

/// Forces on the nodes of a load that keeps its direction, N, and their factor along the load path.
fn forces_of(problem: &Problem, load: &Load) -> Option<(Vec<[f64; 3]>, Curve)> {
    let mesh = &problem.mesh;
    match load {
        Load::Force { nodes, force, curve } => {
            let mut forces = vec![[0.0; 3]; mesh.num_nodes()];
            for &(node, factor) in nodes {
                add_scaled(&mut forces[node as usize], factor, *force);
            }
            Some((forces, curve.clone()))
        }
        Load::Traction { facets, traction, curve } => Some((traction_forces(mesh, facets, *traction), curve.clone())),
        Load::Gravity { elements, acceleration, curve } => {
            let (materials, of_element) = problem.materials();
            let density = |element: u32| materials[usize::from(of_element[element as usize])].density_in_t_per_mm3();
            let forces = match elements {
                Some(elements) => weight_forces(mesh, elements.iter().copied(), density, *acceleration),
                None => weight_forces(mesh, 0..mesh.num_elements() as u32, density, *acceleration),
            };
            Some((forces, curve.clone()))
        }
        Load::Pressure { .. } => None,
    }
}

/// ∫ N_a t dA over faces at rest for a traction t, N, one entry per node.
pub fn traction_forces(mesh: &Mesh, facets: &[Facet], traction: [f64; 3]) -> Vec<[f64; 3]> {
    let mut forces = vec![[0.0; 3]; mesh.num_nodes()];
    let rules = PerFaceKind::new(|kind| {
        (kind.rule)().into_iter().map(|(xi, w)| (shape::evaluate_face(kind, xi), w)).collect::<Vec<_>>()
    });
    for &facet in facets {
        let nodes = mesh.facet_nodes(facet);
        for (shape, weight) in &rules[mesh.face_kind(facet)] {
            let mut tangents = [[0.0; 3]; 2];
            for (&node, gradient) in nodes.iter().zip(&shape.gradients) {
                for k in 0..3 {
                    tangents[0][k] += gradient[0] * mesh.nodes[node as usize][k];
                    tangents[1][k] += gradient[1] * mesh.nodes[node as usize][k];
                }
            }
            let [a, b] = tangents;
            let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            let area = weight * normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            for (&node, value) in nodes.iter().zip(&shape.values) {
                add_scaled(&mut forces[node as usize], value * area, traction);
            }
        }
    }
    forces
}

/// ∫ ρ N_a g dV over elements for an acceleration g (mm/s²), N, one entry per node; `density` gives every element's ρ, t/mm³.
pub fn weight_forces(
    mesh: &Mesh,
    elements: impl Iterator<Item = u32>,
    density: impl Fn(u32) -> f64,
    acceleration: [f64; 3],
) -> Vec<[f64; 3]> {
    let mut forces = vec![[0.0; 3]; mesh.num_nodes()];
    let rules = mesh.per_kind(|kind| {
        (kind.volume_rule)().into_iter().map(|(xi, w)| (shape::tabulate(kind, xi), w)).collect::<Vec<_>>()
    });
    for element in elements {
        for ((values, gradients), weight) in &rules[mesh.kind_of(element as usize)] {
            let volume = weight * determinant(&mesh.jacobian(element as usize, gradients));
            for (&node, value) in mesh.element(element as usize).iter().zip(values) {
                add_scaled(&mut forces[node as usize], density(element) * volume * value, acceleration);
            }
        }
    }
    forces
}

fn add_scaled(sum: &mut [f64; 3], factor: f64, vector: [f64; 3]) {
    for k in 0..3 {
        sum[k] += factor * vector[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;

    fn bar(kind: ElementKind) -> Mesh {
        Lattice::uniform([0.0; 3], [3.0, 2.0, 1.0], [3, 2, 1]).mesh_all(kind)
    }

    /// Resultant, and moment about the origin, of forces on the nodes of a mesh.
    fn resultant(mesh: &Mesh, forces: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (x, f) in mesh.nodes.iter().zip(forces) {
            let m = [x[1] * f[2] - x[2] * f[1], x[2] * f[0] - x[0] * f[2], x[0] * f[1] - x[1] * f[0]];
            for k in 0..3 {
                force[k] += f[k];
                moment[k] += m[k];
            }
        }
        (force, moment)
    }

    #[track_caller]
    fn assert_close(found: [f64; 3], expected: [f64; 3]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} for {expected:?}");
    }

    #[test]
    fn tractions_have_the_resultant_of_a_uniform_load() {
        for kind in ElementKind::ALL {
            let mesh = bar(kind);
            let end = mesh.select_facets(|x| x[0] == 3.0);
            let (force, moment) = resultant(&mesh, &traction_forces(&mesh, &end, [0.5, 0.0, -1.5]));
            // Over 2 × 1, about the origin from the centre (3, 1, 0.5).
            assert_close(force, [1.0, 0.0, -3.0]);
            assert_close(moment, [-3.0, 9.5, -1.0]);
        }
    }

    #[test]
    fn weight_acts_at_the_centre_of_gravity_of_every_density() {
        for kind in ElementKind::ALL {
            let mesh = bar(kind);
            // Twice as dense for x > 2: masses 4 and 4 at x = 1 and 2.5.
            let centre = |element: u32| -> f64 {
                let nodes = mesh.element(element as usize);
                let corners = &nodes[..kind.num_corners()];
                corners.iter().map(|&n| mesh.nodes[n as usize][0]).sum::<f64>() / corners.len() as f64
            };
            let density = |element| if centre(element) > 2.0 { 2.0 } else { 1.0 };
            let all = 0..mesh.num_elements() as u32;
            let (force, moment) = resultant(&mesh, &weight_forces(&mesh, all, density, [0.0, 0.0, -9.81]));
            assert_close(force, [0.0, 0.0, -8.0 * 9.81]);
            assert_close(moment, [-8.0 * 9.81, (4.0 * 1.0 + 4.0 * 2.5) * 9.81, 0.0]);
        }
    }
}
