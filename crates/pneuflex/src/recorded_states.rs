//! The states that a result folder holds, as numbers.

use std::path::{Path, PathBuf};

use pneuflex_model::StateKind;
use pneuflex_post::load_step::LoadStepSummary;
use pneuflex_post::summary::StepSummary;
use serde::Deserialize;
use serde_json::Value;

use crate::error::Error;
use crate::report_page::{damaged, read, read_summary};

/// A state of a run.
#[derive(Clone, Debug)]
pub struct RecordedState {
    /// Where it stands on the load path: the pressure of an actuator, kPa, or the time of a model.
    pub parameter: f64,
    /// Why it is there.
    pub place: Place,
    /// Its numbers; `None` where the run did not come to it.
    pub numbers: Option<StepSummary>,
}

/// Why a state is among the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// It was asked for, or belongs to a path past its limit.
    OnPath(StateKind),
    /// It lies between the last state that was asked for and reached and where the run ended.
    OnTheWay,
}

/// What a run has written about its states.
#[derive(Clone, Debug)]
pub struct RecordedStates {
    /// The folder.
    pub folder: PathBuf,
    /// Whether states stand at times, and not at pressures.
    pub is_by_time: bool,
    /// In the order of the path.
    pub states: Vec<RecordedState>,
    /// The load steps between them, in the order of the path.
    pub load_steps: Vec<LoadStepSummary>,
}

#[derive(Deserialize)]
struct Steps {
    steps: Vec<Value>,
    #[serde(default)]
    on_the_way: Vec<Value>,
    #[serde(default)]
    load_steps: Vec<LoadStepSummary>,
}

impl RecordedStates {
    /// Those of a result folder.
    ///
    /// # Errors
    /// [`Error::Input`]: a folder that is none of this program's, or a `summary.json` that is damaged or another version's.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join("summary.json");
        let summary = read_summary(folder)?;
        let steps: Steps = serde_json::from_str(&read(&path)?).map_err(|e| damaged(&path, e))?;
        let state = |(value, step, is_on_the_way): (&Value, &pneuflex_report::summary::Step, bool)| {
            let numbers = step.converged.then(|| serde_json::from_value(value.clone()));
            let numbers = numbers.transpose().map_err(|e| damaged(&path, e))?;
            let place = if is_on_the_way { Place::OnTheWay } else { Place::OnPath(step.kind) };
            Ok(RecordedState { parameter: step.when(), place, numbers })
        };
        let asked_for = steps.steps.iter().zip(&summary.steps).map(|(value, step)| (value, step, false));
        let on_the_way = steps.on_the_way.iter().zip(&summary.on_the_way).map(|(value, step)| (value, step, true));
        // What was missed comes last: the states on the way lead to it.
        let (reached, missed): (Vec<_>, Vec<_>) = asked_for.partition(|(_, step, _)| step.converged);
        let states = reached.into_iter().chain(on_the_way).chain(missed).map(state).collect::<Result<_, Error>>()?;
        let is_by_time = summary.steps.iter().any(|step| step.time.is_some());
        Ok(Self { folder: folder.to_owned(), is_by_time, states, load_steps: steps.load_steps })
    }

    /// Whether the load parameter turned back, so that states may share it.
    pub fn has_turned(&self) -> bool {
        self.states.iter().any(|state| !matches!(state.place, Place::OnTheWay | Place::OnPath(StateKind::Requested)))
    }
}
