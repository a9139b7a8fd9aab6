//! What can go wrong, and how it is shown: with the source line on a terminal, as one plain line elsewhere.

use std::fmt;

use miette::{Diagnostic, GraphicalReportHandler, LabeledSpan, NamedSource, SourceCode};
use pneuflex::input_error::{InputErrorKind, Origin};
use pneuflex::{Error, InputError, ResultsError};

use crate::terminal::{columns_of_errors, say, say_as_it_is};

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
            Self::Output(message) | Self::NotConverged(message) => say(&format!("error: {message}")),
        }
    }
}

/// Prints bad input on standard error: with colours on a terminal, as plain lines elsewhere.
fn print(error: &InputError) {
    let mut text = String::new();
    if let Some(width) = columns_of_errors() {
        let handler = GraphicalReportHandler::new().with_width(width).with_break_words(false);
        if handler.render_report(&mut text, &Shown::of(error)).is_ok() {
            return say_as_it_is(&text);
        }
    }
    match error.place() {
        Some(place) if place.origin() == Origin::Change => say(&format!("error: --set {}: {error}", place.name())),
        Some(place) => {
            say(&format!("error: {}:{}:{}: {error}", place.name(), place.line(), place.column()));
            say_as_it_is(&place.excerpt());
        }
        None => say(&format!("error: {error}")),
    }
    if let Some(help) = help(error) {
        say(&format!("  help: {help}"));
    }
}

/// What to do about bad input, in terms of the command line.
fn help(error: &InputError) -> Option<&str> {
    match error.kind() {
        InputErrorKind::Other => error.help(),
        InputErrorKind::TooLarge => {
            Some("choose a coarser mesh.resolution or a larger mesh.size, or --force to try all the same")
        }
        InputErrorKind::UnusableFolder => Some("choose another folder with --out"),
        InputErrorKind::ForeignFolder => Some("choose another folder with --out; nothing was touched"),
        InputErrorKind::BusyFolder => Some("wait until it has ended, or choose another folder with --out"),
        InputErrorKind::OtherResults => Some("run without --resume to start over; that replaces what is there"),
    }
}

/// Bad input as it is shown on a terminal.
#[derive(Debug)]
struct Shown<'a> {
    error: &'a InputError,
    source: Option<NamedSource<String>>,
}

impl<'a> Shown<'a> {
    fn of(error: &'a InputError) -> Self {
        let source = error.place().map(|place| {
            let name = match place.origin() {
                Origin::File => place.name().to_owned(),
                Origin::Change => format!("--set {}", place.name()),
            };
            NamedSource::new(name, place.text().to_string())
        });
        Self { error, source }
    }
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(f)
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        help(self.error).map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.error.place()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(place.span()))))
    }
}
