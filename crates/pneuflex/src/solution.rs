//! What a run found.

use pneuflex_model::LoadParameter;
use pneuflex_newton::{Cause, ConvergedState, Failure, Timing};
use pneuflex_post::summary::StepSummary;
use serde::{Serialize, Serializer};

use crate::diagnosis::Warning;
use crate::error_estimate::ErrorEstimate;
use crate::neighbour::Neighbour;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// How the run ended.
    pub status: Status,
    /// What people look at, at every requested pressure or time, in their order.
    pub states: Vec<StepSummary>,
    /// Displacements, reactions and so on of the same states; without those of an earlier run that this one went on from, and none at all
    /// after [`crate::Run::without_fields`].
    pub fields: Vec<ConvergedState>,
    /// The last equilibrium of a run that ended early, if it lies between requested positions.
    pub last: Option<ConvergedState>,
    /// How exact the last state is, if `output.error_estimate` asks for it and everything was reached.
    pub error_estimate: Option<ErrorEstimate>,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
    /// Newton iterations, those of rejected attempts included.
    pub iterations: usize,
    /// Seconds spent.
    pub timing: Timing,
    /// Whether guesses were taken from the path of a similar design, see [`crate::Run::start_from`].
    pub has_started_from: bool,
    /// Its equilibria for similar designs, after [`crate::Run::keep_equilibria`]; none of a path that has left a branch, snapped, or may have snapped.
    pub neighbour: Option<Neighbour>,
}

/// How a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// It goes on, or was killed.
    #[default]
    Running,
    /// Everything that was asked for was reached.
    Converged,
    /// The path was followed past a limit point to its end; requested positions above that were not reached.
    PastLimit,
    /// The path ended early.
    NotConverged,
    /// Somebody stopped it.
    Interrupted,
}

impl Status {
    const ALL: [Self; 5] = [Self::Running, Self::Converged, Self::PastLimit, Self::NotConverged, Self::Interrupted];

    /// That of a run that has ended, with `left` of the positions that were asked for; `has_error` says whether results could not be derived
    /// or recorded.
    pub fn at_end(left: &[LoadParameter], failure: Option<&Failure>, has_error: bool) -> Self {
        match failure {
            // A path that was stopped because of an error has not been interrupted by anybody.
            _ if has_error => Self::NotConverged,
            Some(Failure { cause: Cause::Interrupted, .. }) => Self::Interrupted,
            Some(_) => Self::NotConverged,
            None if left.is_empty() => Self::Converged,
            None => Self::PastLimit,
        }
    }

    /// Name in `summary.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Converged => "converged",
            Self::PastLimit => "past-limit",
            Self::NotConverged => "not-converged",
            Self::Interrupted => "interrupted",
        }
    }

    /// The status of a name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.name() == name)
    }
}

impl Serialize for Status {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
