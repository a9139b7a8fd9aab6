//! What can go wrong, and how it is shown: with the source line on a terminal, as one plain line elsewhere.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::ops::Range;
use std::path::Path;

use miette::{Diagnostic, GraphicalReportHandler, LabeledSpan, NamedSource, SourceCode};

/// Bytes of a message, which may repeat what a file says.
const LONGEST_MESSAGE: usize = 1000;

/// Characters of a line that is shown, before and after the beginning of what is wrong in it.
const LINE_SHOWN: usize = 100;

/// An error of the program.
#[derive(Debug)]
pub enum CliError {
    /// What the user gave cannot be used: everything that is wrong with it.
    Input(Vec<InputError>),
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

impl Place {
    fn is_command_line(&self) -> bool {
        self.name.starts_with("--set")
    }

    /// The line with the place underlined; of a very long line, what is around the place.
    fn excerpt(&self) -> String {
        let text = self.source.inner();
        let start = text[..self.span.start].rfind('\n').map_or(0, |end| end + 1);
        let end = text[self.span.start..].find('\n').map_or(text.len(), |length| self.span.start + length);
        let number = self.line.to_string();
        let blank = " ".repeat(number.len());
        let mut before: Vec<char> = text[start..self.span.start].chars().rev().take(LINE_SHOWN).collect();
        before.reverse();
        let after: String = text[self.span.start..end].chars().take(LINE_SHOWN).collect();
        let marked = text[self.span.start..self.span.end.clamp(self.span.start, end)].chars().take(LINE_SHOWN).count();
        // Tabs keep their width in the line below.
        let below: String = before.iter().map(|c| if *c == '\t' { '\t' } else { ' ' }).collect();
        let line: String = before.into_iter().collect::<String>() + after.trim_end();
        format!("  {number} | {line}\n  {blank} | {below}{}", "^".repeat(marked.max(1)))
    }
}

/// A text of no more than about so many bytes: what is too much is left out in the middle.
fn shortened(text: String, most: usize) -> String {
    if text.len() <= most {
        return text;
    }
    let (head, tail) = (floor_char(&text, most / 2), floor_char(&text, text.len() - most / 2));
    format!("{} […] {}", &text[..head], &text[tail..])
}

/// The largest character boundary of `text` that is not beyond `index`.
fn floor_char(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

impl InputError {
    /// An error that belongs to no place in a file.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: shortened(message.into(), LONGEST_MESSAGE), help: None, place: None }
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
        Self::Input(vec![error])
    }
}

impl From<Vec<InputError>> for CliError {
    fn from(errors: Vec<InputError>) -> Self {
        Self::Input(errors)
    }
}

impl From<InputError> for Vec<InputError> {
    fn from(error: InputError) -> Self {
        vec![error]
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
            Self::Input(errors) => errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
            Self::Output(message) => message.clone(),
        }
    }

    /// Prints the error on standard error.
    pub fn print(&self) {
        match self {
            Self::Input(errors) => errors.iter().for_each(InputError::print),
            Self::Output(message) => say(&format!("error: {message}")),
        }
    }
}

impl InputError {
    /// Prints the error on standard error: with colours on a terminal, as plain lines elsewhere.
    fn print(&self) {
        let mut text = String::new();
        if io::stderr().is_terminal() && GraphicalReportHandler::new().render_report(&mut text, self).is_ok() {
            return say(&text);
        }
        match &self.place {
            Some(p) if p.is_command_line() => say(&format!("error: {}: {self}", p.name)),
            Some(p) => {
                say(&format!("error: {}:{}:{}: {self}", p.name, p.line, p.column));
                say(&p.excerpt());
            }
            None => say(&format!("error: {self}")),
        }
        if let Some(help) = &self.help {
            say(&format!("  help: {help}"));
        }
    }

    /// Where it belongs: places on the command line come after those in the file.
    pub fn position(&self) -> (bool, usize) {
        self.place.as_ref().map_or((false, 0), |place| (place.is_command_line(), place.span.start))
    }
}

/// Prints a line on standard error; nobody listening there is no reason to stop.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
