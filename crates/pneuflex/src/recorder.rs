//! What a run leaves on disk, kept up to date while it goes on.

use std::collections::BTreeMap;
use std::fs::File;
use std::time::Instant;

use pneuflex_model::{Clock, Control, LoadParameter, Pressure, SymmetryPlane};
use pneuflex_newton::{Checkpoint, ConvergedState, IterationRecord, Timing};
use pneuflex_post::load_step::LoadStepSummary;
use pneuflex_post::summary::{Described, ProbeSite, StepSummary, probe_sites};
use pneuflex_post::vtu::{SeriesEntry, series};
use pneuflex_report::summary::FORMAT;
use serde::Serialize;

use crate::analysis::Analysis;
use crate::checkpoint_file;
use crate::derived;
use crate::diagnosis::Warning;
use crate::error::{ResultsError, end_in_words};
use crate::error_estimate::ErrorEstimate;
use crate::files::{Files, INCLUDED, INPUT, included_name};
use crate::folder::{CASE_MARK, OutputFolder, REPORT};
use crate::json;
use crate::observer::{End, Event, Observer, ReachedState};
use crate::on_the_way::{OnTheWay, on_the_way_number};
use crate::reason::Reason;
use crate::solution::Status;
use crate::start::Recorded;

/// File of the iterations, one a line.
const HISTORY: &str = "history.jsonl";

/// File that lists the field files with their times.
const SERIES: &str = "fields/series.pvd";

/// Names of the field files of a state: the body, the walls that may touch, the integration points.
pub const FIELDS: [&str; 3] = ["step", "contact", "points"];

/// Load steps on the way whose fields are kept, at the most.
const ON_THE_WAY: usize = 6;

/// `summary.json`. Its keys are a contract: later versions add to them, and what changes its meaning raises the format.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    format: u32,
    title: &'a str,
    status: Status,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure_reason: Option<&'a Reason>,
    warnings: Vec<Warning>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error_estimate: Option<&'a ErrorEstimate>,
    /// What results are those of: `whole-body`, or `model` for a deck or mesh of which it is not known whether it is cut.
    results_of: &'static str,
    /// What was modelled of the whole body: `whole`, `half`, `quarter` or `eighth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    modelled: Option<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    symmetry_planes: Vec<String>,
    mesh: MeshSummary,
    probes: &'a BTreeMap<String, ProbeSite>,
    steps: Vec<Step<'a>>,
    /// Of a run that ended early: states between the last requested pressure that was reached and the next, the last converged one at the end.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    on_the_way: &'a [StepSummary],
    /// The load steps between those of `steps` that were solved to the tolerances.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    load_steps: &'a [LoadStepSummary],
    iterations_total: usize,
    timing: RunTiming,
}

#[derive(Clone, Debug, Serialize)]
struct MeshSummary {
    nodes: usize,
    elements: usize,
    unknowns: usize,
    element: String,
}

/// A requested pressure: reached, or the one at which the run ended.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Step<'a> {
    Reached(&'a StepSummary),
    Missed(Missed),
}

/// The pressure (kPa) or time at which the run ended.
#[derive(Clone, Copy, Debug, Serialize)]
struct Missed {
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    /// Of a model, that of its first cavity, if it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure_kpa: Option<f64>,
    converged: bool,
    iterations: usize,
}

/// A line of `history.jsonl`.
#[derive(Debug, Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    record: &'a IterationRecord,
    /// The time of an actuator.
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure_kpa: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
struct RunTiming {
    #[serde(flatten)]
    path: Timing,
    /// Derived quantities and files.
    output_s: f64,
}

/// How a run ended, for the summary.
#[derive(Debug)]
struct Ending {
    status: Status,
    failure: Option<String>,
    reason: Option<Reason>,
    missed: Vec<Missed>,
    on_the_way: Vec<StepSummary>,
    estimate: Option<ErrorEstimate>,
}

/// Writes the output folder of a run: the resolved case, the history of iterations, a checkpoint at every load step, the summary and the
/// fields.
pub struct Recorder<'a> {
    folder: OutputFolder,
    history: File,
    history_bytes: u64,
    analysis: &'a Analysis,
    mesh: MeshSummary,
    probes: BTreeMap<String, ProbeSite>,
    steps: Vec<StepSummary>,
    iterations: usize,
    timing: RunTiming,
    series: Vec<SeriesEntry>,
    began: Instant,
    /// Iterations reported since the last requested time that was reached.
    open_iterations: usize,
    on_the_way: OnTheWay,
    load_steps: Vec<LoadStepSummary>,
}

