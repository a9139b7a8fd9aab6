//! Lines, cells and the cell separator of a text.

use std::borrow::Cow;

use super::decimal::is_number;
use super::reading::CurveError;

/// Longest line, bytes: with it no row can become larger than this, whatever the text.
const MAX_LINE: usize = 16 << 10;

/// How many lines are looked at to find separator and header.
pub const LOOK_AHEAD: usize = 1000;

/// A row of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'a> {
    /// Line of the file, from 1.
    pub line: usize,
    /// Cells without the blanks around them.
    pub cells: Vec<Cow<'a, str>>,
}

impl Row<'_> {
    /// A cell; those beyond the end are empty.
    pub fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", |c| c)
    }

    /// How many cells are numbers.
    pub fn count_numbers(&self) -> usize {
        self.cells.iter().filter(|c| is_number(c)).count()
    }
}

/// The lines of a text with their numbers from 1, whatever ends them; no empty lines, no comments (`#`).
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let bytes = text.as_bytes();
    let ends = move |(i, b): (usize, &u8)| {
        // A carriage return ends a line unless a line feed does.
        (*b == b'\n' || *b == b'\r' && bytes.get(i + 1) != Some(&b'\n')).then_some(i)
    };
    let mut start = 0;
    bytes.iter().enumerate().filter_map(ends).chain(std::iter::once(bytes.len())).enumerate().filter_map(
        move |(number, end)| {
            let line = &text[start.min(end)..end];
            start = end + 1;
            let line = line.trim_end_matches('\r');
            let is_comment = line.trim_start_matches([' ', '\t', '"', '\'', '\u{feff}']).starts_with('#');
            (!line.trim().is_empty() && !is_comment).then_some((number + 1, line))
        },
    )
}

/// Splits a line; cells may be quoted.
///
/// # Errors
/// A line of more than 16 KiB.
pub fn split(line: usize, text: &str, separator: u8) -> Result<Row<'_>, CurveError> {
    if text.len() > MAX_LINE {
        return Err(CurveError::at(line, format!("the line has more than {MAX_LINE} characters")));
    }
    let cells = if text.contains('"') {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .delimiter(separator)
            .buffer_capacity(MAX_LINE)
            .from_reader(text.as_bytes());
        let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
        record.iter().map(|c| Cow::Owned(c.trim().to_owned())).collect()
    } else if separator == b' ' {
        text.split_whitespace().map(Cow::Borrowed).collect()
    } else {
        text.split(char::from(separator)).map(|c| Cow::Borrowed(c.trim())).collect()
    };
    Ok(Row { line, cells })
}

/// The separator that gives the most lines with at least two numbers: semicolon, tab or comma, or else blanks.
///
/// # Errors
/// No separator gives any.
pub fn separator(text: &str) -> Result<u8, CurveError> {
    let mut best = (0, b';');
    for candidate in [b';', b'\t', b',', b' '] {
        let rows = lines(text).take(LOOK_AHEAD).filter_map(|(n, l)| split(n, l, candidate).ok());
        let count = rows.filter(|row| row.count_numbers() >= 2).count();
        // Blanks stand behind commas and semicolons, too.
        if count > best.0 && (candidate != b' ' || best.0 == 0) {
            best = (count, candidate);
        }
    }
    if best.0 == 0 {
        return Err(CurveError::new("no line holds two numbers separated by a comma, a semicolon, a tab or blanks")
            .help("expected a table with a column of stretch or strain and one of stress"));
    }
    Ok(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_they_like_and_keep_their_numbers() {
        let numbers: Vec<(usize, &str)> = lines("a\r\n\r\nb\n# c\rd\n\"# e\"\nf").collect();
        assert_eq!(numbers, [(1, "a"), (3, "b"), (5, "d"), (7, "f")]);
        assert_eq!(lines("").count() + lines("\n\r\n\r").count(), 0);
    }

    #[test]
    fn the_separator_is_found_beside_decimal_commas() {
        assert_eq!(separator("a;b\n1,5;2,5\n"), Ok(b';'));
        assert_eq!(separator("a,b\n1.5,2.5\n"), Ok(b','));
        assert_eq!(separator("a\tb\n1,5\t2,5\n"), Ok(b'\t'));
        assert_eq!(separator("a b\n1.5   2.5\n"), Ok(b' '));
        assert!(separator("a b\n1.5\n").is_err());
    }

    #[test]
    fn quoted_cells_hold_separators() {
        let row = split(3, "\"a, b\",2, c", b',').unwrap();
        assert_eq!((row.line, row.cells), (3, vec!["a, b".into(), "2".into(), Cow::from("c")]));
        assert!(split(1, &";".repeat(MAX_LINE + 1), b';').is_err());
    }
}
