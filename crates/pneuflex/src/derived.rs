//! What is derived from an equilibrium.

use std::collections::BTreeMap;

use pneuflex_model::Problem;
use pneuflex_newton::{Bifurcation, Checkpoint, ConvergedState, Snap};
use pneuflex_post::fields;
use pneuflex_post::load_step::LoadStepSummary;
use pneuflex_post::summary::{self, BifurcationSummary, Described, ProbeSite, SnapSummary, State};

use crate::error::ResultsError;
use crate::reason::mesh_motions;

/// Everything that is derived from an equilibrium.
///
/// # Errors
/// [`ResultsError::Derived`].
pub fn describe(
    problem: &Problem,
    sites: &BTreeMap<String, ProbeSite>,
    equilibrium: &ConvergedState,
) -> Result<Described, ResultsError> {
    let state = as_described(equilibrium);
    let described = summary::describe(problem, sites, &state);
    let mut described = described.map_err(|source| failed(problem, equilibrium, source))?;
    described.summary.kind = equilibrium.kind;
    let summary = |left: &Bifurcation| BifurcationSummary {
        at: left.parameter,
        near_mm: left.motions.place,
        pushed_mm: left.size,
    };
    described.summary.bifurcations = equilibrium.bifurcations.iter().map(summary).collect();
    let parts = problem.parts_of_whole() as f64;
    let summary = |snap: &Snap| SnapSummary {
        at: snap.from,
        to: snap.to,
        near_mm: snap.place,
        moved_mm: snap.moved,
        released_mj: snap.released.map(|released| parts * released),
        in_load_step: snap.steps == 0,
    };
    described.summary.snaps = equilibrium.snaps.iter().map(summary).collect();
    if equilibrium.mesh_motions.is_none() {
        described.summary.unstable_motions = equilibrium.negative_pivots;
    }
    described.summary.mesh_instability = equilibrium.mesh_motions.as_ref().map(mesh_motions);
    Ok(described)
}

/// What a load step between requested positions is described by; `None` if that cannot be derived. It is no result that was asked for: a
/// run does not end for want of it.
pub fn describe_load_step(
    problem: &Problem,
    sites: &BTreeMap<String, ProbeSite>,
    step: &Checkpoint,
) -> Option<LoadStepSummary> {
    let equilibrium = step.equilibrium(problem).ok()?;
    LoadStepSummary::of(problem, sites, &as_described(&equilibrium)).ok()
}

/// The texts of the field files: the body, and the contact walls if there are any.
///
/// # Errors
/// [`ResultsError::Derived`].
pub fn field_files(
    problem: &Problem,
    described: &Described,
    equilibrium: &ConvergedState,
) -> Result<[Option<String>; 2], ResultsError> {
    let files = described.field_files(problem, &as_described(equilibrium));
    files.map(|(body, walls)| [Some(body), walls]).map_err(|source| failed(problem, equilibrium, source))
}

/// The text of the file of the stresses at the integration points.
///
/// # Errors
/// [`ResultsError::Derived`].
pub fn points_file(
    problem: &Problem,
    described: &Described,
    equilibrium: &ConvergedState,
) -> Result<String, ResultsError> {
    let file = fields::points(&described.stress, equilibrium.parameter.0).to_vtu();
    file.map_err(|source| failed(problem, equilibrium, source))
}

/// The text of the field file of a motion along which the body buckled.
///
/// # Errors
/// [`ResultsError::Derived`].
pub fn mode_file(problem: &Problem, left: &Bifurcation) -> Result<String, ResultsError> {
    let file = fields::mode(problem, &left.mode, left.parameter.0).and_then(|grid| grid.to_vtu());
    file.map_err(|source| ResultsError::Derived { at: problem.clock.words(left.parameter), source })
}

fn failed(problem: &Problem, equilibrium: &ConvergedState, source: pneuflex_post::PostError) -> ResultsError {
    ResultsError::Derived { at: problem.clock.words(equilibrium.parameter), source }
}

fn as_described(equilibrium: &ConvergedState) -> State<'_> {
    State {
        parameter: equilibrium.parameter,
        cavity_pressures: &equilibrium.cavity_pressures,
        displacement: &equilibrium.displacement,
        reaction: &equilibrium.reaction,
        iterations: equilibrium.iterations,
        load_steps: equilibrium.load_steps,
        contact_multipliers: &equilibrium.contact_multipliers,
        contact_failure: equilibrium.augmentation.as_ref().and_then(|augmentation| augmentation.failure.as_deref()),
    }
}