impl<'a> Recorder<'a> {
    /// Starts the output of a run in a folder that [`OutputFolder::begin`] has emptied, or goes on with what was recorded up to a
    /// checkpoint: the resolved case, the history, the summary.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(folder: OutputFolder, analysis: &'a Analysis, recorded: Recorded) -> Result<Self, ResultsError> {
        let problem = &analysis.problem;
        let mesh = MeshSummary {
            nodes: problem.mesh.num_nodes(),
            elements: problem.mesh.num_elements(),
            unknowns: problem.num_unknowns(),
            element: problem.element_names(),
        };
        folder.remove_partial_files()?;
        // It shows what the run goes beyond now.
        folder.remove(REPORT)?;
        write_case(&folder, analysis)?;
        let history = folder.append(HISTORY, recorded.history_bytes)?;
        let length = history.metadata().map_err(|e| folder.cannot_write(HISTORY, e))?.len();
        let mut recorder = Self {
            folder,
            history,
            history_bytes: recorded.history_bytes.min(length),
            analysis,
            mesh,
            probes: probe_sites(&problem.mesh, &analysis.probes),
            steps: Vec::new(),
            iterations: 0,
            timing: RunTiming { output_s: recorded.output_s, ..RunTiming::default() },
            series: Vec::new(),
            began: Instant::now(),
            open_iterations: 0,
            on_the_way: recorded.on_the_way,
            load_steps: recorded.load_steps,
        };
        recorder.remove_states_on_the_way()?;
        for step in recorded.steps {
            recorder.iterations += step.iterations;
            recorder.steps.push(step);
            recorder.list_fields(recorder.along_steps(), &format!("{:02}", recorder.steps.len()));
        }
        if recorder.folder.path().join(SERIES).is_file() {
            recorder.folder.write(SERIES, series(&recorder.series))?;
        }
        recorder.write_summary(None)?;
        recorder.folder.has_begun()?;
        Ok(recorder)
    }

    /// Removes the fields of states on the way that an earlier run ended with: this one goes on beyond them.
    fn remove_states_on_the_way(&self) -> Result<(), ResultsError> {
        let mut names = (1..=ON_THE_WAY).flat_map(|number| FIELDS.map(|name| (number, name)));
        names.try_for_each(|(number, name)| {
            self.folder.remove(&format!("fields/{name}_{}.vtu", on_the_way_number(number)))
        })
    }

    /// The requested positions that have not been reached.
    fn left(&self) -> &[LoadParameter] {
        self.analysis.left(&self.steps)
    }

    /// How far the last state is along the path: its position, or where that turned back the greatest one and how far it has gone since.
    /// Viewers sort states by it.
    fn along_steps(&self) -> f64 {
        let mut along = 0.0;
        for pair in self.steps.windows(2) {
            along += (pair[1].when() - pair[0].when()).abs() - (pair[1].when() - pair[0].when());
        }
        along + self.steps.last().map_or(0.0, |step| step.when().0)
    }

    /// Lists the field files of a state in the series, as far as they are there.
    fn list_fields(&mut self, time: f64, number: &str) {
        for (part, name) in FIELDS.into_iter().enumerate() {
            let file = format!("{name}_{number}.vtu");
            if self.folder.path().join("fields").join(&file).is_file() {
                self.series.push(SeriesEntry { time, part, file });
            }
        }
    }

    fn iteration(&mut self, record: &IterationRecord) -> Result<(), ResultsError> {
        // A correction with the factor of the one before is no iteration of its own.
        let is_new = usize::from(record.new_tangent);
        self.iterations += is_new;
        self.open_iterations += is_new;
        let pressure_kpa = (self.analysis.problem.clock == Clock::Pressure).then_some(record.parameter.0);
        let line = json::line(&Line { record, pressure_kpa });
        let line = line.map_err(|why| ResultsError::not_representable(HISTORY, why))?;
        self.history_bytes += line.len() as u64;
        self.folder.add(HISTORY, &mut self.history, &line)
    }

    /// Records an accepted load step, to go on from if the run ends here.
    fn step_accepted(&mut self, path: &Checkpoint) -> Result<(), ResultsError> {
        let began = Instant::now();
        let steps = self.steps.clone();
        let from = self.steps.last().map_or(LoadParameter::default(), StepSummary::when);
        // Beyond a limit point every state is among the results.
        if let Some(&to) = self.left().first().filter(|_| !path.arc.is_past_limit()) {
            self.on_the_way.accept(path, [from, to]);
            // Where a step is solved well enough to go on from only, forces may be anything.
            if !path.is_inexact && from < path.parameter && path.parameter < to {
                // A path that has gone back to be more careful comes by once more.
                self.load_steps.retain(|step| step.when() < path.parameter);
                self.load_steps.extend(derived::describe_load_step(&self.analysis.problem, &self.probes, path));
            }
        }
        let (history_bytes, output_s) = (self.history_bytes, self.timing.output_s);
        let (load_steps, on_the_way) = (self.load_steps.clone(), self.on_the_way.clone());
        let recorded = Recorded { steps, history_bytes, output_s, load_steps, on_the_way };
        // The checkpoint counts on the history's lines.
        self.history.sync_data().map_err(|e| self.folder.cannot_write(HISTORY, e))?;
        checkpoint_file::store(&self.folder, &recorded, path)?;
        self.timing.output_s += began.elapsed().as_secs_f64();
        Ok(())
    }

    fn state(&mut self, state: &ReachedState<'_>) -> Result<(), ResultsError> {
        let began = Instant::now();
        self.steps.push(state.summary.clone());
        if self.analysis.output.fields {
            let number = format!("{:02}", self.steps.len());
            self.write_fields((self.along_steps(), &number), state.described, state.equilibrium)?;
        }
        self.on_the_way.clear();
        self.timing.output_s += state.seconds + began.elapsed().as_secs_f64();
        self.timing.path.total_s = self.began.elapsed().as_secs_f64();
        self.open_iterations = 0;
        self.write_summary(None)
    }

    fn write_fields(
        &mut self,
        (along, number): (f64, &str),
        described: &Described,
        equilibrium: &ConvergedState,
    ) -> Result<(), ResultsError> {
        let [body, walls] = derived::field_files(&self.analysis.problem, described, equilibrium)?;
        let points =
            self.analysis.output.points.then(|| derived::points_file(&self.analysis.problem, described, equilibrium));
        for (name, text) in FIELDS.into_iter().zip([body, walls, points.transpose()?]) {
            if let Some(text) = text {
                self.folder.write(&format!("fields/{name}_{number}.vtu"), &text)?;
            }
        }
        for (index, left) in equilibrium.bifurcations.iter().enumerate() {
            let text = derived::mode_file(&self.analysis.problem, left)?;
            self.folder.write(&format!("fields/mode_{number}_{}.vtu", index + 1), &text)?;
        }
        self.list_fields(along, number);
        self.folder.write(SERIES, series(&self.series))
    }

    /// What a run that ended early leaves of its way beyond the last requested position. States from which nothing can be derived are left
    /// out: the run has ended for a reason of its own.
    fn states_on_the_way(&mut self, end: &End<'_>) -> Result<Vec<StepSummary>, ResultsError> {
        let analysis = self.analysis;
        let Some(last) = end.last.filter(|_| end.error.is_none()) else { return Ok(Vec::new()) };
        let kept = self.on_the_way.before(last.parameter);
        let mut states: Vec<ConvergedState> =
            kept.filter_map(|kept| kept.equilibrium(&analysis.problem).ok()).collect();
        states.push(last.clone());
        let mut summaries = Vec::new();
        for state in &states {
            let Ok(described) = derived::describe(&analysis.problem, &self.probes, state) else { continue };
            if analysis.output.fields {
                let beyond = self.steps.last().map_or(0.0, |last| self.along_steps() - last.when().0);
                let number = on_the_way_number(summaries.len() + 1);
                self.write_fields((beyond + state.parameter.0, &number), &described, state)?;
            }
            summaries.push(described.summary);
        }
        Ok(summaries)
    }

    fn ending(&self, end: &End<'_>, on_the_way: Vec<StepSummary>) -> Ending {
        let failure = match (end.error, end.failure) {
            (Some(error), _) => Some(error.to_string()),
            (None, failure) => failure.map(|failure| end_in_words(failure, end.reason)),
        };
        let status = Status::at_end(self.left(), end.failure, end.error.is_some());
        let missed = match status {
            Status::NotConverged if end.error.is_none() => self.left().get(..1).unwrap_or_default(),
            Status::PastLimit => self.left(),
            _ => &[],
        };
        let missed = missed.iter().map(|&at| self.missed(at)).collect();
        let estimate = end.estimate.cloned();
        Ending { status, failure, reason: end.reason.cloned(), missed, on_the_way, estimate }
    }

    fn missed(&self, at: LoadParameter) -> Missed {
        let (time, pressure_kpa) = match self.analysis.problem.clock {
            Clock::Pressure => (None, Some(at.0)),
            Clock::Steps => (Some(at.0), self.given_pressure(at)),
        };
        Missed { time, pressure_kpa, converged: false, iterations: self.open_iterations }
    }

    /// Pressure of a model's first cavity at a time that was not reached, kPa, if it does not have to be found.
    fn given_pressure(&self, at: LoadParameter) -> Option<f64> {
        match &self.analysis.problem.cavities.first()?.control {
            Control::Pressure(curve) => Some(Pressure::from_mpa(curve.at(at)).kpa()),
            Control::Volume(_) | Control::Gas(_) => None,
        }
    }

    fn write_summary(&self, ending: Option<&Ending>) -> Result<(), ResultsError> {
        let mut steps: Vec<Step<'_>> = self.steps.iter().map(Step::Reached).collect();
        steps.extend(ending.into_iter().flat_map(|ending| &ending.missed).copied().map(Step::Missed));
        let estimate = ending.and_then(|ending| ending.estimate.as_ref());
        let summary = Summary {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            format: FORMAT,
            title: &self.analysis.title,
            status: ending.map_or(Status::Running, |ending| ending.status),
            failure: ending.and_then(|ending| ending.failure.as_deref()),
            failure_reason: ending.and_then(|ending| ending.reason.as_ref()),
            warnings: self.analysis.warnings_beside(&self.steps, estimate),
            error_estimate: estimate,
            results_of: if self.analysis.modelled_part().is_some() { "whole-body" } else { "model" },
            modelled: self.analysis.modelled_part(),
            symmetry_planes: self.analysis.problem.symmetry.iter().map(SymmetryPlane::words).collect(),
            mesh: self.mesh.clone(),
            probes: &self.probes,
            steps,
            on_the_way: ending.map_or(&[], |ending| &ending.on_the_way[..]),
            load_steps: &self.load_steps,
            iterations_total: self.iterations,
            timing: self.timing,
        };
        let text = json::pretty(&summary).map_err(|why| ResultsError::not_representable("summary.json", why))?;
        self.folder.write("summary.json", text)
    }
}

