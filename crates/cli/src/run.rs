//! `pneuflex run`: solve a case and write its results.

use std::path::PathBuf;

use pneuflex::diagnosis::{Warning, WarningKind};
use pneuflex::error_estimate::ErrorEstimate;
use pneuflex::folder::{GRADIENTS, REPORT, SHAPE_GRADIENTS};
use pneuflex::gradient::{Derivative, Gradient, write_gradients, write_shape_gradients};
use pneuflex::model::LoadParameter;
use pneuflex::post::summary::StepSummary;
use pneuflex::report_page::write_report;
use pneuflex::words::{rounded, thousands};
use pneuflex::{Analysis, Error, OutputFolder, Solution, Start, Status, Study, Unfinished};

use crate::args::RunArguments;
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::progress::{Progress, duration};
use crate::run_table;
use crate::terminal::say;

/// Derivatives of a result that are said, and their digits.
const SAID: usize = 6;
const DIGITS: i32 = 5;

/// Solves a case.
///
/// # Errors
/// Bad input, found before anything is solved or written; results that cannot be written.
pub fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    // Before anything uses threads: reading does, to see whether an obstacle overlaps the body.
    arguments.solve.with.use_threads()?;
    let mut study = Study::load_with(&arguments.case.case, arguments.case.changes()?)?;
    if arguments.estimate {
        study.estimate_errors()?;
    }
    let analysis = study.build_within(arguments.solve.memory_limit())?;
    analysis.check_gradients(&arguments.gradient)?;
    if arguments.shape {
        analysis.check_shape_gradients(&arguments.gradient)?;
    }
    let default = || PathBuf::from("out").join(analysis.stem());
    let folder = OutputFolder::prepare(&arguments.out.clone().unwrap_or_else(default))?;
    let place = folder.path().display();
    let start = if arguments.resume { folder.start(&analysis)? } else { Start::AtRest };
    let begin = match &start {
        Start::Complete(_) => {
            // A run may have died before it had written its report.
            if !arguments.no_report && !folder.path().join(REPORT).exists() {
                report_or_warn(&folder, arguments.solve.with.quiet);
            }
            // Displacements of an earlier run are not known: it says so.
            analysis.gradients(&[], &arguments.gradient, None)?;
            say(&format!("{place}: the run is complete, nothing is left to do"));
            return Ok(Outcome::Converged);
        }
        Start::From(earlier) => Some(earlier.1.parameter),
        Start::AtRest => None,
    };
    let end = analysis.requested.last().copied().unwrap_or_default();
    let clock = analysis.problem.clock;
    let parts = analysis.problem.parts_of_whole();
    let mut progress = Progress::new(arguments.solve.with.quiet, clock, [begin.unwrap_or_default(), end], parts);
    announce(&analysis, &folder, &progress);
    match begin {
        Some(at) => progress.line(&format!("going on from {}", clock.words(at))),
        None if arguments.resume => progress.line("nothing to go on with: starting from rest"),
        None => {}
    }

    let run = analysis.run().stop(&interrupt::listen()).record_in(folder.clone(), start);
    let run = if arguments.gradient.is_empty() { run.without_fields() } else { run };
    let result = run.observer(|event| progress.event(event)).solve();
    progress.finish();
    let report = |found: &[StepSummary]| {
        run_table::lines(clock, found).iter().for_each(|line| progress.line(line));
        if !arguments.no_report {
            report_or_warn(&folder, arguments.solve.with.quiet);
        }
    };
    match result {
        Ok(solution) => {
            say_estimate(&analysis, &solution, &progress);
            say_warnings(&solution.warnings, &analysis.warnings(&[]), &progress);
            let gradients = analysis.gradients(&solution.fields, &arguments.gradient, None);
            if let Ok(gradients) = &gradients
                && !gradients.is_empty()
            {
                write_gradients(&folder, gradients)?;
                gradients.iter().for_each(|gradient| say_gradient(&analysis, gradient, &progress));
            }
            if arguments.shape && gradients.is_ok() {
                let shapes = analysis.shape_gradients(&solution.fields, &arguments.gradient)?;
                write_shape_gradients(&folder, &analysis, &shapes)?;
                let seconds = shapes.iter().fold(0.0_f64, |most, shape| most.max(shape.seconds));
                progress.line(&format!("derivatives by all nodes are in {SHAPE_GRADIENTS} ({})", duration(seconds)));
            }
            report(&solution.states);
            gradients?;
            let spent = duration(solution.timing.total_s);
            let is_past_limit = solution.status == Status::PastLimit;
            let end = if is_past_limit { "followed past the limit point" } else { "converged" };
            progress.line(&format!("{end}: {} iterations in {spent}; results in {place}", solution.iterations));
            Ok(Outcome::Converged)
        }
        // Said even when quiet: it is the reason for the exit code.
        Err(Error::Interrupted(ended)) => {
            report(&ended.reached.states);
            let go_on = format!("what was computed so far is in {place}; the same command with --resume goes on");
            say(&format!("{ended}\n  {go_on}"));
            Ok(Outcome::Interrupted)
        }
        Err(Error::Setup(ended)) => {
            say(&format!("error: {ended}{}\n  nothing was solved; {place} is as it was", advice(&ended)));
            Ok(Outcome::NotConverged)
        }
        Err(Error::NotConverged(ended)) => {
            say_warnings(&ended.reached.warnings, &analysis.warnings(&[]), &progress);
            report(&ended.reached.states);
            say(&format!("error: {ended}{}\n  what was computed so far is in {place}", advice(&ended)));
            Ok(Outcome::NotConverged)
        }
        Err(error) => Err(error.into()),
    }
}

