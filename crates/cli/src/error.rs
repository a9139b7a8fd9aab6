//! What can go wrong, and how it is shown: with the source line on a terminal, as one plain line elsewhere.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::ops::Range;
use std::path::Path;

use miette::{Diagnostic, GraphicalReportHandler, LabeledSpan, NamedSource, SourceCode};

/// An error of the program.
#[derive(Debug)]
pub enum CliError {
    /// What the user gave cannot be used.
    Input(InputError),
    /// A result could not be written.
    Output(String),
}

/// Bad input: what, where, and what to do about it.
#[derive(Debug)]
pub struct InputError {
    message: String,
    help: Option<String>,
    place: Option<Box<Place>>,
}

/// A place in a case file or in a `--set` argument.
#[derive(Debug)]
pub struct Place {
    name: String,
    source: NamedSource<String>,
    span: Range<usize>,
    line: usize,
    column: usize,
}

impl Place {
    /// The bytes `span` of `text`, which is called `name` in messages.
    pub fn new(name: &str, text: &str, span: Range<usize>) -> Self {
        let start = floor_char(text, span.start);
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let span = start..floor_char(text, span.end).max(start);
        Self { name: name.into(), source: NamedSource::new(name, text.to_owned()), span, line, column }
    }
}

/// The largest character boundary of `text` that is not beyond `index`.
fn floor_char(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

impl InputError {
    /// An error that belongs to no place in a file.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, place: None }
    }

    /// An error about a file as a whole.
    pub fn file(path: &Path, message: impl fmt::Display) -> Self {
        Self::new(format!("{}: {message}", path.display()))
    }

    /// Adds the place.
    pub fn at(mut self, place: Option<Place>) -> Self {
        self.place = place.map(Box::new);
        self
    }

    /// Adds advice.
    pub fn help(mut self, help: Option<String>) -> Self {
        self.help = help;
        self
    }
}

impl From<InputError> for CliError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for InputError {}

impl Diagnostic for InputError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|p| &p.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(place.span.clone()))))
    }
}

impl CliError {
    /// What went wrong, in one line.
    pub fn message(&self) -> String {
        match self {
            Self::Input(error) => error.to_string(),
            Self::Output(message) => message.clone(),
        }
    }

    /// Prints the error on standard error.
    pub fn print(&self) {
        match self {
            Self::Input(error) if io::stderr().is_terminal() => {
                let mut text = String::new();
                match GraphicalReportHandler::new().render_report(&mut text, error) {
                    Ok(()) => say(&text),
                    Err(_) => say(&format!("error: {error}")),
                }
            }
            Self::Input(error) => {
                match &error.place {
                    Some(p) if p.name.starts_with("--set") => say(&format!("error: {}: {error}", p.name)),
                    Some(p) => say(&format!("error: {}:{}:{}: {error}", p.name, p.line, p.column)),
                    None => say(&format!("error: {error}")),
                }
                if let Some(help) = &error.help {
                    say(&format!("  help: {help}"));
                }
            }
            Self::Output(message) => say(&format!("error: {message}")),
        }
    }
}

/// Prints a line on standard error; nobody listening there is no reason to stop.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
