//! `pneuflex check`: what would be solved, without solving it.

use pneuflex::Study;

use crate::args::CaseArguments;
use crate::error::CliError;
use crate::terminal::{print_rows, say};

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
    print_rows(&analysis.overview().to_string());
    Ok(())
}
