//! `pneuflex check`: what would be solved, without solving it.

use std::fs;

use pneuflex::Study;
use pneuflex::setup_page::setup_page;

use crate::args::CheckArguments;
use crate::error::CliError;
use crate::terminal::{print_rows, say};

/// Checks a case and prints what would be solved.
///
/// # Errors
/// Bad input, or a picture that cannot be written.
pub fn check(arguments: &CheckArguments) -> Result<(), CliError> {
    let CheckArguments { case, picture } = arguments;
    let analysis = Study::load_with(&case.case, case.changes()?)?.build()?;
    for note in &analysis.notes {
        say(note);
    }
    for warning in analysis.warnings(&[]) {
        say(&warning.to_string());
    }
    print_rows(&analysis.overview().to_string());
    if let Some(path) = picture {
        let page = setup_page(&analysis)?;
        fs::write(path, page)
            .map_err(|error| CliError::Output(format!("{}: cannot be written: {error}", path.display())))?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}
