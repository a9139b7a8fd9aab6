//! Places in files, what is wrong there, what is worth knowing.

use std::collections::BTreeMap;
use std::fmt;

/// So many different errors are told at once; the rest is counted.
const MOST_ERRORS: usize = 30;

/// So many characters of a deck's own text are repeated in a message.
const MOST_QUOTED: usize = 40;

/// A line of one of the files of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Number of the file, in the order in which they were opened.
    pub file: u32,
    /// Line, from 1.
    pub line: u32,
}

/// Something wrong with a deck.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}: {text}")]
pub struct DeckError {
    /// The file, as it was named to the reader.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// What is wrong, and what would be allowed.
    pub text: String,
}

/// Something that a reader of a deck understood in another way than its author may have meant it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file, as it was named to the reader.
    pub file: String,
    /// Line, from 1, of the first place that it is about.
    pub line: u32,
    /// What to know.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.text)
    }
}

/// Collects errors and notes while a deck is read.
#[derive(Debug, Default)]
pub struct Report {
    errors: Said,
    unsaid: usize,
    notes: Said,
}

/// Texts, each with its first place, its last one, and the number of its places.
type Said = BTreeMap<String, (Place, Place, usize)>;

/// The same text is said once.
fn add(said: &mut Said, place: Place, text: String) {
    let (first, last, count) = said.entry(text).or_insert((place, place, 1));
    if place != *last {
        *count += 1;
    }
    (*first, *last) = (place.min(*first), place);
}

/// First places and texts, with the number of places where it is not one, in their order.
fn in_order(said: Said) -> Vec<(Place, String)> {
    let mut found: Vec<(Place, String, usize)> =
        said.into_iter().map(|(text, (first, _, count))| (first, text, count)).collect();
    found.sort();
    let words = |text: String, count| if count > 1 { format!("{text} ({count} times)") } else { text };
    found.into_iter().map(|(place, text, count)| (place, words(text, count))).collect()
}

impl Report {
    /// Something wrong; the deck will be refused. The same text is said once, with the number of its places.
    pub fn error(&mut self, place: Place, text: impl Into<String>) {
        let text = text.into();
        if self.errors.len() < MOST_ERRORS || self.errors.contains_key(&text) {
            add(&mut self.errors, place, text);
        } else {
            self.unsaid += 1;
        }
    }

    /// Something to know. The same text is said once, with the number of its places.
    pub fn note(&mut self, place: Place, text: impl Into<String>) {
        add(&mut self.notes, place, text.into());
    }

    /// Whether the deck will be refused.
    pub fn has_errors(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Notes, or errors if there are any, in the order of their places. `files` are the names of the files by number.
    ///
    /// # Errors
    /// The errors, the first of them and the number of the rest.
    pub fn finish(self, files: &[String]) -> Result<Vec<Note>, Vec<DeckError>> {
        let name = |place: Place| files.get(place.file as usize).cloned().unwrap_or_default();
        let mut errors = in_order(self.errors);
        if !errors.is_empty() {
            if let (Some((_, text)), true) = (errors.last_mut(), self.unsaid > 0) {
                *text += &format!(" (and {} more errors)", self.unsaid);
            }
            let error = |(place, text): (Place, String)| DeckError { file: name(place), line: place.line, text };
            return Err(errors.into_iter().map(error).collect());
        }
        let note = |(place, text): (Place, String)| Note { file: name(place), line: place.line, text };
        Ok(in_order(self.notes).into_iter().map(note).collect())
    }
}

/// A piece of a deck's text, short enough for a message.
pub(crate) fn quoted(text: &str) -> String {
    let text = text.trim();
    if text.chars().count() <= MOST_QUOTED {
        return format!("\"{text}\"");
    }
    format!("\"{}…\"", text.chars().take(MOST_QUOTED).collect::<String>())
}

/// ", did you mean …?" if a candidate is near enough to `word`; else nothing.
pub(crate) fn suggestion<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let length = word.chars().count();
    let allowed = (length / 3).max(1);
    let word = word.to_uppercase();
    candidates
        .into_iter()
        // The distance is no less than the difference of the lengths; a word may be as long as a file.
        .filter(|candidate| length <= 200 && candidate.chars().count().abs_diff(length) <= allowed)
        .map(|candidate| (strsim::osa_distance(&word, &candidate.to_uppercase()), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min()
        .map(|(_, candidate)| format!("; did you mean {candidate}?"))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_come_in_the_order_of_their_places_and_the_rest_is_counted() {
        let mut report = Report::default();
        for line in (1..=MOST_ERRORS as u32 + 5).rev() {
            report.error(Place { file: 0, line }, format!("bad {line}"));
        }
        let errors = report.finish(&["a.inp".into()]).unwrap_err();
        assert_eq!(errors.len(), MOST_ERRORS);
        assert_eq!(errors[0].to_string(), "a.inp:6: bad 6");
        assert!(errors[MOST_ERRORS - 1].text.ends_with("(and 5 more errors)"));
    }

    #[test]
    fn equal_errors_are_said_once_with_their_number() {
        let mut report = Report::default();
        for line in [9, 4, 4, 1000] {
            report.error(Place { file: 0, line }, "not a number");
        }
        (0..100).for_each(|line| report.error(Place { file: 0, line: 5 }, format!("bad {}", line / 50)));
        let errors = report.finish(&["a.inp".into()]).unwrap_err();
        let said: Vec<_> = errors.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["a.inp:4: not a number (3 times)", "a.inp:5: bad 0", "a.inp:5: bad 1"]);
    }

    #[test]
    fn equal_notes_are_said_once() {
        let mut report = Report::default();
        for line in [7, 3, 9] {
            report.note(Place { file: 0, line }, "left out");
        }
        let notes = report.finish(&["a.inp".into()]).unwrap();
        assert_eq!(notes.iter().map(Note::to_string).collect::<Vec<_>>(), ["a.inp:3: left out (3 times)"]);
    }

    #[test]
    fn near_misses_are_recognised() {
        assert_eq!(suggestion("*BUONDARY", ["*BOUNDARY", "*NODE"]), "; did you mean *BOUNDARY?");
        assert_eq!(suggestion("TOPP", ["Top", "Bottom"]), "; did you mean Top?");
        assert_eq!(suggestion("elephant", ["Top", "Bottom"]), "");
    }
}
