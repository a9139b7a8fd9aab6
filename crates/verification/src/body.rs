//! Bodies, supports and solutions that the problems share.

use pneuflex_mesh::Mesh;
use pneuflex_model::{Formulation, Invariant, Material, Problem, Solver, Support};
use pneuflex_newton::{ConvergedState, Event, Path, follow_path};

/// The material of the paper with the isochoric invariant and a bulk modulus, MPa.
pub fn material(bulk_modulus: f64) -> Material {
    Material { bulk_modulus, invariant: Invariant::Isochoric, ..Material::default() }
}

/// A body without loads, supports and contact.
pub fn body(mesh: Mesh, formulation: Formulation, material: Material) -> Problem {
    Problem::body(mesh, formulation, material)
}

/// Holds `axes` of the nodes that satisfy `predicate`.
pub fn hold(problem: &mut Problem, name: &str, axes: [bool; 3], predicate: impl Fn([f64; 3]) -> bool) {
    let nodes = problem.mesh.select_nodes(predicate);
    problem.supports.push(Support { name: name.into(), nodes, axes, motion: None });
}

/// Whether two coordinates are the same up to rounding.
pub fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Displacements X ↦ r(X) − X, mm.
pub fn displacement(mesh: &Mesh, deformed: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    let moved = |&x: &[f64; 3]| {
        let r = deformed(x);
        std::array::from_fn(|k| r[k] - x[k])
    };
    mesh.nodes.iter().map(moved).collect()
}

/// Equilibria under displacements of the supports, one after the other.
///
/// # Errors
/// What kept the solver from converging.
pub fn prescribe(
    problem: &Problem,
    stages: impl IntoIterator<Item = Vec<[f64; 3]>>,
) -> Result<Vec<ConvergedState>, String> {
    let settings = Solver { tolerance: 1e-9, max_iterations: 40, ..Solver::default() };
    let mut path = Path::new(problem, &settings).map_err(|e| e.to_string())?;
    stages.into_iter().map(|stage| path.prescribe(&stage, &mut |_| ()).map_err(|cause| cause.to_string())).collect()
}

/// Equilibrium under a pressure, kPa, reached in ten equal steps that are all solved to the end: with a bulk modulus as large
/// as here, steps on the way that are solved loosely lead to states from which there is no going on.
///
/// # Errors
/// What kept the solver from converging.
pub fn inflate(problem: &Problem, kpa: f64) -> Result<ConvergedState, String> {
    let mut reached = Vec::new();
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            reached.push(state.clone());
        }
    };
    let pressures: Vec<f64> = (1..=10).map(|i| 0.1 * f64::from(i) * kpa).collect();
    follow_path(problem, &pressures, &Solver::default(), &mut observer).map_err(|e| e.0.to_string())?;
    last(reached)
}

/// The last of some states.
///
/// # Errors
/// If there is none.
pub fn last(states: Vec<ConvergedState>) -> Result<ConvergedState, String> {
    states.into_iter().next_back().ok_or_else(|| "no state".into())
}
