//! What is said of every design of a search, and how searches end early.

use std::path::{Path, PathBuf};

use pneuflex::words::rounded;
use pneuflex::{Error, StopToken};
use pneuflex_inverse::search::Progress;

use crate::args::SearchArguments;
use crate::error::CliError;
use crate::outcome::Outcome;
use crate::progress::duration;
use crate::terminal::say;

/// Digits of what is said.
pub const DIGITS: i32 = 5;

/// Says what became of a design; `misfit` is how good it is, in words.
pub fn line(progress: &Progress<'_>, misfit: &str) {
    let (number, [start, starts]) = (progress.number, progress.start);
    let place = if starts > 1 { format!("start {start} of {starts}, ") } else { String::new() };
    let end = if progress.is_known { "known".to_owned() } else { duration(progress.tried.seconds) };
    say(&match &progress.tried.outside {
        Some(why) if progress.step.number == 1 => {
            format!("{place}solution {number}: none, beginning elsewhere ({end}): {why}")
        }
        Some(why) => format!("{place}solution {number}: none, stepping back ({end}): {why}"),
        None if progress.step.is_better => format!("{place}solution {number}: {misfit} ({end})"),
        None => format!("{place}solution {number}: {misfit}, no better: a shorter step ({end})"),
    });
}

/// Folder of a search.
pub fn folder(arguments: &SearchArguments, stem: &str) -> PathBuf {
    arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(stem))
}

/// How a search ended that did not come to its end.
///
/// # Errors
/// What is no interruption.
pub fn ended(error: Error, folder: &Path, stop: &StopToken) -> Result<Outcome, CliError> {
    match error {
        Error::Interrupted(_) if stop.is_stopped() => {
            say(&format!("interrupted; {} has what was solved, and --resume goes on", folder.display()));
            Ok(Outcome::Interrupted)
        }
        error => Err(error.into()),
    }
}

/// A number as it is said.
pub fn number(x: f64) -> String {
    rounded(x, DIGITS).to_string()
}
