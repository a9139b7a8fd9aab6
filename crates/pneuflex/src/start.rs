//! Where a run begins, and whether it may go on from an earlier one, be that in a folder or in memory.

use std::collections::BTreeSet;

use pneuflex_model::{Clock, Continuation, LoadParameter};
use pneuflex_newton::Checkpoint;
use pneuflex_post::load_step::LoadStepSummary;
use pneuflex_post::summary::StepSummary;
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::analysis::Analysis;
use crate::input_error::InputError;
use crate::on_the_way::OnTheWay;
use crate::solution::{Solution, Status};

/// What was recorded when a load step was accepted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recorded {
    /// States that had been reached.
    pub steps: Vec<StepSummary>,
    /// Length of `history.jsonl`.
    pub history_bytes: u64,
    /// Seconds spent on derived quantities and files.
    pub output_s: f64,
    /// The load steps between requested positions that were solved to the tolerances.
    #[serde(default)]
    pub load_steps: Vec<LoadStepSummary>,
    /// States on the way to the next requested position.
    pub(crate) on_the_way: OnTheWay,
}

/// Where a run begins that may go on from an earlier one.
#[derive(Clone, Debug, Default)]
pub enum Start {
    /// At rest: there is nothing to go on with.
    #[default]
    AtRest,
    /// At an accepted load step of an earlier run.
    From(Box<(Recorded, Checkpoint)>),
    /// Nowhere: the earlier run reached everything that is asked for.
    Complete(Vec<StepSummary>),
}

/// What an earlier run has left.
pub(crate) struct Earlier<'a> {
    /// Its case, with every default.
    pub case: toml::Table,
    /// States that it reached.
    pub reached: Vec<StepSummary>,
    /// How it ended.
    pub status: Status,
    /// A key of which the files are other ones now, with the words for it.
    pub changed_files: Option<(String, String)>,
    /// Whether it solved the problem of an analysis.
    pub has_problem_of: &'a dyn Fn(&Analysis) -> bool,
    /// Its last load step, if it was kept.
    pub step: &'a dyn Fn() -> Result<Option<(Recorded, Checkpoint)>, String>,
}

impl Analysis {
    /// Where a run of this analysis is to go on from one that is kept in memory: `found` is what that found for the analysis `before`, `step` its last
    /// load step that was accepted, with the number of states that had been reached before. [`crate::OutputFolder::start`] says the same of
    /// one that was recorded.
    ///
    /// # Errors
    /// Another case, or positions that leave out what was reached.
    pub fn start_after(
        &self,
        before: &Self,
        found: &Solution,
        step: Option<(&Checkpoint, usize)>,
    ) -> Result<Start, InputError> {
        let recorded = |states: usize| {
            let steps = found.states.get(..states).unwrap_or(&found.states).to_vec();
            Recorded { steps, ..Recorded::default() }
        };
        let has_other_files = before.files()? != self.files()?;
        let earlier = Earlier {
            case: case_of(before)?,
            reached: found.states.clone(),
            status: found.status,
            changed_files: has_other_files
                .then(|| ("model.file".into(), "the files of the body are other ones".into())),
            has_problem_of: &|analysis| before.problem == analysis.problem,
            step: &|| Ok(step.map(|(checkpoint, states)| (recorded(states), checkpoint.clone()))),
        };
        let again = |what| InputError::new(what).with_help(Some("solve the case again".into()));
        earlier.start(self).map_err(again)
    }
}

/// The case of an analysis, with every default.
fn case_of(analysis: &Analysis) -> Result<toml::Table, InputError> {
    let wrong = |error: &dyn std::fmt::Display| InputError::new(error.to_string());
    analysis.resolved().map_err(|error| wrong(&error))?.parse().map_err(|error: toml::de::Error| wrong(&error))
}

