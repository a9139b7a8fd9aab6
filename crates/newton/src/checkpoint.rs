//! What is needed to go on from an accepted load step as if nothing had happened.
//!
//! A path remembers more than its equilibrium: the next step is predicted with the factor of a tangent that was assembled one or more
//! corrections before. That factor is not stored but made again, from the displacement and the carried stresses it came from.

use pneuflex_model::{LoadParameter, Problem};
use serde::{Deserialize, Serialize};

use crate::arc::ArcMemory;
use crate::contributions::CavityPressures;
use crate::error::{Misfit, SetupError};
use crate::history::{Augmentation, Bifurcation, ConvergedState, Snap};
use crate::linearisation::Linearisation;
use crate::state::State;
use crate::timing::Timing;
use crate::unstable_motion::UnstableMotions;

/// An accepted load step and the path's memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Position reached on the load path.
    #[serde(rename = "time")]
    pub parameter: LoadParameter,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Multipliers λ of the supports, N, three per node.
    pub multipliers: Vec<f64>,
    /// Unknowns beside the displacements, see [`crate::State::bordered`].
    #[serde(rename = "border")]
    pub bordered: Vec<f64>,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Whether the equilibrium is solved well enough to go on from only, not to the tolerances asked for.
    #[serde(rename = "is_loose")]
    pub is_inexact: bool,
    /// Load steps attempted.
    pub step: usize,
    /// Newton iterations so far.
    pub iterations: usize,
    /// Seconds spent so far.
    pub timing: Timing,
    /// How far the path is on its way to the next requested position.
    pub approach: Approach,
    /// Largest stretching per change of the forces at the beginning of the path, 1/N.
    pub first_rate: Option<f64>,
    /// Tangent whose factor predicts the next step.
    pub linearisation: Option<Linearisation>,
    /// Multipliers of the contact points, MPa; empty for a plain penalty.
    #[serde(default)]
    pub contact_multipliers: Vec<f64>,
    /// How the contact's multipliers came about, if the state is a requested one.
    #[serde(default)]
    pub augmentation: Option<Augmentation>,
    /// Motions of the mesh that release energy at the equilibrium.
    #[serde(default)]
    pub mesh_motions: Option<UnstableMotions>,
    /// Whether every step up to the next requested position is solved to the tolerances.
    #[serde(default)]
    pub is_careful: bool,
    /// Negative eigenvalues of the tangent near the equilibrium.
    #[serde(default)]
    pub negative_pivots: usize,
    /// What a path that is followed by its arc length remembers.
    #[serde(default)]
    pub arc: ArcMemory,
    /// Where the path has left a branch since the last state that was told of.
    #[serde(default)]
    pub bifurcations: Vec<Bifurcation>,
    /// How the body has snapped since the last state that was told of.
    #[serde(default)]
    pub snaps: Vec<Snap>,
}

/// The way to a requested position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Size of the next load step.
    pub step: f64,
    /// Size that was rejected; the next steps come near to it by and by only.
    #[serde(default)]
    pub rejected: Option<f64>,
    /// Load steps accepted since the previous requested position.
    pub load_steps: usize,
    /// Iterations up to the previous requested position.
    pub iterations_before: usize,
}

impl Checkpoint {
    /// The equilibrium as data: one on the way to a requested position is solved well enough to go on from, not to the tolerances asked for.
    ///
    /// # Errors
    /// [`SetupError::Cavity`] for a cavity that is open and must not be.
    pub fn equilibrium(&self, problem: &Problem) -> Result<ConvergedState, SetupError> {
        let state = State::new(self.parameter, self.displacement.clone(), self.bordered.clone());
        Ok(ConvergedState {
            parameter: self.parameter,
            kind: self.arc.untold.unwrap_or_default(),
            negative_pivots: self.negative_pivots,
            reaction: self.multipliers.as_chunks().0.iter().map(|lambda: &[f64; 3]| lambda.map(|l| -l)).collect(),
            iterations: self.iterations.saturating_sub(self.approach.iterations_before),
            load_steps: self.approach.load_steps,
            contact_points: self.contact_points,
            cavity_pressures: CavityPressures::of(problem)?.at(&state),
            contact_multipliers: self.contact_multipliers.clone(),
            augmentation: self.augmentation.clone(),
            displacement: state.displacement,
            mesh_motions: self.mesh_motions,
            bifurcations: self.bifurcations.clone(),
            snaps: self.snaps.clone(),
        })
    }

    /// Checks that every list has the length that a problem asks for and every number is finite. `num_stored` is the length of what the
    /// contributions keep of a tangent ([`pneuflex_assembly::Mixed::stored`]).
    ///
    /// # Errors
    /// What does not fit.
    pub fn check(
        &self,
        num_nodes: usize,
        [num_contact_points, num_stored]: [usize; 2],
        num_bordered: usize,
    ) -> Result<(), Misfit> {
        let field = |values: &[[f64; 3]]| values.len() == num_nodes && is_finite(values.as_flattened());
        let fits = field(&self.displacement) && self.multipliers.len() == 3 * num_nodes && is_finite(&self.multipliers);
        let lambda = &self.contact_multipliers;
        let fits = fits && (lambda.is_empty() || lambda.len() == num_contact_points) && is_finite(lambda);
        let steps = [self.parameter.0, self.approach.step];
        if !fits
            || self.bordered.len() != num_bordered
            || !is_finite(&self.bordered)
            || !is_finite(&steps)
            || self.parameter.0 <= 0.0
            || self.approach.step <= 0.0
            || !self.arc.greatest.is_finite()
            || !self.bifurcations.iter().all(|bifurcation| field(&bifurcation.mode) && bifurcation.size.is_finite())
            || self.arc.last.as_ref().is_some_and(|(change, by)| !field(change) || !by.is_finite())
        {
            return Err(Misfit("its state"));
        }
        let fits = |linearisation: &Linearisation| linearisation.fits(num_nodes, num_bordered, num_stored);
        if self.linearisation.as_ref().is_none_or(fits) { Ok(()) } else { Err(Misfit("its tangent")) }
    }
}

fn is_finite(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}
