//! Problems and displacement fields for this crate's tests.

use pneuflex_mesh::{Actuator, MeshSize};
use pneuflex_model::{Contact, Formulation, Material, Problem};

/// The two-chamber piece with cubic elements of the given size.
pub(crate) fn two_chambers(size: f64) -> Problem {
    with_formulation(size, Formulation::Hex8Sri)
}

/// The same with a chosen element.
pub(crate) fn with_formulation(size: f64, formulation: Formulation) -> Problem {
    let size = MeshSize::uniform(size);
    Problem::from_actuator(&Actuator::two_chambers(), &size, formulation, Material::default(), Contact::default())
        .unwrap()
}

/// Nodal displacements of a field.
pub(crate) fn displacement_of(problem: &Problem, field: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    problem.mesh.nodes.iter().map(|&x| field(x)).collect()
}
