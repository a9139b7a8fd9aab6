//! Step control (theory §14): how far the next load step goes, and what becomes of the path when one fails.

use pneuflex_model::LoadParameter;

use super::{Converged, Path};
use crate::checkpoint::Approach;
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure};
use crate::history::ConvergedState;
use crate::state::Equilibrium;
use crate::tuning::Tuning;

/// A last step that would leave a crumb takes it along.
pub(super) const CRUMB: f64 = 1.01;

/// One step as it was tried.
pub(super) struct Attempt {
    pub(super) start: LoadParameter,
    /// Size that was wanted, and the one that the guess was good for.
    pub(super) wanted: f64,
    pub(super) tried: f64,
    /// Where that led to.
    pub(super) attempted: LoadParameter,
    pub(super) had_predictor: bool,
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
        self.last = requested;
        let mut approach = self.approach.take().unwrap_or_else(|| self.new_approach());
        approach.step = approach.step.min(self.settings.max_step);
        while self.equilibrium.state.parameter < requested {
            if let Some(found) = self.step_with_neighbour(requested, observer) {
                let (converged, attempt) = found?;
                self.accept(converged, &attempt, &mut approach, requested, observer)?;
                continue;
            }
            let start = self.equilibrium.state.parameter;
            let is_last = requested - start <= CRUMB * approach.step;
            let wanted = if is_last { requested } else { start + approach.step };
            self.step += 1;
            let had_predictor = self.predictor.is_some();
            let mut attempted = wanted;
            let outcome = self.load_step(&mut attempted, requested, observer);
            let (wanted, tried) = (wanted - start, attempted - start);
            let attempt = Attempt { start, wanted, tried, attempted, had_predictor };
            match outcome {
                Ok(converged) => self.accept(converged, &attempt, &mut approach, requested, observer)?,
                Err(cause) => match self.leave_branch(&cause, [attempted, requested], observer) {
                    Some(converged) => {
                        let attempted = converged.equilibrium.state.parameter;
                        let attempt = Attempt { tried: attempted - start, attempted, ..attempt };
                        self.accept(converged, &attempt, &mut approach, requested, observer)?;
                    }
                    None => {
                        if let Err(failure) = self.reject(cause, &attempt, &mut approach, observer) {
                            let converged = self.snap(failure, observer)?;
                            let attempted = converged.equilibrium.state.parameter;
                            let attempt = Attempt { attempted, ..attempt };
                            // Where it has come to is another place: the step is that of a beginning.
                            (approach.step, approach.rejected) = (self.settings.first_step, None);
                            self.accept(converged, &attempt, &mut approach, requested, observer)?;
                        }
                    }
                },
            }
        }
        Ok(self.describe(self.iterations - approach.iterations_before, approach.load_steps))
    }

    pub(super) fn new_approach(&self) -> Approach {
        let is_at_rest = self.equilibrium.state.parameter <= LoadParameter::default();
        let step =
            if is_at_rest { self.settings.first_step.max(self.settings.min_step) } else { self.settings.max_step };
        Approach { step, rejected: None, load_steps: 0, iterations_before: self.iterations }
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
        let is_easy = converged.iterations <= self.tuning.easy_iterations;
        approach.after_accepted(attempt.wanted, is_easy, self.settings.max_step, &self.tuning);
        let before = self.equilibrium.clone();
        if converged.has_jumped {
            self.snaps.push(self.jump(&converged));
        }
        self.adopt(converged);
        self.is_careful &= attempt.attempted != requested;
        self.keep_equilibrium();
        self.complete(before, attempt, attempt.attempted == requested, observer)?;
        let checkpoint = self.checkpoint(*approach);
        observer(Event::StepAccepted(&checkpoint));
        Ok(())
    }

    /// What is done beside the equilibrium itself at a state that is told of. `before` is the equilibrium before it.
    pub(super) fn complete(
        &mut self,
        before: Equilibrium,
        attempt: &Attempt,
        is_told: bool,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        self.augmentation = None;
        if !is_told {
            return Ok(());
        }
        self.finish(observer).map_err(|cause| {
            if let Cause::HeldBySprings { .. } = cause {
                // It is no equilibrium of the body.
                self.equilibrium = before;
            }
            self.failure(attempt.attempted, cause)
        })
    }

    fn finish(&mut self, observer: Observer<'_>) -> Result<(), Cause> {
        self.release(observer)?;
        if self.system.is_augmented() {
            self.augment(observer)?;
            self.release(observer)?;
        }
        Ok(())
    }

    /// The last load step counts no more: whoever records or resumes begins at the one before.
    fn tell_of_going_back(&self, start: LoadParameter, approach: &Approach, observer: Observer<'_>) {
        if self.equilibrium.state.parameter < start {
            observer(Event::StepAccepted(&self.checkpoint(*approach)));
        }
    }

    /// Halves the step.
    pub(super) fn reject(
        &mut self,
        cause: Cause,
        attempt: &Attempt,
        approach: &mut Approach,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        let &Attempt { start, wanted, tried, attempted, had_predictor } = attempt;
        self.system.revert();
        // A smaller step helps against none of them.
        if matches!(cause, Cause::Interrupted | Cause::OutOfMemory(_) | Cause::Rounding { .. }) {
            return Err(self.failure(attempted, cause));
        }
        observer(Event::StepRejected { step: self.step, parameter: attempted, cause: &cause });
        let least = self.settings.min_step;
        approach.after_rejected(tried);
        if std::mem::take(&mut self.equilibrium.is_inexact) {
            // What is left of its residual misleads the guess; solved to the tolerances it gets a longer step again.
            self.confirm(observer);
            let again = self.tuning.step_after_polishing * wanted;
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

impl Approach {
    /// Chooses the step after one of a size that was accepted: the same, or twice as large after an `is_easy` one.
    pub(super) fn after_accepted(&mut self, size: f64, is_easy: bool, max_step: f64, tuning: &Tuning) {
        if is_easy {
            self.step = (2.0 * size).min(max_step);
        }
        // What was too long just before is hardly right now.
        if let Some(rejected) = &mut self.rejected {
            self.step = self.step.min(tuning.step_after_rejection * *rejected);
            *rejected *= tuning.forgetting;
        }
    }

    /// Halves a size that was rejected.
    fn after_rejected(&mut self, size: f64) {
        self.step = 0.5 * size;
        self.rejected = Some(size);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_that_was_rejected_is_not_tried_again_at_once() {
        let tuning = Tuning::default();
        let mut approach = Approach { step: 1.0, rejected: None, load_steps: 0, iterations_before: 0 };
        approach.after_accepted(1.0, true, 10.0, &tuning);
        assert_eq!(approach.step, 2.0);
        approach.after_rejected(2.0);
        assert_eq!(approach.step, 1.0);
        let mut tried = Vec::new();
        for _ in 0..6 {
            approach.after_accepted(approach.step, true, 10.0, &tuning);
            tried.push(approach.step);
        }
        assert!(tried[0] < 1.5 && tried.is_sorted(), "{tried:?}");
        // It is forgotten by and by.
        assert!(tried[1] < 2.0 && tried[5] > 3.0, "{tried:?}");
        // A difficult step is not followed by a larger one.
        let before = approach.step;
        approach.after_accepted(before, false, 10.0, &tuning);
        assert_eq!(approach.step, before);
    }
}
