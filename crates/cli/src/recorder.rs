//! What a run leaves on disk, kept up to date while it goes on.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::time::Instant;

use pneuflex_model::Clock;
use pneuflex_newton::{Cause, Checkpoint, ConvergedState, Failure, IterationRecord, PathReport, Timing};
use pneuflex_post::summary::{ProbeSite, State, StepSummary, describe, probe_sites};
use pneuflex_post::vtu::{SeriesEntry, series};
use serde::Serialize;

use crate::checkpoint::{self, Recorded};
use crate::diagnosis::{Reason, Warning, warnings};
use crate::folder::{CASE_MARK, OutputFolder};
use crate::json;
use crate::study::{Description, Files, INCLUDED, INPUT, Study, included_name};

/// `summary.json`. Its keys are a contract: later versions add to them.
#[derive(Debug, Serialize)]
struct Summary {
    program: &'static str,
    version: &'static str,
    title: String,
    status: Status,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure_reason: Option<Reason>,
    warnings: Vec<Warning>,
    mesh: MeshSummary,
    probes: BTreeMap<String, ProbeSite>,
    steps: Vec<Step>,
    iterations_total: usize,
    timing: RunTiming,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Status {
    Running,
    Converged,
    NotConverged,
    Interrupted,
}

#[derive(Debug, Serialize)]
struct MeshSummary {
    nodes: usize,
    elements: usize,
    unknowns: usize,
    element: &'static str,
}

/// A requested pressure: reached, or the one at which the run ended.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Step {
    Landed(Box<StepSummary>),
    Failed(Missed),
}

/// The pressure (kPa) or time at which the run ended.
#[derive(Debug, Serialize)]
struct Missed {
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    pressure_kpa: f64,
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

#[derive(Debug, Default, Serialize)]
struct RunTiming {
    #[serde(flatten)]
    path: Timing,
    /// Derived quantities and files.
    output_s: f64,
}

/// Writes the output folder of a run.
pub struct Recorder<'a> {
    folder: OutputFolder,
    history: File,
    history_bytes: u64,
    study: &'a Study,
    summary: Summary,
    series: Vec<SeriesEntry>,
    began: Instant,
    /// Iterations reported since the last landing.
    open_iterations: usize,
    /// First thing that went wrong; nothing is recorded after it.
    error: Option<String>,
}

