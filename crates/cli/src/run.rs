//! `pneuflex run`: solve a case and write its results.

use std::path::PathBuf;

use pneuflex_model::Problem;
use pneuflex_newton::{Event, follow_path};

use crate::args::RunArguments;
use crate::case_file::CaseFile;
use crate::error::{self, CliError, InputError};
use crate::folder::OutputFolder;
use crate::memory::{Estimate, thousands};
use crate::progress::{Progress, duration};
use crate::recorder::Recorder;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every requested pressure was reached.
    Converged,
    /// The path could not be followed to its end.
    NotConverged,
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

/// Solves a case.
///
/// # Errors
/// Bad input, found before anything is solved or written; results that cannot be written.
pub fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    let file = CaseFile::load(&arguments.case.case, &arguments.case.set)?;
    let warning = Estimate::of(&file.case).guard(arguments.solve.force)?;
    use_threads(arguments.solve.threads)?;
    let default = || PathBuf::from("out").join(file.stem());
    let folder = OutputFolder::prepare(&arguments.out.clone().unwrap_or_else(default))?;
    let problem = Problem::from_case(&file.case).map_err(|e| file.out_of_range(&e))?;
    let pressures = &file.case.load.pressure_kpa;
    let mut progress = Progress::new(arguments.solve.quiet, pressures.last().copied().unwrap_or(0.0));
    if let Some(warning) = warning {
        progress.line(&format!("warning: {warning}"));
    }
    let mesh = &problem.mesh;
    let size = [mesh.num_nodes(), mesh.num_elements(), problem.num_unknowns()].map(|n| thousands(n as u64));
    progress.line(&format!(
        "{}: {} nodes, {} elements {}, {} unknowns; results go to {}",
        file.path().display(),
        size[0],
        size[1],
        file.case.mesh.formulation(),
        size[2],
        folder.path().display()
    ));

    let mut recorder = Recorder::new(folder, &file.case, &problem).map_err(CliError::Output)?;
    let result = follow_path(&problem, pressures, &file.case.solver, &mut |event| match event {
        Event::StepStarted { step, pressure_kpa } => progress.step_started(step, pressure_kpa),
        Event::Iteration(record) => {
            recorder.iteration(record);
            progress.iteration(record);
        }
        Event::StepRejected { cause, .. } => progress.rejected(cause),
        Event::Landed(state) => {
            if let Some(summary) = recorder.landed(state) {
                progress.landed(summary);
            }
        }
    });
    progress.finish();
    let folder = recorder.folder().path().to_owned();
    let failure = recorder.finish(&result).map_err(CliError::Output)?;
    let (Ok(report) | Err((_, report))) = result;
    if let Some(failure) = failure {
        // Said even when quiet: it is the reason for the exit code.
        error::say(&format!("error: {failure}\n  what was computed so far is in {}", folder.display()));
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
