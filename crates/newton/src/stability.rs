//! How firm an equilibrium is ([`Stability`](crate::Stability), theory §15): its inertia comes with the tangent (`tangent_solver`); here is how much
//! it gives way.

use pneuflex_assembly::LocalError;
use pneuflex_factor::FactorError;

use crate::error::AssembleError;
use crate::prescribed_motion::PrescribedMotion;
use crate::state::{Correction, State, difference};
use crate::system::System;
use crate::tangent_solver::Tangent;

/// Change of the load parameter that the softening is measured with, relative to the parameter.
const CHANGE: f64 = 1e-3;

/// Stretching below this is rounding: nothing is said of it.
const NO_STRETCH: f64 = 1e-12;

/// How a body gives way to a small change of its loads.
pub(crate) struct Response {
    /// Largest stretching per change of the forces, 1/N.
    pub rate: f64,
    /// The motion, mm, one entry per node.
    pub motion: Vec<[f64; 3]>,
}

/// How a body gives way at an equilibrium, from the exact tangent there; `None` where the loads do not change.
///
/// # Errors
/// A singular tangent: as unstable as can be told.
pub(crate) fn stretching_rate(
    system: &mut System,
    state: &State,
    motion: &PrescribedMotion,
    least_change: f64,
) -> Result<Option<Response>, AssembleError> {
    let change = (CHANGE * state.parameter.0).max(least_change);
    system.predict(&state.displacement, None);
    let (left, tangent) = system.tangent(state)?;
    let next = state.moved_to(state.parameter + change);
    let mut assembled = system.residual_ahead(&tangent, state, next.parameter)?;
    // Only what is new: the state may be an inexact one.
    assembled.residual = difference(&assembled.residual, &left.residual);
    for (equation, left) in assembled.equations.iter_mut().zip(&left.equations) {
        equation.value -= left.value;
    }
    let correction = system.solve(&tangent, &assembled, motion.change(&next).as_deref())?;
    let rate = compliance(system, &tangent, state, &correction)?;
    system.recycle(Some(tangent));
    Ok(rate.map(|rate| Response { rate, motion: correction.displacement }))
}

/// Largest stretching by a correction per norm of the forces on the free degrees of freedom that bring it about, 1/N. These forces are those
/// of loads, of supports that move and of air that is pumped in alike, and do not depend on what the load parameter counts. `None` if the
/// correction deforms nothing.
///
/// # Errors
/// A correction of another problem.
pub(crate) fn compliance(
    system: &mut System,
    tangent: &Tangent,
    state: &State,
    correction: &Correction,
) -> Result<Option<f64>, FactorError> {
    let stretch = system.extent(&state.displacement, &correction.displacement).stretch;
    let force = system.free_norm(&tangent.forces_of_free(correction)?);
    Ok((stretch > NO_STRETCH && force > 0.0).then(|| stretch / force))
}

impl System {
    /// Whether a displacement that solves the equations may count as an equilibrium.
    ///
    /// # Errors
    /// An element that is turned inside out where the equations did not notice.
    pub fn check_equilibrium(&self, displacement: &[[f64; 3]]) -> Result<(), LocalError> {
        self.contributions.iter().try_for_each(|contribution| contribution.check_equilibrium(displacement))
    }

    /// Mean volumetric pressure of every element at a displacement, MPa, tension positive.
    pub(crate) fn element_tensions(&self, displacement: &[[f64; 3]]) -> Vec<f64> {
        self.contributions.iter().flat_map(|contribution| contribution.element_tensions(displacement)).collect()
    }
}
