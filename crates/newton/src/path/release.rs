//! How the springs that help what only contact holds come to carry nothing.

use super::Path;
use crate::convergence::Criteria;
use crate::event::Observer;
use crate::failure::Cause;
use crate::state::State;

/// Springs are moved along at most so often at one load.
const MOST_RELEASES: usize = 30;

impl Path {
    /// Moves the springs along and solves again until they carry nothing that counts.
    ///
    /// # Errors
    /// [`Cause::HeldBySprings`] where nothing else holds the body, and what a solution ends with.
    pub(super) fn release(&mut self, observer: Observer<'_>) -> Result<(), Cause> {
        let mut left = 0.0;
        for _ in 0..MOST_RELEASES {
            let state = self.equilibrium.state.clone();
            let Some(force) = self.system.vanishing_force(&state.displacement) else { return Ok(()) };
            let allowed = self.allowed_residual(&state)?;
            if force <= allowed {
                return Ok(());
            }
            left = force;
            let at_hand = self.take_tangent();
            self.system.begin_step(&state);
            self.system.predict(&state.displacement, None);
            let converged = self.solve_near(at_hand, observer)?;
            self.adopt(converged);
        }
        Err(Cause::HeldBySprings { force: left })
    }

    /// Residual that an equilibrium may have, N.
    fn allowed_residual(&mut self, state: &State) -> Result<f64, Cause> {
        let is_driven = self.motion.is_driving();
        let Self { system, settings, scales, .. } = self;
        let criteria = Criteria::new(system, settings, scales, state, is_driven)?;
        let assembled = system.residual(state)?;
        let supports = system.held_norm(&assembled.residual);
        Ok(criteria.allowed(supports))
    }
}