/// Says what is about to be solved.
fn announce(analysis: &Analysis, folder: &OutputFolder, progress: &Progress) {
    for note in &analysis.notes {
        progress.line(note);
    }
    say_warnings(&analysis.warnings(&[]), &[], progress);
    let problem = &analysis.problem;
    let mesh = &problem.mesh;
    let size = [mesh.num_nodes(), mesh.num_elements(), problem.num_unknowns()].map(|n| thousands(n as u64));
    progress.line(&format!(
        "{}: {} nodes, {} elements {}, {} unknowns",
        analysis.path.display(),
        size[0],
        size[1],
        problem.element_names(),
        size[2],
    ));
    let place = folder.path().display();
    progress.line(&match analysis.modelled_part() {
        Some("whole") => format!("  the whole body is modelled; results go to {place}"),
        Some(part) => format!("  one {part} of the body is modelled; results, of the whole, go to {place}"),
        None => format!("  results go to {place}"),
    });
}

/// Says how exact the last state is, unless a warning does, or why that is not known.
fn say_estimate(analysis: &Analysis, solution: &Solution, progress: &Progress) {
    match &solution.error_estimate {
        Some(ErrorEstimate::Found(found)) => {
            let cost = format!("{} unknowns, {}", thousands(found.unknowns as u64), duration(found.seconds));
            let words = found.words(&analysis.problem);
            let is_a_warning = solution.warnings.iter().any(|warning| warning.message == words);
            progress.line(&if is_a_warning {
                format!("errors are estimated ({cost})")
            } else {
                format!("{words} ({cost})")
            });
        }
        Some(ErrorEstimate::None { why_not }) => progress.line(&format!("errors are not estimated: {why_not}")),
        None => {}
    }
}

/// Says what changes a result most.
fn say_gradient(analysis: &Analysis, gradient: &Gradient, progress: &Progress) {
    let at = analysis.problem.clock.words(LoadParameter(gradient.time.unwrap_or(gradient.pressure_kpa)));
    let Gradient { of, value, derivatives, seconds, .. } = gradient;
    progress.line(&format!("{of} = {} at {at} changes most by ({}):", rounded(*value, DIGITS), duration(*seconds)));
    for Derivative { by, unit, derivative, per_percent, .. } in derivatives.iter().take(SAID) {
        let [derivative, per_percent] = [derivative, per_percent].map(|x| rounded(*x, DIGITS));
        let unit = if unit.is_empty() { "unit" } else { unit };
        progress.line(&format!("  {by}: {derivative} per {unit}, {per_percent} per percent"));
    }
    if derivatives.len() > SAID {
        progress.line(&format!("  all {} are in {GRADIENTS}", derivatives.len()));
    }
}

/// Says what to be careful about, but for what was said before and what the states said themselves.
fn say_warnings(warnings: &[Warning], said: &[Warning], progress: &Progress) {
    let is_new = |warning: &&Warning| warning.kind != WarningKind::MaterialLimit && !said.contains(warning);
    for warning in warnings.iter().filter(is_new) {
        progress.line(&warning.to_string());
    }
}

/// What to try against the end of a run, on a line of its own; nothing if there is no advice.
fn advice(ended: &Unfinished) -> String {
    ended.reason.as_ref().map_or_else(String::new, |reason| format!("\n  what to try: {}", reason.advice))
}

/// Writes the run's report; a report that cannot be written is no failure of the run.
fn report_or_warn(folder: &OutputFolder, is_quiet: bool) {
    match write_report(folder) {
        Ok(_) if is_quiet => {}
        Ok(path) => say(&format!("report: {}", path.display())),
        Err(error) => say(&format!("warning: there is no report: {}", CliError::from(error).message())),
    }
}
