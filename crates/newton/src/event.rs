//! What an observer is told while a path is followed.

use pneuflex_model::LoadParameter;

use crate::checkpoint::Checkpoint;
use crate::failure::Cause;
use crate::history::{ConvergedState, IterationRecord};

/// Who is told about everything that happens on a path.
pub type Observer<'a> = &'a mut dyn FnMut(Event<'_>);

/// What an observer is told while a path is followed.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// A load step is attempted.
    StepStarted {
        /// Load step, from 1.
        step: usize,
        /// Position aimed at.
        parameter: LoadParameter,
    },
    /// An iteration is done.
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
    /// A load step is done; the path can be resumed from here.
    StepAccepted(&'a Checkpoint),
    /// A requested position is reached.
    Converged(&'a ConvergedState),
}
