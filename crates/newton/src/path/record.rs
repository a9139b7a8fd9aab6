//! A path as data: what it goes on from, and what an observer is told.

use super::Path;
use crate::checkpoint::{Approach, Checkpoint};
use crate::history::ConvergedState;
use crate::state::Equilibrium;

impl Path {
    /// What a path goes on from that is ended here.
    pub(super) fn checkpoint(&self, approach: Approach) -> Checkpoint {
        let Equilibrium { state, multipliers, contact_points, is_inexact, mesh_motions, negative_pivots } =
            self.equilibrium.clone();
        Checkpoint {
            parameter: state.parameter,
            displacement: state.displacement,
            bordered: state.bordered,
            multipliers,
            contact_points,
            is_inexact,
            step: self.step,
            iterations: self.iterations,
            timing: self.timing(),
            approach,
            first_rate: self.first_rate,
            linearisation: self.predictor.as_ref().map(|tangent| tangent.linearisation().clone()),
            contact_multipliers: self.system.contact_multipliers(),
            augmentation: self.augmentation.clone(),
            mesh_motions,
            is_careful: self.is_careful,
            negative_pivots,
            arc: self.arc.clone(),
            bifurcations: self.bifurcations.clone(),
            snaps: self.snaps.clone(),
        }
    }

    /// The present equilibrium as data.
    pub(super) fn describe(&self, iterations: usize, load_steps: usize) -> ConvergedState {
        let Equilibrium { state, multipliers, contact_points, mesh_motions, .. } = &self.equilibrium;
        ConvergedState {
            parameter: state.parameter,
            kind: self.arc.untold.unwrap_or_default(),
            negative_pivots: self.equilibrium.negative_pivots,
            displacement: state.displacement.clone(),
            reaction: multipliers.as_chunks().0.iter().map(|lambda: &[f64; 3]| lambda.map(|l| -l)).collect(),
            iterations,
            load_steps,
            contact_points: *contact_points,
            cavity_pressures: self.pressures.at(state),
            contact_multipliers: self.system.contact_multipliers(),
            augmentation: self.augmentation.clone(),
            mesh_motions: *mesh_motions,
            bifurcations: self.bifurcations.clone(),
            snaps: self.snaps.clone(),
        }
    }
}
