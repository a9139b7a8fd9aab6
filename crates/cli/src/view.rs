//! `pneuflex view`: the report of a result folder, `report.html`. `pneuflex run` writes it the same way at its end.

use pneuflex::OutputFolder;
use pneuflex::folder::REPORT;
use pneuflex::report_page::report_page;

use crate::args::ViewArguments;
use crate::error::CliError;
use crate::terminal::say;

/// Writes the report of a result folder and says where it is.
///
/// # Errors
/// A folder that is none of this program's, files that are missing or damaged, a report that cannot be written.
pub fn view(arguments: &ViewArguments) -> Result<(), CliError> {
    // First what can fail without a trace: a folder that is none of ours is not touched.
    let page = report_page(&arguments.results)?;
    let folder = OutputFolder::to_add_to(&arguments.results)?;
    folder.write(REPORT, page)?;
    say(&format!("wrote {}", folder.path().join(REPORT).display()));
    Ok(())
}
