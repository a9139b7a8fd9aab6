//! What a run found.

use pneuflex_newton::{ConvergedState, Timing};
use pneuflex_post::summary::StepSummary;

use crate::diagnosis::Warning;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// What people look at, at every requested pressure or time, in their order.
    pub states: Vec<StepSummary>,
    /// Displacements, reactions and so on of the same states; without those of an earlier run that this one went on from, and none at all
    /// after [`crate::Run::without_fields`].
    pub fields: Vec<ConvergedState>,
    /// The last equilibrium of a run that ended early, if it lies between requested positions.
    pub last: Option<ConvergedState>,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
    /// Newton iterations, those of rejected attempts included.
    pub iterations: usize,
    /// Seconds spent.
    pub timing: Timing,
}
