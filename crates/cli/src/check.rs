//! `pneuflex check`: what would be solved, without solving it.

use std::io::{self, Write as _};

use pneuflex::Study;

use crate::args::CaseArguments;
use crate::error::{CliError, say};

/// Checks a case and prints what would be solved.
///
/// # Errors
/// Bad input.
pub fn check(arguments: &CaseArguments) -> Result<(), CliError> {
    let analysis = Study::load_with(&arguments.case, arguments.changes()?)?.build()?;
    for note in &analysis.notes {
        say(note);
    }
    for warning in analysis.warnings(&[]) {
        say(&warning.to_string());
    }
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(analysis.overview().to_string().as_bytes());
    Ok(())
}
