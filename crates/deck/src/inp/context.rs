//! What every reader of keywords needs: the texts, and where complaints go.

use crate::report::{Place, Report, quoted};
use crate::syntax::{Block, DataLine, Sources, integer, real};

/// The texts, and where complaints go.
pub(super) struct Context<'a> {
    pub sources: &'a Sources,
    pub report: &'a mut Report,
}

impl<'a> Context<'a> {
    /// Entries of a line, see [`Sources::fields`].
    pub fn fields(&self, line: &DataLine) -> Vec<&'a str> {
        self.sources.fields(line)
    }

    pub fn error(&mut self, place: Place, text: impl Into<String>) {
        self.report.error(place, text);
    }

    pub fn note(&mut self, place: Place, text: impl Into<String>) {
        self.report.note(place, text);
    }

    /// A finite number, or a complaint and `None`.
    pub fn real(&mut self, place: Place, text: &str) -> Option<f64> {
        real(text).map_err(|why| self.error(place, why)).ok()
    }

    /// A number, 0 if the entry is empty or missing.
    pub fn real_or_zero(&mut self, place: Place, text: Option<&&str>) -> Option<f64> {
        match text {
            None | Some(&"") => Some(0.0),
            Some(text) => self.real(place, text),
        }
    }

    /// A whole number, or a complaint and `None`.
    pub fn integer(&mut self, place: Place, text: &str) -> Option<i32> {
        integer(text).map_err(|why| self.error(place, why)).ok()
    }

    /// The value of a parameter that must be there.
    pub fn required<'b>(&mut self, block: &'b Block, name: &str) -> Option<&'b str> {
        match block.value(name) {
            Some(value) if !value.is_empty() => Some(value),
            _ => {
                self.error(block.place, format!("{} needs {name}=…", block.written));
                None
            }
        }
    }

    /// All entries of a keyword's lines one after the other; `None` if one of them is not a number.
    pub fn numbers(&mut self, block: &Block) -> Option<Vec<f64>> {
        let mut found = Vec::new();
        let mut good = true;
        for line in &block.lines {
            for field in self.fields(line) {
                match self.real_or_zero(line.place, Some(&field)) {
                    Some(value) => found.push(value),
                    None => good = false,
                }
            }
        }
        good.then_some(found)
    }

    /// Refuses a parameter whose value is none of some words; `None` stands for a parameter that is not given.
    pub fn expect_word(&mut self, block: &Block, name: &str, allowed: &[&str]) {
        if let Some(word) = block.word(name)
            && !allowed.contains(&word.as_str())
        {
            let (written, value) = (&block.written, quoted(block.value(name).unwrap_or_default()));
            self.error(
                block.place,
                format!("{written}: {name}={value} is not supported, only {}", allowed.join(" or ")),
            );
        }
    }
}
