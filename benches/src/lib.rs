//! Problems that the benchmarks share.

use pneuflex_mesh::{Actuator, MeshSize};
use pneuflex_model::{Contact, Formulation, Invariant, Material, Problem};

/// The paper's full actuator, half model, with a given element and size (mm).
///
/// # Panics
/// Never: the default lengths make a body.
pub fn full_actuator(formulation: Formulation, size: f64) -> Problem {
    problem(&Actuator::full(), formulation, size)
}

/// The paper's two chambers, half model, with a given element and size (mm).
///
/// # Panics
/// Never: the default lengths make a body.
pub fn two_chambers(formulation: Formulation, size: f64) -> Problem {
    problem(&Actuator::two_chambers(), formulation, size)
}

fn problem(actuator: &Actuator, formulation: Formulation, size: f64) -> Problem {
    let invariant = if formulation == Formulation::Hex8Sri { Invariant::Full } else { Invariant::Isochoric };
    let size = MeshSize::uniform(size);
    let material = Material { invariant, ..Material::default() };
    Problem::from_actuator(actuator, &size, formulation, material, Contact::default())
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
