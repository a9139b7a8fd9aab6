//! How firm an equilibrium is ([`Stability`](crate::Stability), theory §15): its inertia comes with the tangent (`tangent_solver`); here is how much
//! it gives way.

use pneuflex_assembly::LocalError;

use crate::error::AssembleError;
use crate::prescribed_motion::PrescribedMotion;
use crate::state::State;
use crate::system::System;

/// Change of the load parameter that the softening is measured with, relative to the parameter.
const CHANGE: f64 = 1e-3;

/// Largest stretching per load parameter at an equilibrium, from the exact tangent there.
///
/// # Errors
/// A singular tangent: as unstable as can be told.
pub(crate) fn stretching_rate(
    system: &mut System,
    state: &State,
    motion: &PrescribedMotion,
    least_change: f64,
) -> Result<f64, AssembleError> {
    let change = (CHANGE * state.parameter.0).max(least_change);
    system.predict(&state.displacement, None);
    let (_, tangent) = system.tangent(state)?;
    let next = state.moved_to(state.parameter + change);
    let assembled = system.residual(&next)?;
    let correction = system.solve(&tangent, &assembled, motion.change(&next).as_deref())?;
    let rate = system.extent(&state.displacement, &correction.displacement).stretch / change;
    system.recycle(Some(tangent));
    Ok(rate)
}

impl System {
    /// Whether a displacement that solves the equations may count as an equilibrium.
    ///
    /// # Errors
    /// An element that is turned inside out where the equations did not notice.
    pub fn check_equilibrium(&self, displacement: &[[f64; 3]]) -> Result<(), LocalError> {
        self.contributions.iter().try_for_each(|contribution| contribution.check_equilibrium(displacement))
    }
}
