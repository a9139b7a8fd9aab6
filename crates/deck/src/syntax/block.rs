//! A keyword with its parameters and data lines.

use std::ops::Range;

use crate::report::Place;

/// The texts of a deck and of the files that it includes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sources {
    /// Names of the files as the deck gives them, in the order in which they were opened.
    pub names: Vec<String>,
    /// Their texts.
    pub(super) texts: Vec<String>,
}

/// A keyword with its parameters and data lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The keyword in capitals without its asterisk and without blanks: `SOLIDSECTION`.
    pub keyword: String,
    /// The keyword as it is written, with its asterisk: `*Solid Section`.
    pub written: String,
    /// Where it stands.
    pub place: Place,
    /// Parameters in the order in which they are written.
    pub parameters: Vec<Parameter>,
    /// Lines of data.
    pub lines: Vec<DataLine>,
}

/// A parameter of a keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name in capitals, without blanks.
    pub name: String,
    /// What stands behind the equals sign, without quotes.
    pub value: Option<String>,
}

/// A line of data.
#[derive(Clone, Debug, PartialEq)]
pub struct DataLine {
    /// Where it stands.
    pub place: Place,
    /// Bytes of the file's text.
    pub(super) bytes: Range<u32>,
}

impl Sources {
    /// Text of a line, without blanks around it.
    pub fn text(&self, line: &DataLine) -> &str {
        &self.texts[line.place.file as usize][line.bytes.start as usize..line.bytes.end as usize]
    }

    /// The line's entries between commas, without blanks and quotes around them; empty ones at its end are left out.
    pub fn fields(&self, line: &DataLine) -> Vec<&str> {
        let mut found: Vec<&str> = fields(self.text(line)).map(unquoted).collect();
        while found.last().is_some_and(|field| field.is_empty()) {
            found.pop();
        }
        found
    }
}

impl Block {
    /// Whether there is such a parameter, with a value or without.
    pub fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|parameter| parameter.name == name)
    }

    /// Value of a parameter, as it is written.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|parameter| parameter.name == name)?.value.as_deref()
    }

    /// Value of a parameter in capitals and without blanks, for values that are words of the language.
    pub fn word(&self, name: &str) -> Option<String> {
        self.value(name).map(bare)
    }
}

/// In capitals, without blanks.
pub(super) fn bare(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_uppercase).collect()
}

/// Pieces between commas outside of double quotes, without blanks around them.
pub(super) fn fields(text: &str) -> impl Iterator<Item = &str> {
    let mut in_quotes = false;
    text.split(move |c| {
        in_quotes ^= c == '"';
        c == ',' && !in_quotes
    })
    .map(str::trim)
}

/// The text within double quotes, or the text.
pub(super) fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(text)
}
