//! Places in files, what is wrong there, what is worth knowing.

use std::collections::BTreeMap;
use std::fmt;

/// So many errors are told at once; the rest is counted.
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
    errors: Vec<(Place, String)>,
    unsaid: usize,
    /// Text → first place and how often.
    notes: BTreeMap<String, (Place, usize)>,
}

impl Report {
    /// Something wrong; the deck will be refused.
    pub fn error(&mut self, place: Place, text: impl Into<String>) {
        if self.errors.len() < MOST_ERRORS {
            self.errors.push((place, text.into()));
        } else {
            self.unsaid += 1;
        }
    }

    /// Something to know. The same text is said once, with the number of its places.
    pub fn note(&mut self, place: Place, text: impl Into<String>) {
        let entry = self.notes.entry(text.into()).or_insert((place, 0));
        entry.0 = entry.0.min(place);
        entry.1 += 1;
    }

    /// Whether the deck will be refused.
    pub fn has_errors(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Notes, or errors if there are any, in the order of their places. `files` are the names of the files by number.
    ///
    /// # Errors
    /// The errors, the first of them and the number of the rest.
    pub fn finish(mut self, files: &[String]) -> Result<Vec<Note>, Vec<DeckError>> {
        let name = |place: Place| files.get(place.file as usize).cloned().unwrap_or_default();
        if !self.errors.is_empty() {
            self.errors.sort();
            self.errors.dedup();
            let unsaid = std::mem::take(&mut self.unsaid);
            if let (Some((_, text)), true) = (self.errors.last_mut(), unsaid > 0) {
                *text += &format!(" (and {unsaid} more errors)");
            }
            let error = |(place, text): (Place, String)| DeckError { file: name(place), line: place.line, text };
            return Err(self.errors.into_iter().map(error).collect());
        }
        let mut notes: Vec<(Place, String, usize)> =
            self.notes.into_iter().map(|(text, (place, count))| (place, text, count)).collect();
        notes.sort();
        let note = |(place, text, count): (Place, String, usize)| {
            let text = if count > 1 { format!("{text} ({count} times)") } else { text };
            Note { file: name(place), line: place.line, text }
        };
        Ok(notes.into_iter().map(note).collect())
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
            report.error(Place { file: 0, line }, "bad");
        }
        let errors = report.finish(&["a.inp".into()]).unwrap_err();
        assert_eq!(errors.len(), MOST_ERRORS);
        assert_eq!(errors[0].to_string(), "a.inp:6: bad");
        assert!(errors[MOST_ERRORS - 1].text.ends_with("(and 5 more errors)"));
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
