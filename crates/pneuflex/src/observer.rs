//! What an observer is told while a path is followed, and how to stop it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pneuflex_model::LoadParameter;
use pneuflex_newton::{Cause, Checkpoint, ConvergedState, Failure, IterationRecord, PathReport};
use pneuflex_post::summary::{Described, StepSummary};

use crate::error::ResultsError;
use crate::error_estimate::ErrorEstimate;
use crate::reason::Reason;

/// What happens while a path is followed.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// A load step is attempted.
    StepStarted {
        /// Load step, from 1.
        step: usize,
        /// Position aimed at on the load path: the pressure in kPa for actuators.
        parameter: LoadParameter,
    },
    /// A Newton iteration is done.
    Iteration(&'a IterationRecord),
    /// An attempt failed; the step is halved.
    StepRejected {
        /// Load step, from 1.
        step: usize,
        /// Position aimed at.
        parameter: LoadParameter,
        /// Why.
        cause: &'a Cause,
    },
    /// A load step is done; the path can be resumed from here, see [`crate::Run::resume_from`].
    StepAccepted(&'a Checkpoint),
    /// A requested pressure or time is reached.
    State(ReachedState<'a>),
}

/// An equilibrium at a requested time, with what was derived from it.
#[derive(Clone, Copy, Debug)]
pub struct ReachedState<'a> {
    /// What people look at, as `summary.json` has it.
    pub summary: &'a StepSummary,
    /// Displacements, reactions, pressures and multipliers.
    pub equilibrium: &'a ConvergedState,
    /// Stresses and what the contact carries.
    pub described: &'a Described,
    /// Seconds that deriving all this took.
    pub seconds: f64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug)]
pub struct End<'a> {
    /// Iterations and seconds.
    pub report: &'a PathReport,
    /// Why the path ended early, if it did.
    pub failure: Option<&'a Failure>,
    /// The same in the words of somebody who designs actuators.
    pub reason: Option<&'a Reason>,
    /// The last equilibrium of a path that ended early, if it lies between requested positions.
    pub last: Option<&'a ConvergedState>,
    /// How exact the last state is, if that was asked for.
    pub estimate: Option<&'a ErrorEstimate>,
    /// What could not be derived or recorded, for which the path was stopped.
    pub error: Option<&'a ResultsError>,
}

/// Somebody who is told what happens while a path is followed. A closure will do for most, see [`crate::Run::observer`].
pub trait Observer: Send {
    /// Told of everything that happens.
    ///
    /// # Errors
    /// What makes it useless to go on: the path is stopped.
    fn observe(&mut self, event: &Event<'_>) -> Result<(), ResultsError>;

    /// Told once, at the end.
    ///
    /// # Errors
    /// What could not be recorded.
    fn finish(&mut self, end: &End<'_>) -> Result<(), ResultsError> {
        let _ = end;
        Ok(())
    }
}

/// A closure as an observer.
pub(crate) struct Listener<F>(pub F);

impl<F: FnMut(&Event<'_>) + Send> Observer for Listener<F> {
    fn observe(&mut self, event: &Event<'_>) -> Result<(), ResultsError> {
        (self.0)(event);
        Ok(())
    }
}

/// Stops runs from another thread or a signal: copies are one and the same token.
#[derive(Clone, Debug, Default)]
pub struct StopToken(Arc<AtomicBool>);

impl StopToken {
    /// A token that has not been used.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks all runs that have this token to end before their next iteration; returns whether they had been asked already.
    pub fn stop(&self) -> bool {
        self.0.swap(true, Ordering::Relaxed)
    }

    /// Whether they have been asked to.
    pub fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
