//! Problems that the benchmarks share.

use pneuflex::mesh::{Actuator, MeshSize};
use pneuflex::model::{Contact, Formulation, Invariant, Material, Problem, Resolution};

/// The paper's full actuator, half model, with a given element and size (mm).
///
/// # Panics
/// Never: the default lengths make a body.
pub fn full_actuator(formulation: Formulation, size: f64) -> Problem {
    problem(&Actuator::full(), formulation, &MeshSize::uniform(size))
}

/// The paper's full actuator, half model, hex27 (the default element) at a resolution.
///
/// # Panics
/// Never: the default lengths make a body.
pub fn resolved_actuator(resolution: Resolution) -> Problem {
    let actuator = Actuator::full();
    problem(&actuator, Formulation::Hex27, &resolution.mesh_size(&actuator))
}

/// The paper's two chambers, half model, with a given element and size (mm).
///
/// # Panics
/// Never: the default lengths make a body.
pub fn two_chambers(formulation: Formulation, size: f64) -> Problem {
    problem(&Actuator::two_chambers(), formulation, &MeshSize::uniform(size))
}

fn problem(actuator: &Actuator, formulation: Formulation, size: &MeshSize) -> Problem {
    let invariant = if formulation == Formulation::Hex8Sri { Invariant::Full } else { Invariant::Isochoric };
    let material = Material { invariant, ..Material::default() };
    Problem::from_actuator(actuator, size, formulation, material, Contact::default())
        .expect("the default lengths make a body")
}

/// A smooth field of displacements that deforms every element, mm.
pub fn smooth_displacement(problem: &Problem) -> Vec<[f64; 3]> {
    problem
        .mesh
        .nodes
        .iter()
        .map(|x| [0.02 * (0.3 * x[1] + x[2]).sin(), 0.01 * x[1] * (0.1 * x[0]).cos(), -0.002 * x[0] * x[0]])
        .collect()
}

/// Positions of the nodes of [`full_actuator`], mm, with the walls of every gap about 0.1 mm behind each other.
pub fn touching_positions(problem: &Problem) -> Vec<[f64; 3]> {
    let pitch = 10.0;
    let first_gap = 11.0;
    // sin 36° of it moves a wall, 1 mm from the middle of its gap.
    let amplitude = 1.05 / (0.2 * std::f64::consts::PI).sin();
    let shift = |x: f64| -amplitude * (2.0 * std::f64::consts::PI * (x - first_gap) / pitch).sin();
    problem.mesh.nodes.iter().map(|&[x, y, z]| [x + shift(x), y, z]).collect()
}
