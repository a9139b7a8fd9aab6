//! Bodies for the tests of several formats.

use std::collections::BTreeMap;

use pneuflex_mesh::{Actuator, MeshSize};
use pneuflex_model::{Contact, Formulation, Material, Problem, Support};
use pneuflex_report::state::State;

/// Half of two chambers on a coarse mesh.
pub(crate) fn two_chambers(formulation: Formulation) -> Problem {
    let size = MeshSize::uniform(3.0);
    Problem::from_actuator(&Actuator::two_chambers(), &size, formulation, Material::default(), Contact::default())
        .unwrap()
}

/// A quarter of a block, 2 mm × 3 mm × 4 mm, whose planes of symmetry are x = 0 and y = 1 mm.
pub(crate) fn quarter() -> Problem {
    let lattice = pneuflex_mesh::lattice::Lattice::uniform([0.0, 1.0, 0.0], [2.0, 4.0, 4.0], [2, 1, 2]);
    let mut problem = two_chambers(Formulation::Hex8Sri);
    let mesh = lattice.mesh_all(Formulation::Hex8Sri.element_kind());
    let held = |name: &str, axis: usize, at: f64| Support {
        name: name.into(),
        nodes: mesh.select_nodes(|x| x[axis] == at),
        axes: std::array::from_fn(|d| d == axis),
        motion: None,
    };
    problem.supports = vec![held("left", 0, 0.0), held("front", 1, 1.0)];
    problem.cavities.clear();
    problem.contact_pairs.clear();
    problem.symmetry.clear();
    problem.mesh = mesh.into();
    problem.declare_symmetry(0).unwrap();
    problem.declare_symmetry(1).unwrap();
    problem
}

/// Displacements, mm, that bend the body and keep planes of symmetry at 0.
pub(crate) fn bent(problem: &Problem, by: f64) -> Vec<[f64; 3]> {
    let bend = |x: &[f64; 3]| [-0.003 * by * x[0] * x[2], 0.01 * by * x[1], -0.02 * by * x[0] * x[0]];
    problem.mesh.nodes.iter().map(bend).collect()
}

/// States of a bent body, one per factor.
pub(crate) fn states(problem: &Problem, factors: &[f64]) -> Vec<State> {
    let state = |factor: &f64| State {
        time: 10.0 * factor,
        displacement: bent(problem, *factor),
        von_mises: problem.mesh.nodes.iter().map(|x| 0.01 * factor * x[2]).collect(),
        stress: vec![[0.0; 6]; problem.mesh.num_nodes()],
        contact_pressure: vec![0.0; problem.mesh.num_nodes()],
    };
    factors.iter().map(state).collect()
}

/// Whether triangles are the surface of a solid: every edge has one triangle on either side, which run along it in opposite directions.
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> Result<(), String> {
    let mut edges: BTreeMap<[u32; 2], [usize; 2]> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            edges.entry([p.min(q), p.max(q)]).or_default()[usize::from(p < q)] += 1;
        }
    }
    if edges.is_empty() {
        return Err("there is nothing".into());
    }
    let wrong = edges.iter().find(|(_, sides)| **sides != [1, 1]);
    wrong.map_or(Ok(()), |(edge, sides)| Err(format!("edge {edge:?} has {sides:?} triangles")))
}
