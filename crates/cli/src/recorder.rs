//! What a run leaves on disk, kept up to date while it goes on.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::time::Instant;

use pneuflex_model::{Case, Problem};
use pneuflex_newton::{Failure, IterationRecord, LandedState, PathReport, Timing};
use pneuflex_post::summary::{ProbeSite, State, StepSummary, describe, probe_sites};
use pneuflex_post::vtu::{SeriesEntry, series};
use serde::Serialize;

use crate::folder::{CASE_MARK, OutputFolder};
use crate::json;

/// `summary.json`. Its keys are a contract: later versions add to them.
#[derive(Debug, Serialize)]
struct Summary {
    program: &'static str,
    version: &'static str,
    title: String,
    status: Status,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
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
    Failed { pressure_kpa: f64, converged: bool, iterations: usize },
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
    case: &'a Case,
    problem: &'a Problem,
    summary: Summary,
    series: Vec<SeriesEntry>,
    began: Instant,
    /// Iterations reported since the last landing.
    open_iterations: usize,
    /// First thing that went wrong; nothing is recorded after it.
    error: Option<String>,
}

impl<'a> Recorder<'a> {
    /// Starts the output of a run: the resolved case, an empty history, a summary without steps.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(folder: OutputFolder, case: &'a Case, problem: &'a Problem) -> Result<Self, String> {
        let mesh = MeshSummary {
            nodes: problem.mesh.num_nodes(),
            elements: problem.mesh.num_elements(),
            unknowns: problem.num_unknowns(),
            element: case.mesh.formulation().name(),
        };
        let summary = Summary {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            title: case.title.clone(),
            status: Status::Running,
            failure: None,
            mesh,
            probes: probe_sites(&problem.mesh, &case.probes),
            steps: Vec::new(),
            iterations_total: 0,
            timing: RunTiming::default(),
        };
        let mesh = case.mesh.resolved(&case.actuator);
        let resolved = toml::to_string(&Case { mesh, ..case.clone() }).map_err(|e| format!("case.toml: {e}"))?;
        let header = format!("{CASE_MARK} {}: the case as it was solved, with every default\n\n", summary.version);
        folder.write("case.toml", &(header + &resolved))?;
        let history = folder.create("history.jsonl")?;
        let recorder = Self {
            folder,
            history,
            case,
            problem,
            summary,
            series: Vec::new(),
            began: Instant::now(),
            open_iterations: 0,
            error: None,
        };
        recorder.write_summary()?;
        Ok(recorder)
    }

    /// Records an iteration.
    pub fn iteration(&mut self, record: &IterationRecord) {
        // A correction with the factor of the one before is no iteration of its own.
        let is_new = usize::from(record.new_tangent);
        self.summary.iterations_total += is_new;
        self.open_iterations += is_new;
        let written = json::line(record)
            .and_then(|line| self.history.write_all(line.as_bytes()).map_err(|e| format!("history.jsonl: {e}")));
        self.keep(written);
    }

    /// Records a landed pressure; returns its summary unless something went wrong.
    pub fn landed(&mut self, state: &LandedState) -> Option<&StepSummary> {
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

    fn write_step(&mut self, landed: &LandedState) -> Result<(), String> {
        let state = State {
            pressure_kpa: landed.pressure_kpa,
            displacement: &landed.displacement,
            reaction: &landed.reaction,
            iterations: landed.iterations,
            load_steps: landed.load_steps,
        };
        let at = |e: pneuflex_post::PostError| format!("results at {} kPa: {e}", landed.pressure_kpa);
        let described = describe(self.problem, &self.summary.probes, &state).map_err(at)?;
        if self.case.output.fields {
            let (body, walls) = described.field_files(self.problem, &state).map_err(at)?;
            let number = self.summary.steps.len() + 1;
            for (part, (name, text)) in [("step", Some(body)), ("contact", walls)].into_iter().enumerate() {
                if let Some(text) = text {
                    let file = format!("{name}_{number:02}.vtu");
                    self.folder.write(&format!("fields/{file}"), &text)?;
                    self.series.push(SeriesEntry { time: landed.pressure_kpa, part, file });
                }
            }
            self.folder.write("fields/series.pvd", &series(&self.series))?;
        }
        self.summary.steps.push(Step::Landed(Box::new(described.summary)));
        Ok(())
    }

    /// Records the end of the path; returns why the last requested pressure was not reached, if it was not.
    ///
    /// # Errors
    /// The first thing that could not be recorded.
    pub fn finish(mut self, result: &Result<PathReport, (Failure, PathReport)>) -> Result<Option<String>, String> {
        let (report, failure) = match result {
            Ok(report) => (report, None),
            Err((failure, report)) => (report, Some(failure)),
        };
        self.summary.timing.path = report.timing;
        self.summary.iterations_total = report.iterations;
        let reached = self.summary.steps.len();
        let missed = self.case.load.pressure_kpa.get(reached).copied();
        self.summary.failure = match (failure, &self.error, missed) {
            (Some(failure), _, _) => Some(failure.to_string()),
            (None, Some(error), _) => Some(error.clone()),
            (None, None, Some(pressure)) => Some(format!("{pressure} kPa was not reached")),
            (None, None, None) => None,
        };
        self.summary.status = if self.summary.failure.is_none() { Status::Converged } else { Status::NotConverged };
        if let Some(pressure_kpa) = missed {
            self.summary.steps.push(Step::Failed { pressure_kpa, converged: false, iterations: self.open_iterations });
        }
        let written = self.write_summary();
        self.keep(written);
        self.error.map_or(Ok(self.summary.failure), Err)
    }

    /// The folder written to.
    pub fn folder(&self) -> &OutputFolder {
        &self.folder
    }

    fn write_summary(&self) -> Result<(), String> {
        let text = json::pretty(&self.summary).map_err(|e| format!("summary.json: {e}"))?;
        self.folder.write("summary.json", &text)
    }

    fn keep(&mut self, result: Result<(), String>) {
        if let Err(error) = result {
            self.error.get_or_insert(error);
        }
    }
}