impl Earlier<'_> {
    /// Where a run of an analysis is to go on.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn start(self, analysis: &Analysis) -> Result<Start, String> {
        let mut changes = changes(&self.case, &case_of(analysis).map_err(|error| error.to_string())?);
        changes.extend(self.changed_files);
        let has_all = requested_of(&self.reached).eq(analysis.requested.iter().copied());
        let is_complete = has_all && self.status == Status::Converged || self.status == Status::PastLimit;
        if changes.is_empty() && is_complete {
            return Ok(Start::Complete(self.reached));
        }
        let old_requested = requested_by(&self.case);
        let forbidden: Vec<_> =
            changes.iter().filter(|(key, _)| !may_change(key)).map(|(_, what)| what.as_str()).collect();
        if !forbidden.is_empty() {
            return Err(format!("the case has changed since: {}", forbidden.join("; ")));
        }
        // Nothing but the times has changed: where that changes the problem, loads follow them.
        let has_other_end = analysis.problem.clock == Clock::Steps && old_requested.last() != analysis.requested.last();
        if has_other_end && !(self.has_problem_of)(analysis) {
            return Err("loads without times of their own grow up to the last one of load.times, which has changed, so that what was \
                        reached was reached under other loads; give their values by time, [[time, value], ...], to go on beyond it"
                .into());
        }
        let Some((recorded, path)) = (self.step)()? else { return Ok(Start::AtRest) };
        if path.arc.is_past_limit() && analysis.solver.continuation != Continuation::ArcLength {
            return Err(
                "the path there has passed a limit point, which only solver.continuation = \"arc-length\" goes on from"
                    .into(),
            );
        }
        let count = requested_of(&recorded.steps).count();
        let requested = &analysis.requested;
        let at = path.parameter;
        let goes_on = requested_of(&recorded.steps).eq(requested.iter().copied().take(count))
            && requested.get(count).is_none_or(|next| *next >= at)
            // The last time reached may not be among the steps yet.
            && (!old_requested.contains(&at) || requested.contains(&at));
        if !goes_on {
            return Err(format!(
                "{} leaves out what was reached; it may only change beyond {}",
                if analysis.problem.clock == Clock::Pressure { "load.pressure_kpa" } else { "load.times" },
                analysis.problem.clock.words(at)
            ));
        }
        Ok(Start::From(Box::new((recorded, path))))
    }
}

/// Whether a run may go on with another value of a key: how the rest of the path is followed.
fn may_change(key: &str) -> bool {
    key == "output.error_estimate" || key == "load.pressure_kpa" || key == "load.times" || key.starts_with("solver.")
}

/// The positions on the load path that a case asks for, as far as it names them.
fn requested_by(case: &toml::Table) -> Vec<LoadParameter> {
    let load = case.get("load").and_then(Value::as_table);
    let list = load.and_then(|load| load.get("pressure_kpa").or_else(|| load.get("times"))).and_then(Value::as_array);
    list.into_iter().flatten().filter_map(Value::as_float).map(LoadParameter).collect()
}

/// Where the states are that were asked for.
fn requested_of(steps: &[StepSummary]) -> impl Iterator<Item = LoadParameter> {
    steps.iter().filter(|step| step.kind.is_requested()).map(StepSummary::when)
}

/// Keys of which two cases have different values, each with what it was and is.
fn changes(old: &toml::Table, new: &toml::Table) -> Vec<(String, String)> {
    let mut found = Vec::new();
    compare(Some(&Value::Table(old.clone())), Some(&Value::Table(new.clone())), "", &mut found);
    found
}

fn compare(old: Option<&Value>, new: Option<&Value>, key: &str, found: &mut Vec<(String, String)>) {
    let keys = [old, new].into_iter().flatten().filter_map(Value::as_table).flat_map(toml::Table::keys);
    if let (Some(Value::Table(_)) | None, Some(Value::Table(_)) | None) = (old, new) {
        let keys: BTreeSet<_> = keys.collect();
        for name in keys {
            let below = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            compare(old.and_then(|o| o.get(name)), new.and_then(|n| n.get(name)), &below, found);
        }
    } else if old != new {
        let text = |value: Option<&Value>| value.map_or("nothing".into(), Value::to_string);
        found.push((key.into(), format!("{key} was {} and is {}", text(old), text(new))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_model::Case;

    #[test]
    fn changes_of_a_case_are_named() {
        let text = crate::template::two_chambers();
        let old: Case = toml::from_str(&text).unwrap();
        let table = |case: &Case| toml::Table::try_from(case).unwrap();
        assert_eq!(changes(&table(&old), &table(&old)), []);
        let mut new = old.clone();
        new.material.law = pneuflex_model::Law::Yeoh { c10: 1.0, c20: 0.03053, c30: -0.000_401_3 };
        new.title = "other".into();
        let found = changes(&table(&old), &table(&new));
        let keys: Vec<_> = found.iter().map(|(key, _)| key.as_str()).collect();
        assert_eq!(keys, ["material.c10", "title"]);
        assert!(found[0].1.ends_with("and is 1.0"), "{}", found[0].1);
        assert!(!may_change("output.fields") && !may_change("material.c10") && may_change("solver.min_step_kpa"));
    }
}