impl Observer for Recorder<'_> {
    fn observe(&mut self, event: &Event<'_>) -> Result<(), ResultsError> {
        match event {
            Event::StepStarted { .. } | Event::StepRejected { .. } => Ok(()),
            Event::Iteration(record) => self.iteration(record),
            Event::StepAccepted(checkpoint) => self.step_accepted(checkpoint),
            Event::State(state) => self.state(state),
        }
    }

    fn finish(&mut self, end: &End<'_>) -> Result<(), ResultsError> {
        self.timing.path = end.report.timing;
        self.iterations = end.report.iterations;
        let on_the_way = self.states_on_the_way(end)?;
        self.write_summary(Some(&self.ending(end, on_the_way)))
    }
}

/// Writes the case as it is solved, with every default, and the files of its body, into a folder: as `case.toml` it can be solved again from there.
///
/// # Errors
/// A file that cannot be written; values that have no form in it.
pub fn write_case(folder: &OutputFolder, analysis: &Analysis) -> Result<(), ResultsError> {
    let resolved = analysis.resolved().map_err(|e| ResultsError::not_representable("case.toml", e))?;
    let version = env!("CARGO_PKG_VERSION");
    let header = format!("{CASE_MARK} {version}: the case as it was solved, with every default\n\n");
    folder.write("case.toml", header + &resolved)?;
    let files = analysis.files().map_err(|e| ResultsError::not_representable("input", e))?;
    files.map_or(Ok(()), |files| store_input(folder, &files))
}

/// Copies the files of a body, by which the results can be shown later.
fn store_input(folder: &OutputFolder, files: &Files) -> Result<(), ResultsError> {
    if !files.bytes.is_empty() {
        folder.write(&format!("{INPUT}/{}", files.name), &files.bytes)?;
    }
    for (number, (_, bytes)) in files.included.iter().enumerate() {
        folder.write(&format!("{INPUT}/{}", included_name(number)), bytes)?;
    }
    // Last: by it the folder of copies is known as ours.
    let names: Vec<&str> = files.included.iter().map(|(name, _)| name.as_str()).collect();
    let names = json::pretty(&names).map_err(|why| ResultsError::not_representable(INCLUDED, why))?;
    folder.write(&format!("{INPUT}/{INCLUDED}"), names)
}
