//! `pneuflex find`: the pressure, or another key, at which a result takes a value.

use std::io::Write;

use pneuflex::columns::Tip;
use pneuflex::find::{Search, along_path, by_key};
use pneuflex::model::{Clock, LoadParameter};
use pneuflex::words::rounded;
use pneuflex::{Error, MemoryLimit, Study};

use crate::args::FindArguments;
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::progress::Progress;
use crate::terminal::say;

/// Finds it and prints it.
///
/// # Errors
/// Bad input, found before anything is solved; a value that is never reached.
pub fn find(arguments: &FindArguments) -> Result<Outcome, CliError> {
    let FindArguments { case, by, between, threads, .. } = arguments;
    threads.use_threads()?;
    let goal = arguments.goal()?;
    let study = Study::load_with(&case.case, case.changes()?)?;
    let stop = interrupt::listen();
    let (limit, mut clock) = (MemoryLimit::Available, Clock::Steps);
    let found = if let (Some(key), Some(ends)) = (by, between) {
        by_key(&study, (key, *ends), &goal, (limit, &stop), &mut |at, value| {
            if !threads.quiet {
                say(&format!("{key} = {at}: {} = {}", goal.column, rounded(value, 7)));
            }
        })
    } else {
        let analysis = study.build_within(limit)?;
        let (problem, end) = (&analysis.problem, analysis.requested.last().copied().unwrap_or_default());
        clock = problem.clock;
        let ends = [LoadParameter::default(), end];
        let mut progress = Progress::new(threads.quiet, problem.clock, ends, problem.parts_of_whole());
        let found = along_path(&analysis, &Tip::of(&study), &goal, &stop, &mut |event| progress.event(event));
        progress.finish();
        found
    };
    match found {
        Ok(Search::Found { at, value }) => {
            let place = match by {
                Some(key) => format!("{key} = {at}"),
                None => clock.words(LoadParameter(at)),
            };
            // Nobody reading on is no error.
            let _ = writeln!(std::io::stdout(), "{place}\n{} = {value}", goal.column);
            Ok(Outcome::Converged)
        }
        Ok(Search::Never(why)) => Err(CliError::NotConverged(why)),
        Err(Error::Interrupted(_)) => {
            say("interrupted");
            Ok(Outcome::Interrupted)
        }
        Err(error) => Err(error.into()),
    }
}
