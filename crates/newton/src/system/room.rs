//! The equations with room in the tangent's pattern, and those at a state at which they stay.

use std::sync::Arc;

use pneuflex_assembly::{Contribution, Elimination, Position, Totals, Unilateral};
use pneuflex_factor::{Ordering, Parallelism, Symbolic};
use pneuflex_mesh::Mesh;
use pneuflex_model::Problem;

use super::System;
use super::assembling::{assembler_of, unilateral};
use crate::contributions::contributions_of;
use crate::error::SetupError;
use crate::state::State;
use crate::timing::Timing;

impl System {
    /// The equations of a problem at a state, at which they stay: the tangent's pattern has room for the contact there, and corrections are
    /// applied along straight lines.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn at(problem: &Problem, state: &State, parallelism: Parallelism) -> Result<Self, SetupError> {
        let held = problem.held_dofs();
        let (elimination, left) = Elimination::of(&problem.equations, problem.mesh.num_nodes(), &held);
        let mut contributions = contributions_of(problem, &left, false)?;
        let contact = contributions.iter_mut().filter(|contribution| contribution.unilateral().is_some());
        contact.for_each(|contact| contact.set_position(Position { bordered: &[], ..state.position() }));
        let near: Vec<Vec<u32>> = unilateral(&contributions).flat_map(Unilateral::near_nodes).collect();
        Self::with_room(&problem.mesh, (held, elimination), contributions, &near, parallelism)
    }

    /// The same as [`Self::with_contributions`] with room for groups of nodes in the tangent's pattern, for displacements that do not move.
    pub(super) fn with_room(
        mesh: &Arc<Mesh>,
        (held, elimination): (Vec<bool>, Elimination),
        contributions: Vec<Box<dyn Contribution>>,
        near: &[Vec<u32>],
        parallelism: Parallelism,
    ) -> Result<Self, SetupError> {
        let with_masters = |group: &Vec<u32>| elimination.with_masters(group).unwrap_or_else(|| group.clone());
        let near: Vec<Vec<u32>> = near.iter().map(with_masters).collect();
        let assembler = assembler_of(mesh.num_nodes(), &contributions, &elimination, &near);
        let mut fixed = held.clone();
        elimination.slaves().for_each(|slave| fixed[slave] = true);
        let symbolic = Arc::new(Symbolic::analyze(assembler.pattern(), Ordering::default())?);
        Ok(Self {
            num_bordered: contributions.iter().map(|contribution| contribution.num_bordered()).sum(),
            contributions,
            assembler,
            symbolic,
            rotation_update: None,
            totals: Totals::default(),
            held: held.into(),
            elimination: Arc::new(elimination),
            fixed: fixed.into(),
            spacing: mesh.mean_node_spacing(),
            parallelism,
            buffers: None,
            responses: None,
            timing: Timing::default(),
        })
    }
}
