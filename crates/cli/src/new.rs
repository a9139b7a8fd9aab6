//! `pneuflex new`: a commented case file to start from.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;

use pneuflex::{InputError, template};

use crate::args::{CaseKind, NewArguments};
use crate::error::CliError;

/// The text of the case file.
fn text(kind: CaseKind) -> String {
    match kind {
        CaseKind::TwoChamber => template::two_chambers(),
        CaseKind::Actuator => template::full_actuator(),
    }
}

/// Writes the case file and says what to do with it.
///
/// # Errors
/// A file that exists already or cannot be written.
pub fn new(arguments: &NewArguments) -> Result<(), CliError> {
    let default = match arguments.kind {
        CaseKind::TwoChamber => "two_chamber.toml",
        CaseKind::Actuator => "actuator.toml",
    };
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from(default));
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| {
        let reason = match error.kind() {
            ErrorKind::AlreadyExists => "exists already and is not replaced".into(),
            _ => format!("cannot be written: {error}"),
        };
        InputError::about_file(&path, reason).with_help(Some("give another file name as the last argument".into()))
    })?;
    file.write_all(text(arguments.kind).as_bytes())
        .map_err(|error| CliError::Output(format!("{}: cannot be written: {error}", path.display())))?;
    let name = path.display();
    // Nobody reading on is no error.
    let _ = writeln!(io::stdout(), "wrote {name}\nnext: pneuflex check {name}\n      pneuflex run {name}");
    Ok(())
}
