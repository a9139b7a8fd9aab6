//! What can go wrong, and how it is shown.

use anstyle::{AnsiColor, Style};
use pneuflex::input_error::{InputErrorKind, Origin};
use pneuflex::{Error, InputError, ResultsError};

use crate::terminal::{say, say_as_it_is};

/// An error of the program.
#[derive(Debug)]
pub enum CliError {
    /// What the user gave cannot be used: everything that is wrong with it.
    Input(Vec<InputError>),
    /// A result could not be written.
    Output(String),
    /// The computation did not come to its end.
    NotConverged(String),
}

impl From<InputError> for CliError {
    fn from(error: InputError) -> Self {
        Self::Input(vec![error])
    }
}

impl From<Vec<InputError>> for CliError {
    fn from(errors: Vec<InputError>) -> Self {
        Self::Input(errors)
    }
}

impl From<ResultsError> for CliError {
    fn from(error: ResultsError) -> Self {
        Self::Output(error.to_string())
    }
}

impl From<Error> for CliError {
    fn from(error: Error) -> Self {
        match error {
            Error::Input(errors) => Self::Input(errors),
            Error::Results(error) => error.into(),
            Error::Threads { threads, source } => InputError::new(format!("--threads {threads}: {source}")).into(),
            Error::Setup(ended) | Error::NotConverged(ended) | Error::Interrupted(ended) => {
                Self::NotConverged(ended.to_string())
            }
        }
    }
}

impl CliError {
    /// What went wrong, in one line.
    pub fn message(&self) -> String {
        match self {
            Self::Input(errors) => errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
            Self::Output(message) | Self::NotConverged(message) => message.clone(),
        }
    }

    /// Prints the error on standard error.
    pub fn print(&self) {
        match self {
            Self::Input(errors) => errors.iter().for_each(print),
            Self::Output(message) | Self::NotConverged(message) => complain(message),
        }
    }
}

/// Prints bad input on standard error, with the line that is meant.
fn print(error: &InputError) {
    match error.place() {
        Some(place) if place.origin() == Origin::Change => complain(&format!("--set {}: {error}", place.name())),
        Some(place) => {
            complain(&format!("{}:{}:{}: {error}", place.name(), place.line(), place.column()));
            say_as_it_is(&place.excerpt());
        }
        None => complain(&error.to_string()),
    }
    if let Some(help) = help(error) {
        let style = AnsiColor::Cyan.on_default();
        say(&format!("  {style}help{style:#}: {help}"));
    }
}

/// What to do about bad input, in terms of the command line.
fn help(error: &InputError) -> Option<&str> {
    match error.kind() {
        InputErrorKind::Other
        | InputErrorKind::Unknown
        | InputErrorKind::TooManyThreads
        | InputErrorKind::MissingProgram => error.help(),
        InputErrorKind::TooLarge => {
            Some("choose a coarser mesh.resolution or a larger mesh.size, or --force to try all the same")
        }
        InputErrorKind::UnusableFolder => Some("choose another folder with --out"),
        InputErrorKind::ForeignFolder => Some("choose another folder with --out; nothing was touched"),
        InputErrorKind::BusyFolder => Some("wait until it has ended, or choose another folder with --out"),
        InputErrorKind::OtherSweep => Some("choose another folder with --out"),
        InputErrorKind::OtherResults => Some("run without --resume to start over; that replaces what is there"),
    }
}

/// Says what went wrong.
fn complain(message: &str) {
    let style = Style::new().bold().fg_color(Some(AnsiColor::Red.into()));
    say(&format!("{style}error{style:#}: {message}"));
}
