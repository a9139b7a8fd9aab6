//! Newton's corrections of a state that was found on another mesh: what a finer mesh makes of an equilibrium without its path.

use pneuflex_assembly::Solid;
use pneuflex_factor::Parallelism;
use pneuflex_model::Problem;

use crate::contributions::CavityPressures;
use crate::error::SetupError;
use crate::failure::Cause;
use crate::history::ConvergedState;
use crate::state::State;
use crate::system::System;

/// Prescribed displacements that differ by less than this share of the body's size are met.
const MET: f64 = 1e-12;

/// Corrections below this share of the displacements are rounding: where both meshes have the same state, all are.
const ROUNDING: f64 = 1e-10;

/// Coefficients of the pressure modes of every element at a displacement (mm, one entry per node), MPa: what the mixed linearisation carries
/// there.
///
/// # Errors
/// An element that is degenerate at rest.
pub fn element_pressures(problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<f64>, SetupError> {
    let (materials, material_of) = problem.materials();
    let solid = Solid::of_materials(problem.mesh.clone(), problem.formulation, &materials, material_of)?;
    Ok(solid.element_pressures(displacement, None))
}

/// How many corrections are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrections {
    /// At the least.
    pub least: usize,
    /// At the most, while contact changes from one to the next.
    pub most: usize,
    /// The last one moves the body by less than this share of what all of them do.
    pub small: f64,
}

/// The state after corrections from a guess, which has the displacements of this mesh; `pressures` are those of its elements
/// ([`element_pressures`]), which its displacements alone do not have: between the modes of the mesh that it was found on, the nearly
/// incompressible material would be far from equilibrium (theory §11).
///
/// `None` if the last correction that may be made is still not small: then the state is no equilibrium, nor near one.
///
/// # Errors
/// What keeps a correction from being found.
pub fn corrected(
    problem: &Problem,
    guess: &ConvergedState,
    pressures: &[f64],
    corrections: Corrections,
) -> Result<Option<ConvergedState>, Cause> {
    let mut system = System::new(problem, Parallelism::Threads)?;
    let supplies = CavityPressures::of(problem)?;
    let mut state = State::new(guess.parameter, guess.displacement.clone(), supplies.unknowns(&guess.cavity_pressures));
    system.predict(&state.displacement, None);
    let mut linearisation = system.next_linearisation(&state);
    // The solid comes first.
    linearisation.stored.iter_mut().zip(pressures).for_each(|(own, given)| *own = *given);
    system.carry(&linearisation);
    let wanted = problem.held_displacement(state.parameter);
    let size = problem.mesh.extent();
    let norm = |field: &[[f64; 3]]| field.as_flattened().iter().map(|u| u * u).sum::<f64>().sqrt();
    for number in 1..=corrections.most {
        let (assembled, tangent) = system.tangent(&state)?;
        let change: Vec<[f64; 3]> = crate::state::difference(&wanted, &state.displacement);
        let of_held = change.as_flattened().iter().zip(system.held()).filter(|(_, held)| **held);
        let is_met = of_held.into_iter().all(|(change, _)| change.abs() <= MET * size);
        let correction = system.solve(&tangent, &assembled, (!is_met).then_some(&change[..]))?;
        let multipliers = system.multipliers(&tangent, &assembled, &correction)?;
        let negative_pivots = tangent.negative_pivots();
        system.recycle(Some(tangent));
        system.apply(&mut state, &correction)?;
        let found = ConvergedState {
            negative_pivots,
            displacement: state.displacement.clone(),
            reaction: multipliers.as_chunks().0.iter().map(|lambda: &[f64; 3]| lambda.map(|l| -l)).collect(),
            contact_points: assembled.contact_points,
            cavity_pressures: supplies.at(&state),
            contact_multipliers: system.contact_multipliers(),
            ..guess.clone()
        };
        let moved = norm(&crate::state::difference(&state.displacement, &guess.displacement));
        let last = norm(&correction.displacement);
        let is_small = last <= corrections.small * moved || last <= ROUNDING * norm(&state.displacement);
        if number >= corrections.least && is_small {
            return Ok(Some(found));
        }
    }
    Ok(None)
}