impl<'a> Recorder<'a> {
    /// Starts the output of a run, or goes on with what was recorded up to a checkpoint: the resolved case, the history, the
    /// summary.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(folder: OutputFolder, study: &'a Study, recorded: Recorded) -> Result<Self, String> {
        let problem = &study.problem;
        let mesh = MeshSummary {
            nodes: problem.mesh.num_nodes(),
            elements: problem.mesh.num_elements(),
            unknowns: problem.num_unknowns(),
            element: problem.formulation.name(),
        };
        let summary = Summary {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            title: study.title.clone(),
            status: Status::Running,
            failure: None,
            failure_reason: None,
            warnings: Vec::new(),
            mesh,
            probes: probe_sites(&problem.mesh, &study.probes),
            steps: Vec::new(),
            iterations_total: 0,
            timing: RunTiming { output_s: recorded.output_s, ..RunTiming::default() },
        };
        let resolved = study.resolved().map_err(|e| format!("case.toml: {e}"))?;
        let header = format!("{CASE_MARK} {}: the case as it was solved, with every default\n\n", summary.version);
        folder.write("case.toml", header + &resolved)?;
        if let Description::Model(_, files) = &study.description {
            store_input(&folder, files)?;
        }
        let history = folder.append("history.jsonl", recorded.history_bytes)?;
        let length = history.metadata().map_err(|e| folder.cannot_write("history.jsonl", &e))?.len();
        let mut recorder = Self {
            folder,
            history,
            history_bytes: recorded.history_bytes.min(length),
            study,
            summary,
            series: Vec::new(),
            began: Instant::now(),
            open_iterations: 0,
            error: None,
        };
        for step in recorded.steps {
            recorder.list_fields(step.time.unwrap_or(step.pressure_kpa));
            recorder.summary.iterations_total += step.iterations;
            recorder.summary.steps.push(Step::Landed(Box::new(step)));
        }
        recorder.write_summary()?;
        Ok(recorder)
    }

    /// Lists the field files of the next landed step in the series, as far as they are there.
    fn list_fields(&mut self, time: f64) {
        for (part, name) in ["step", "contact"].into_iter().enumerate() {
            let file = format!("{name}_{:02}.vtu", self.summary.steps.len() + 1);
            if self.folder.path().join("fields").join(&file).is_file() {
                self.series.push(SeriesEntry { time, part, file });
            }
        }
    }

    /// Records an iteration.
    pub fn iteration(&mut self, record: &IterationRecord) {
        // A correction with the factor of the one before is no iteration of its own.
        let is_new = usize::from(record.new_tangent);
        self.summary.iterations_total += is_new;
        self.open_iterations += is_new;
        let pressure_kpa = (self.study.problem.clock == Clock::Pressure).then_some(record.time);
        let written = json::line(&Line { record, pressure_kpa }).and_then(|line| {
            self.history_bytes += line.len() as u64;
            self.history.write_all(line.as_bytes()).map_err(|e| self.folder.cannot_write("history.jsonl", &e))
        });
        self.keep(written);
    }

    /// Records an accepted load step, to go on from if the run ends here.
    pub fn step_accepted(&mut self, path: &Checkpoint) {
        if self.error.is_some() {
            return;
        }
        let began = Instant::now();
        let steps = self.landed_steps().cloned().collect();
        let recorded = Recorded { steps, history_bytes: self.history_bytes, output_s: self.summary.timing.output_s };
        // The checkpoint counts on the history's lines.
        let synced = self.history.sync_data().map_err(|e| self.folder.cannot_write("history.jsonl", &e));
        let written = synced.and_then(|()| checkpoint::store(&self.folder, &recorded, path));
        self.summary.timing.output_s += began.elapsed().as_secs_f64();
        self.keep(written);
    }

    /// The requested pressures that were reached.
    fn landed_steps(&self) -> impl Iterator<Item = &StepSummary> {
        self.summary.steps.iter().filter_map(|step| match step {
            Step::Landed(step) => Some(&**step),
            Step::Failed(_) => None,
        })
    }

    /// Whether something could not be recorded: there is no use in going on then.
    pub fn has_failed(&self) -> bool {
        self.error.is_some()
    }

    /// Records a landed pressure; returns its summary unless something went wrong.
    pub fn landed(&mut self, state: &ConvergedState) -> Option<&StepSummary> {
        if self.error.is_some() {
            return None;
        }
        let began = Instant::now();
        let written = self.write_step(state);
        self.summary.timing.output_s += began.elapsed().as_secs_f64();
        self.summary.timing.path.total_s = self.began.elapsed().as_secs_f64();
        self.open_iterations = 0;
        let written = written.and_then(|()| self.write_summary());
        self.keep(written);
        match self.summary.steps.last() {
            Some(Step::Landed(step)) if self.error.is_none() => Some(step),
            _ => None,
        }
    }

    fn write_step(&mut self, landed: &ConvergedState) -> Result<(), String> {
        let state = State {
            time: landed.time,
            cavity_pressures: &landed.cavity_pressures,
            displacement: &landed.displacement,
            reaction: &landed.reaction,
            iterations: landed.iterations,
            load_steps: landed.load_steps,
            contact_multipliers: &landed.contact_multipliers,
            contact_failure: landed.augmentation.as_ref().and_then(|augmentation| augmentation.failure.as_deref()),
        };
        let clock = self.study.problem.clock;
        let at = |e: pneuflex_post::PostError| format!("results at {}: {e}", clock.words(landed.time));
        let described = describe(&self.study.problem, &self.summary.probes, &state).map_err(at)?;
        if self.study.fields {
            let (body, walls) = described.field_files(&self.study.problem, &state).map_err(at)?;
            let number = self.summary.steps.len() + 1;
            for (name, text) in [("step", Some(body)), ("contact", walls)] {
                if let Some(text) = text {
                    self.folder.write(&format!("fields/{name}_{number:02}.vtu"), &text)?;
                }
            }
            self.list_fields(landed.time);
            self.folder.write("fields/series.pvd", series(&self.series))?;
        }
        self.summary.steps.push(Step::Landed(Box::new(described.summary)));
        Ok(())
    }

    /// Records the end of the path; returns why the last requested pressure was not reached, if it was not.
    ///
    /// # Errors
    /// The first thing that could not be recorded.
    pub fn finish(
        &mut self,
        result: &Result<PathReport, Box<(Failure, PathReport)>>,
        reason: Option<Reason>,
    ) -> Result<Option<String>, String> {
        let (report, failure) = match result {
            Ok(report) => (report, None),
            Err(ended) => (&ended.1, Some(&ended.0)),
        };
        self.summary.timing.path = report.timing;
        self.summary.iterations_total = report.iterations;
        let reached = self.summary.steps.len();
        let missed = self.study.times.get(reached).copied();
        // A path that was stopped because of an error has not been interrupted by anybody.
        self.summary.failure = match (&self.error, failure, missed) {
            (Some(error), _, _) => Some(error.clone()),
            (None, Some(failure), _) => Some(match &reason {
                Some(reason) => format!("not converged: {}", reason.message),
                None => failure.to_string(),
            }),
            (None, None, Some(pressure)) => {
                Some(format!("{} was not reached", self.study.problem.clock.words(pressure)))
            }
            (None, None, None) => None,
        };
        self.summary.failure_reason = reason;
        self.summary.status = match (&self.summary.failure, failure) {
            (None, _) => Status::Converged,
            (_, Some(Failure { cause: Cause::Interrupted, .. })) if self.error.is_none() => Status::Interrupted,
            _ => Status::NotConverged,
        };
        if let Some(at) = missed.filter(|_| self.summary.status == Status::NotConverged && self.error.is_none()) {
            let time = (self.study.problem.clock == Clock::Steps).then_some(at);
            let missed = Missed { time, pressure_kpa: at, converged: false, iterations: self.open_iterations };
            self.summary.steps.push(Step::Failed(missed));
        }
        let written = self.write_summary();
        self.keep(written);
        self.error.clone().map_or(Ok(self.summary.failure.clone()), Err)
    }

    /// The folder written to.
    pub fn folder(&self) -> &OutputFolder {
        &self.folder
    }

    fn write_summary(&mut self) -> Result<(), String> {
        let warnings = warnings(self.study, &self.landed_steps().collect::<Vec<_>>());
        self.summary.warnings = warnings;
        let text = json::pretty(&self.summary).map_err(|e| format!("summary.json: {e}"))?;
        self.folder.write("summary.json", text)
    }

    fn keep(&mut self, result: Result<(), String>) {
        if let Err(error) = result {
            self.error.get_or_insert(error);
        }
    }
}

/// Copies the files of a body, by which the results can be shown later.
fn store_input(folder: &OutputFolder, files: &Files) -> Result<(), String> {
    if !files.bytes.is_empty() {
        folder.write(&format!("{INPUT}/{}", files.name), &files.bytes)?;
    }
    for (number, (_, bytes)) in files.included.iter().enumerate() {
        folder.write(&format!("{INPUT}/{}", included_name(number)), bytes)?;
    }
    let names: Vec<&str> = files.included.iter().map(|(name, _)| name.as_str()).collect();
    folder.write(&format!("{INPUT}/{INCLUDED}"), json::pretty(&names).map_err(|e| format!("{INCLUDED}: {e}"))?)
}
