//! Step control (theory §14): how far the next load step goes, and what becomes of the path when one fails.

use pneuflex_model::LoadParameter;

use super::{Converged, Path};
use crate::checkpoint::Approach;
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure};
use crate::history::ConvergedState;

/// A last step that would leave a crumb takes it along.
const CRUMB: f64 = 1.01;

/// One load step as it was tried.
struct Attempt {
    start: LoadParameter,
    wanted: LoadParameter,
    /// Where the guess was good for.
    attempted: LoadParameter,
    had_predictor: bool,
}

impl Path {
    /// Steps from the present equilibrium to `parameter` and reaches it exactly.
    ///
    /// # Errors
    /// [`Failure`] when the step falls below its least size; the present equilibrium is then the last one reached.
    pub fn advance_to(
        &mut self,
        parameter: impl Into<LoadParameter>,
        observer: Observer<'_>,
    ) -> Result<ConvergedState, Failure> {
        let requested = parameter.into();
        let mut approach = self.approach.take().unwrap_or_else(|| self.new_approach());
        approach.step = approach.step.min(self.settings.max_step);
        while self.equilibrium.state.parameter < requested {
            let start = self.equilibrium.state.parameter;
            let is_last = requested - start <= CRUMB * approach.step;
            let wanted = if is_last { requested } else { start + approach.step };
            self.step += 1;
            let had_predictor = self.predictor.is_some();
            let mut attempted = wanted;
            let outcome = self.load_step(&mut attempted, requested, observer);
            let attempt = Attempt { start, wanted, attempted, had_predictor };
            match outcome {
                Ok(converged) => self.accept(converged, &attempt, &mut approach, requested, observer)?,
                Err(cause) => self.reject(cause, &attempt, &mut approach, observer)?,
            }
        }
        Ok(self.describe(self.iterations - approach.iterations_before, approach.load_steps))
    }

    fn new_approach(&self) -> Approach {
        let is_at_rest = self.equilibrium.state.parameter <= LoadParameter::default();
        let step =
            if is_at_rest { self.settings.first_step.max(self.settings.min_step) } else { self.settings.max_step };
        Approach { step, load_steps: 0, iterations_before: self.iterations }
    }

    fn accept(
        &mut self,
        converged: Converged,
        attempt: &Attempt,
        approach: &mut Approach,
        requested: LoadParameter,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        approach.load_steps += 1;
        if converged.iterations <= self.tuning.easy_iterations {
            approach.step = (2.0 * (attempt.wanted - attempt.start)).min(self.settings.max_step);
        }
        self.adopt(converged);
        self.augmentation = None;
        self.is_careful &= attempt.attempted != requested;
        if attempt.attempted == requested && self.system.is_augmented() {
            self.augment(observer).map_err(|cause| self.failure(attempt.attempted, cause))?;
        }
        let checkpoint = self.checkpoint(*approach);
        observer(Event::StepAccepted(&checkpoint));
        Ok(())
    }

    /// The last load step counts no more: whoever records or resumes begins at the one before.
    fn tell_of_going_back(&self, start: LoadParameter, approach: &Approach, observer: Observer<'_>) {
        if self.equilibrium.state.parameter < start {
            observer(Event::StepAccepted(&self.checkpoint(*approach)));
        }
    }

    /// Halves the step.
    fn reject(
        &mut self,
        cause: Cause,
        attempt: &Attempt,
        approach: &mut Approach,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        let &Attempt { start, wanted, attempted, had_predictor } = attempt;
        self.system.revert();
        // A smaller step helps against neither.
        if matches!(cause, Cause::Interrupted | Cause::OutOfMemory(_)) {
            return Err(self.failure(attempted, cause));
        }
        observer(Event::StepRejected { step: self.step, parameter: attempted, cause: &cause });
        let least = self.settings.min_step;
        approach.step = 0.5 * (attempted - start);
        if std::mem::take(&mut self.equilibrium.is_inexact) {
            // What is left of its residual misleads the guess; solved to the tolerances it gets a longer step again.
            self.confirm(observer);
            let again = self.tuning.step_after_polishing * (wanted - start);
            approach.step = approach.step.max(again).max(least);
        }
        if had_predictor {
            // The guess came from a tangent near the equilibrium; the one at the equilibrium gets its chance.
            approach.step = approach.step.max(least);
        }
        if approach.step < least {
            self.confirm(observer);
            self.tell_of_going_back(start, approach, observer);
            return Err(self.failure(attempted, cause));
        }
        self.tell_of_going_back(start, approach, observer);
        Ok(())
    }
}
