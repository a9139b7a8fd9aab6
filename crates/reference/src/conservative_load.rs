//! Forces, tractions and weights: the energy −f · u of forces that keep their direction and size.

use nalgebra::{DVector, Matrix3};
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::load::Load;
use pneuflex_model::{Curve, LoadParameter, Problem};

use crate::differentiate::{cross, dot};
use crate::elements;
use crate::error::ReferenceError;
use crate::shape::{ShapeFunctions, face_functions};

/// The conservative loads of a problem.
#[derive(Clone, Debug)]
pub struct ConservativeLoads {
    num_dofs: usize,
    // Forces on all degrees of freedom, N, and their factor along the load path.
    loads: Vec<(DVector<f64>, Curve)>,
}

impl ConservativeLoads {
    /// Those of a problem; pressures are none.
    ///
    /// # Errors
    /// An element family without a formulation.
    pub fn new(problem: &Problem) -> Result<Self, ReferenceError> {
        let (num_dofs, mut loads) = (problem.num_dofs(), Vec::new());
        for load in &problem.loads {
            let mut forces = DVector::zeros(num_dofs);
            let mut add = |node: u32, share: f64, force: &[f64; 3]| {
                (0..3).for_each(|axis| forces[3 * node as usize + axis] += share * force[axis]);
            };
            let curve = match load {
                Load::Force { nodes, force, curve } => {
                    nodes.iter().for_each(|&(node, factor)| add(node, factor, force));
                    curve
                }
                Load::Traction { facets, traction, curve } => {
                    for (node, area) in shares_of_area(problem, facets)? {
                        add(node, area, traction);
                    }
                    curve
                }
                Load::Gravity { elements, acceleration, curve } => {
                    let all: Vec<u32> = (0..problem.mesh.num_elements() as u32).collect();
                    for (node, mass) in shares_of_mass(problem, elements.as_ref().unwrap_or(&all))? {
                        add(node, mass, acceleration);
                    }
                    curve
                }
                // See `follower_pressure`.
                Load::Pressure { facets: _, curve: _ } => continue,
            };
            loads.push((forces, curve.clone()));
        }
        Ok(Self { num_dofs, loads })
    }

    /// Their sum at a position on the load path, N.
    pub fn forces(&self, parameter: LoadParameter) -> DVector<f64> {
        let none = DVector::zeros(self.num_dofs);
        self.loads.iter().fold(none, |sum, (forces, curve)| sum + forces * curve.at(parameter))
    }
}

/// ∫ N_a dA₀ of every node of every facet, mm².
fn shares_of_area(problem: &Problem, facets: &[Facet]) -> Result<Vec<(u32, f64)>, ReferenceError> {
    let mesh = &problem.mesh;
    let mut shares = Vec::new();
    for &facet in facets {
        let nodes = mesh.facet_nodes(facet);
        let (kind, shape) = face_functions(problem, facet)?;
        for (xi, weight) in elements::face_rule(kind) {
            let gradients = shape.gradients(&xi);
            let tangent = |d: usize| -> [f64; 3] {
                std::array::from_fn(|i| {
                    coordinates(mesh, &nodes, i).zip(&gradients).map(|(x, g)| x * g[d]).sum::<f64>()
                })
            };
            let normal = cross(tangent(0), tangent(1));
            let area = weight * dot(normal, normal).sqrt();
            shares.extend(nodes.iter().zip(shape.values(&xi)).map(|(&node, value)| (node, value * area)));
        }
    }
    Ok(shares)
}

/// ∫ ρ N_a dV₀ of every node of every element, t.
fn shares_of_mass(problem: &Problem, chosen: &[u32]) -> Result<Vec<(u32, f64)>, ReferenceError> {
    let mesh = &problem.mesh;
    let (materials, material_of) = problem.materials();
    let mut shares = Vec::new();
    for &element in chosen {
        let nodes = mesh.element(element as usize);
        let kind = mesh.kind_of(element as usize);
        let wrong = || ReferenceError::WrongElement { formulation: problem.formulation, found: kind };
        let shape = ShapeFunctions::of_element(kind).ok_or_else(wrong)?;
        let density = 1e-9 * materials[usize::from(material_of[element as usize])].density;
        for (xi, weight) in elements::volume_rule(kind) {
            let gradients = shape.gradients(&xi);
            let jacobian = Matrix3::from_fn(|i, j| {
                coordinates(mesh, nodes, i).zip(&gradients).map(|(x, g)| x * g[j]).sum::<f64>()
            });
            let mass = density * weight * jacobian.determinant();
            shares.extend(nodes.iter().zip(shape.values(&xi)).map(|(&node, value)| (node, value * mass)));
        }
    }
    Ok(shares)
}

fn coordinates<'a>(mesh: &'a Mesh, nodes: &'a [u32], axis: usize) -> impl Iterator<Item = f64> + 'a {
    nodes.iter().map(move |&node| mesh.nodes[node as usize][axis])
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Formulation, Material};

    use super::*;
    use crate::testing::{block, body};

    /// Resultant, and moment about the z-axis.
    fn resultant(problem: &Problem, load: Load) -> ([f64; 3], f64) {
        let problem = Problem { loads: vec![load], ..problem.clone() };
        let forces = ConservativeLoads::new(&problem).unwrap().forces(LoadParameter(2.0));
        let sum = std::array::from_fn(|axis| forces.iter().skip(axis).step_by(3).sum());
        let moment = |(x, f): (&[f64; 3], &[f64])| x[0] * f[1] - x[1] * f[0];
        (sum, problem.mesh.nodes.iter().zip(forces.as_slice().chunks(3)).map(moment).sum())
    }

    #[test]
    fn loads_have_the_resultants_of_uniform_ones() {
        let curve = Curve::Proportional(0.5);
        for formulation in Formulation::ALL {
            let mesh = block(formulation, [3.0, 2.0, 1.0], [3, 2, 1], 0.0);
            let problem = body(mesh, formulation, Material { density: 1.1, ..Material::default() });
            let facets = problem.mesh.select_facets(|x| x[0] == 3.0);
            let traction = Load::Traction { facets, traction: [0.5, 0.0, -1.5], curve: curve.clone() };
            let weight = Load::Gravity { elements: None, acceleration: [0.0, 9810.0, 0.0], curve: curve.clone() };
            let force = Load::Force { nodes: vec![(0, 0.5), (0, 1.5)], force: [1.0, 2.0, 3.0], curve: curve.clone() };
            let mass = 6.0 * 1.1e-9;
            for (load, expected, moment) in [
                (traction, [1.0, 0.0, -3.0], -1.0),
                (weight, [0.0, 9810.0 * mass, 0.0], 1.5 * 9810.0 * mass),
                (force, [2.0, 4.0, 6.0], 0.0),
            ] {
                let (found, about_z) = resultant(&problem, load);
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{formulation}: {found:?}");
                assert!((about_z - moment).abs() < 1e-12, "{formulation}: {about_z}");
            }
        }
    }
}
