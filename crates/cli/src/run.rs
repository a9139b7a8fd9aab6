//! `pneuflex run`: solve a case and write its results.

use std::path::PathBuf;

use pneuflex_model::{Problem, Solver};
use pneuflex_newton::{Cause, Checkpoint, Event, Failure, Path, PathReport, Stability, Timing};

use crate::args::RunArguments;
use crate::checkpoint::{self, Recorded, Start};
use crate::diagnosis::explain;
use crate::error::{self, CliError, InputError};
use crate::folder::OutputFolder;
use crate::interrupt;
use crate::memory::thousands;
use crate::progress::{Progress, duration};
use crate::recorder::Recorder;
use crate::study::Study;
use crate::view;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every requested pressure was reached.
    Converged,
    /// The path could not be followed to its end.
    NotConverged,
    /// Somebody asked to stop.
    Interrupted,
}

/// Sets the number of threads, if one is given, for the whole program.
///
/// # Errors
/// The threads cannot be started.
pub fn use_threads(threads: Option<u16>) -> Result<(), InputError> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .map_err(|e| InputError::new(format!("--threads {threads}: {e}")))
}

/// Writes the run's report; a report that cannot be written is no failure of the run.
fn report_or_warn(folder: &OutputFolder, progress: &mut Progress) {
    match view::write_report(folder) {
        Ok(path) => progress.line(&format!("report: {}", path.display())),
        Err(error) => error::say(&format!("warning: there is no report: {}", error.message())),
    }
}

/// Solves a case.
///
/// # Errors
/// Bad input, found before anything is solved or written; results that cannot be written.
pub fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    // Before anything uses threads: reading does, to see whether an obstacle overlaps the body.
    use_threads(arguments.solve.threads)?;
    let study = Study::load(&arguments.case.case, &arguments.case.set, arguments.solve.force)?;
    let default = || PathBuf::from("out").join(study.stem());
    let folder = OutputFolder::prepare(&arguments.out.clone().unwrap_or_else(default))?;
    let start = if arguments.resume { checkpoint::load(&folder, &study)? } else { Start::AtRest };
    let (recorded, from) = match start {
        Start::Complete => {
            error::say(&format!("{}: the run is complete, nothing is left to do", folder.path().display()));
            return Ok(Outcome::Converged);
        }
        Start::From(earlier) => (earlier.0, Some(earlier.1)),
        Start::AtRest => {
            folder.clear()?;
            (Recorded::default(), None)
        }
    };
    let problem = &study.problem;
    let begin = from.as_ref().map_or(0.0, |checkpoint| checkpoint.time);
    let end = study.times.last().copied().unwrap_or(0.0);
    let mut progress = Progress::new(arguments.solve.quiet, problem.clock, [begin, end]);
    for note in &study.notes {
        progress.line(note);
    }
    let mesh = &problem.mesh;
    let size = [mesh.num_nodes(), mesh.num_elements(), problem.num_unknowns()].map(|n| thousands(n as u64));
    progress.line(&format!(
        "{}: {} nodes, {} elements {}, {} unknowns; results go to {}",
        study.path.display(),
        size[0],
        size[1],
        problem.formulation,
        size[2],
        folder.path().display()
    ));
    match &from {
        Some(checkpoint) => progress.line(&format!("going on from {}", problem.clock.words(checkpoint.time))),
        None if arguments.resume => progress.line("nothing to go on with: starting from rest"),
        None => {}
    }

    let remaining = study.times.get(recorded.steps.len()..).unwrap_or_default();
    let mut recorder = Recorder::new(folder, &study, recorded).map_err(CliError::Output)?;
    let mut last_equilibrium = match &from {
        Some(checkpoint) => checkpoint.displacement.clone(),
        None => vec![[0.0; 3]; problem.mesh.num_nodes()],
    };
    let result = follow(problem, remaining, &study.solver, from, &mut |event| {
        match event {
            Event::StepStarted { step, time } => progress.step_started(step, time),
            Event::Iteration(record) => {
                recorder.iteration(record);
                progress.iteration(record);
            }
            Event::StepRejected { cause, .. } => progress.rejected(cause),
            Event::StepAccepted(checkpoint) => {
                last_equilibrium.clone_from(&checkpoint.displacement);
                recorder.step_accepted(checkpoint);
            }
            Event::Converged(state) => {
                if let Some(summary) = recorder.landed(state) {
                    progress.landed(summary);
                }
            }
        }
        if recorder.has_failed() {
            interrupt::stop();
        }
    });
    progress.finish();
    let folder = recorder.folder().path().to_owned();
    let reason = result.as_ref().err().and_then(|ended| explain(problem, &ended.0, &last_equilibrium));
    let advice = reason.as_ref().map(|reason| format!("\n  what to try: {}", reason.advice)).unwrap_or_default();
    let failure = recorder.finish(&result, reason).map_err(CliError::Output)?;
    let is_interrupted = matches!(&result, Err(ended) if ended.0.cause == Cause::Interrupted);
    let report = result.unwrap_or_else(|ended| ended.1);
    if !arguments.no_report {
        report_or_warn(recorder.folder(), &mut progress);
    }
    if let Some(failure) = failure {
        // Said even when quiet: it is the reason for the exit code.
        let place = folder.display();
        if is_interrupted {
            error::say(&format!(
                "{failure}\n  what was computed so far is in {place}; the same command with --resume goes on"
            ));
            return Ok(Outcome::Interrupted);
        }
        error::say(&format!("error: {failure}{advice}\n  what was computed so far is in {place}"));
        return Ok(Outcome::NotConverged);
    }
    progress.line(&format!(
        "converged: {} iterations in {}; results in {}",
        report.iterations,
        duration(report.timing.total_s),
        folder.display()
    ));
    Ok(Outcome::Converged)
}

/// Follows the path from rest or from a checkpoint until somebody interrupts it.
fn follow(
    problem: &Problem,
    pressures: &[f64],
    settings: &Solver,
    from: Option<Checkpoint>,
    observer: &mut dyn FnMut(Event<'_>),
) -> Result<PathReport, Box<(Failure, PathReport)>> {
    let unable = |cause: Cause| {
        let attempted = pressures.first().copied().unwrap_or(0.0);
        let failure = Failure { reached: 0.0, attempted, cause, stability: Stability::default(), clock: problem.clock };
        Box::new((failure, PathReport { iterations: 0, timing: Timing::default() }))
    };
    let mut path = Path::new(problem, settings).map_err(|e| unable(e.into()))?;
    path.stop_when(interrupt::listen());
    if let Some(checkpoint) = from {
        path.resume(checkpoint).map_err(|e| unable(e.into()))?;
    }
    for &pressure in pressures {
        if let Err(failure) = path.advance_and_tell(pressure, observer) {
            return Err(Box::new((failure, PathReport { iterations: path.iterations(), timing: path.timing() })));
        }
    }
    Ok(PathReport { iterations: path.iterations(), timing: path.timing() })
}
