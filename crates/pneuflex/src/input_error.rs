//! Bad input: what is wrong, where it stands, and what to do about it.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use pneuflex_deck::DeckError;

/// Bytes of a message, which may repeat what a file says.
const LONGEST_MESSAGE: usize = 1000;

/// Characters of a line that is shown, before and after the beginning of what is wrong in it.
const LINE_SHOWN: usize = 100;

/// Bad input: what, where, and what to do about it. Displays as the message alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    kind: InputErrorKind,
    // Boxed slices: results carry this type, and should stay small.
    message: Box<str>,
    key: Option<Box<str>>,
    help: Option<Box<str>>,
    file: Option<Box<Path>>,
    line: Option<usize>,
    place: Option<Box<Place>>,
}

/// Kinds of bad input about which a caller may have more to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputErrorKind {
    /// Any other.
    #[default]
    Other,
    /// A key or a name that is not known.
    Unknown,
    /// The body needs more memory than there is; it may be tried with [`crate::MemoryLimit::None`].
    TooLarge,
    /// More threads than the machine has a use for.
    TooManyThreads,
    /// The output folder cannot be made or written to.
    UnusableFolder,
    /// The output folder holds files that are no results.
    ForeignFolder,
    /// Another run is writing to the output folder.
    BusyFolder,
    /// The output folder holds results that cannot be gone on with.
    OtherResults,
    /// The folder holds another sweep.
    OtherSweep,
    /// A program that is needed is not there.
    MissingProgram,
}

impl InputErrorKind {
    /// Whether it is no fault of the input: another machine or folder, or this one at another time, may do.
    pub fn is_of_machine(self) -> bool {
        !matches!(self, Self::Other | Self::Unknown)
    }
}

/// What a place is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The text of a file.
    File,
    /// A change to a key, see [`crate::Study::set`].
    Change,
}

/// A place in a text: in a case file, or in a change to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    name: String,
    origin: Origin,
    text: Arc<str>,
    span: Range<usize>,
    line: usize,
    column: usize,
}

impl Place {
    /// The bytes `span` of `text`, which is called `name` in messages.
    pub fn new(name: &str, origin: Origin, text: Arc<str>, span: Range<usize>) -> Self {
        let start = floor_char(&text, span.start);
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        let span = start..floor_char(&text, span.end).max(start);
        Self { name: name.into(), origin, text, span, line, column }
    }

    /// Name of the file as it was given, or the change as `KEY=VALUE`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the place is in.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// The whole text.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The bytes of the text that are meant.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Column in characters, from 1.
    pub fn column(&self) -> usize {
        self.column
    }

    /// The line with the place underlined; of a very long line, what is around the place.
    pub fn excerpt(&self) -> String {
        let text = &*self.text;
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
        let message = shortened(message.into(), LONGEST_MESSAGE).into();
        Self { kind: InputErrorKind::Other, message, key: None, help: None, file: None, line: None, place: None }
    }

    /// An error about a file as a whole.
    pub fn about_file(path: &Path, message: impl fmt::Display) -> Self {
        Self { file: Some(path.into()), ..Self::new(format!("{}: {message}", path.display())) }
    }

    /// Sets the kind.
    pub fn of_kind(mut self, kind: InputErrorKind) -> Self {
        self.kind = kind;
        self
    }

    /// The kind.
    pub fn kind(&self) -> InputErrorKind {
        self.kind
    }

    /// Adds the key that it is about.
    pub fn of_key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into().into_boxed_str()).filter(|key| !key.is_empty());
        self
    }

    /// Adds the place.
    pub fn at(mut self, place: Option<Place>) -> Self {
        self.place = place.map(Box::new);
        self
    }

    /// Adds advice.
    pub fn with_help(mut self, help: Option<String>) -> Self {
        self.help = help.map(String::into_boxed_str);
        self
    }

    /// The key that it is about, e.g. `actuator.gap` or `probe[1].at`.
    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// What to do about it.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The file that it is about, as it was named.
    pub fn file(&self) -> Option<&Path> {
        let of_place = self.place.as_deref().filter(|place| place.origin == Origin::File);
        self.file.as_deref().or(of_place.map(|place| Path::new(&place.name)))
    }

    /// The line of that file, from 1.
    pub fn line(&self) -> Option<usize> {
        self.line.or(self.place.as_deref().filter(|place| place.origin == Origin::File).map(Place::line))
    }

    /// Where it stands, with the text around it.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_deref()
    }

    /// The message with its place, the line that is meant, and what to do about it.
    pub fn in_full(&self, help: Option<&str>) -> String {
        let mut text = match self.place() {
            Some(place) if place.origin() == Origin::Change => format!("{}: {self}", place.name()),
            Some(place) => format!("{}:{}:{}: {self}\n{}", place.name(), place.line(), place.column(), place.excerpt()),
            None => self.to_string(),
        };
        if let Some(help) = help {
            text += "\n  help: ";
            text += help;
        }
        text
    }

    /// Where it belongs among others: changes come after the file.
    pub(crate) fn position(&self) -> (bool, usize) {
        self.place.as_ref().map_or((false, 0), |place| (place.origin == Origin::Change, place.span.start))
    }
}

impl From<DeckError> for InputError {
    fn from(error: DeckError) -> Self {
        let (file, line) = (Some(Path::new(&error.file).into()), Some(error.line as usize));
        Self { file, line, ..Self::new(error.to_string()) }
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
