//! Solving one design.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use pneuflex::columns::{Tip, columns};
use pneuflex::error_estimate::ErrorEstimate;
use pneuflex::report_page::write_report;
use pneuflex::{Analysis, Error, Neighbour, OutputFolder, Solution, Start, Study};
use serde::{Deserialize, Serialize};

use crate::base::{Base, Design};
use crate::identity;
use crate::neighbours;
use crate::row::Row;

/// What all designs of a sweep are solved from and with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Job {
    /// What they are made from.
    pub base: Base,
    /// The sweep's folder.
    pub folder: PathBuf,
    /// Threads of the solver.
    pub threads: usize,
    /// Whether their fields are kept.
    pub fields: bool,
}

/// A design to be solved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Task {
    /// Its name.
    pub identity: String,
    /// Its values by keys.
    pub design: Design,
    /// Name of the design that it starts from.
    pub starts_from: Option<String>,
    /// Whether others start from it.
    pub is_neighbour: bool,
}

/// The folder of a design's own results.
pub fn record(folder: &Path, identity: &str) -> PathBuf {
    folder.join("designs").join(identity)
}

/// Solves a design and writes its row before anybody hears of it: what is finished is never lost. Designs that cannot be solved have rows,
/// too, which say why.
pub fn solve(job: &Job, task: &Task) -> Row {
    // Of a worker that died, or was lost, after it had finished.
    let before = Row::read(&job.folder, &task.identity);
    if before.status != "open" {
        return before;
    }
    let (began, cpu) = (Instant::now(), cpu_seconds());
    let mut row = catch_unwind(AssertUnwindSafe(|| solved(job, task))).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
        let mut row = Row::new(&task.identity, "error");
        row.reason = Some("panic".into());
        row.message = format!("a defect of pneuflex, please report it: {}", said.unwrap_or("unknown"));
        row
    });
    row.seconds = Some(began.elapsed().as_secs_f64());
    row.cpu_seconds = cpu.zip(cpu_seconds()).map(|(before, after)| after - before);
    row.threads = Some(job.threads);
    if let Err(error) = row.keep(&job.folder) {
        // Not kept: the next call tries it again.
        row = Row::new(&task.identity, "error");
        row.reason = Some("results".into());
        row.message = format!("{}: cannot be written to: {error}", job.folder.display());
    }
    row
}

fn solved(job: &Job, task: &Task) -> Row {
    let mut row = Row::new(&task.identity, "error");
    let study = match job.base.study(&task.design) {
        Ok(study) => study,
        Err(error) => return failed(row, task, error, &Tip::default()),
    };
    match identity::of_study(&study, &identity::content(&study), job.fields) {
        Ok(identity) if identity == task.identity => {}
        Ok(_) => {
            row.reason = Some("input-changed".into());
            row.message = format!("{} or what it reads has changed since the sweep began", job.base.path.display());
            return row;
        }
        Err(error) => return failed(row, task, error, &Tip::default()),
    }
    let tip = Tip::of(&study);
    match followed(job, task, &study) {
        Ok(solution) => {
            row.status = solution.status.name().into();
            found(&mut row, task, &solution, &tip);
            row
        }
        Err(error) => failed(row, task, error, &tip),
    }
}

fn followed(job: &Job, task: &Task, study: &Study) -> Result<Solution, Error> {
    let analysis = study.build()?;
    let neighbour = task.starts_from.as_ref().and_then(|other| neighbours::read(&job.folder, other));
    let mut ended = solved_from(job, task, &analysis, neighbour);
    if ended.as_ref().is_err_and(Error::has_left_neighbour) {
        ended = solved_from(job, task, &analysis, None);
    }
    if let Ok(Solution { neighbour: Some(found), .. }) = &ended {
        neighbours::keep(&job.folder, &task.identity, found);
    }
    ended
}

fn solved_from(job: &Job, task: &Task, analysis: &Analysis, neighbour: Option<Neighbour>) -> Result<Solution, Error> {
    let run = analysis.run().without_fields().start_from(neighbour).keep_equilibria(task.is_neighbour);
    if !job.fields {
        return run.solve();
    }
    let folder = OutputFolder::prepare(&record(&job.folder, &task.identity))?;
    let ended = run.record_in(folder.clone(), Start::AtRest).solve();
    // What was solved is there without a report, too.
    if !matches!(ended, Err(Error::Setup(_) | Error::Input(_))) {
        let _ = write_report(&folder);
    }
    ended
}

/// What was found.
fn found(row: &mut Row, task: &Task, solution: &Solution, tip: &Tip) {
    row.started_from = task.starts_from.clone().filter(|_| solution.has_started_from);
    row.states = solution.states.iter().map(|state| columns(state, tip)).collect();
    let estimate = solution.error_estimate.as_ref().and_then(ErrorEstimate::found);
    if let (Some(last), Some(estimate)) = (row.states.last_mut(), estimate) {
        estimate.errors.iter().for_each(|error| last.push(format!("error.{}", error.quantity.key), error.error));
    }
    let name = |kind| serde_json::to_value(kind).ok().and_then(|kind| kind.as_str().map(str::to_owned));
    row.warnings = solution.warnings.iter().filter_map(|warning| name(warning.kind)).collect();
}

/// The row of a design that did not come to its end.
fn failed(mut row: Row, task: &Task, error: Error, tip: &Tip) -> Row {
    row.message = error.to_string();
    match error {
        Error::Input(errors) => {
            let is_of_machine = errors.iter().any(|error| error.kind().is_of_machine());
            let (status, reason) = if is_of_machine { ("error", "machine") } else { ("bad-input", "bad-input") };
            (row.status, row.reason) = (status.into(), Some(reason.into()));
            row.message = errors.iter().map(|error| error.in_full(error.help())).collect::<Vec<_>>().join("\n");
        }
        Error::Setup(ref ended) | Error::NotConverged(ref ended) | Error::Interrupted(ref ended) => {
            let is_setup = matches!(error, Error::Setup(_));
            row.status = if is_setup { "setup" } else { ended.reached.status.name() }.into();
            let reason = ended.reason.as_ref();
            let kind = reason.and_then(|reason| serde_json::to_value(reason.kind).ok());
            row.reason = Some(kind.and_then(|kind| kind.as_str().map(str::to_owned)).unwrap_or(row.status.clone()));
            row.advice = reason.map(|reason| reason.advice.clone()).unwrap_or_default();
            found(&mut row, task, &ended.reached, tip);
        }
        Error::Results(_) => row.reason = Some("results".into()),
        Error::Threads { .. } => row.reason = Some("machine".into()),
    }
    row
}

/// Seconds that all cores have spent on this process.
#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    use nix::time::{ClockId, clock_gettime};
    let spent = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID).ok()?;
    Some(spent.tv_sec() as f64 + 1e-9 * spent.tv_nsec() as f64)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}
