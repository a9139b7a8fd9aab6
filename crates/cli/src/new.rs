//! `pneuflex new`: a commented case file to start from.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;

use crate::args::{CaseKind, NewArguments};
use crate::error::{CliError, InputError};

const TEMPLATE: &str = include_str!("../templates/case.toml");

/// The text of the case file.
pub fn text(kind: CaseKind) -> String {
    let values: [(&str, &str); 6] = match kind {
        CaseKind::TwoChamber => [
            ("{name}", "two_chamber"),
            ("{what}", "Two chambers of a soft pneumatic actuator"),
            ("{title}", "Two chambers, multiple-point contact"),
            ("{chambers}", "2"),
            ("{flange}", "0.0"),
            ("{length}", "18.0"),
        ],
        CaseKind::Actuator => [
            ("{name}", "actuator"),
            ("{what}", "A soft pneumatic actuator with eight chambers"),
            ("{title}", "Full actuator, multiple-point contact"),
            ("{chambers}", "8"),
            ("{flange}", "2.0"),
            ("{length}", "82.0"),
        ],
    };
    values.iter().fold(TEMPLATE.to_owned(), |text, (mark, value)| text.replace(mark, value))
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
        InputError::file(&path, reason).help(Some("give another file name as the last argument".into()))
    })?;
    file.write_all(text(arguments.kind).as_bytes())
        .map_err(|error| CliError::Output(format!("{}: cannot be written: {error}", path.display())))?;
    let name = path.display();
    // Nobody reading on is no error.
    let _ = writeln!(io::stdout(), "wrote {name}\nnext: pneuflex check {name}\n      pneuflex run {name}");
    Ok(())
}
