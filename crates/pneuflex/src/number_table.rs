//! Tables of numbers that people write: CSV with the names of the columns first.

use std::fs;
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::input_error::InputError;

/// A table. Cells are separated by commas, or by semicolons where the names are; lines that begin with `#` are remarks.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberTable {
    path: PathBuf,
    names: Vec<String>,
    rows: Vec<StringRecord>,
}

impl NumberTable {
    /// Reads a file.
    ///
    /// # Errors
    /// One that cannot be read, and those of [`NumberTable::of`].
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let text = fs::read_to_string(path);
        Self::of(path, &text.map_err(|error| InputError::about_file(path, format!("cannot be read: {error}")))?)
    }

    /// The table in the text of a file.
    ///
    /// # Errors
    /// Rows that do not have a cell in every column; two columns of one name.
    pub fn of(path: &Path, text: &str) -> Result<Self, InputError> {
        let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
        let delimiter = if header.contains(';') && !header.contains(',') { b';' } else { b',' };
        let mut reader = ReaderBuilder::new();
        reader.delimiter(delimiter).comment(Some(b'#')).trim(Trim::All);
        // Spreadsheets put a mark before the first name.
        let mut reader = reader.from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let refused = |what: String| InputError::about_file(path, what);
        let names = reader.headers().map_err(|e| refused(e.to_string()))?;
        let names: Vec<String> = names.iter().map(str::to_owned).collect();
        if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            return Err(refused(format!("two columns are called \"{name}\"")));
        }
        let rows = reader.records().collect::<Result<_, _>>().map_err(|e| refused(e.to_string()))?;
        Ok(Self { path: path.to_owned(), names, rows })
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// How many rows there are below them.
    pub fn num_rows(&self) -> usize {
        self.rows.len()
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|other| other == name)
    }

    /// The number in a cell; `None` if that is empty.
    ///
    /// # Errors
    /// What is no finite number, with its line.
    pub fn number(&self, row: usize, column: usize) -> Result<Option<f64>, InputError> {
        let cell = &self.rows[row][column];
        if cell.is_empty() {
            return Ok(None);
        }
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        number.map(Some).ok_or_else(|| self.refused(row, &format!(", {}: \"{cell}\" is no number", self.names[column])))
    }

    /// The number in a cell.
    ///
    /// # Errors
    /// What is no finite number, or empty, with its line.
    pub fn given(&self, row: usize, column: usize) -> Result<f64, InputError> {
        self.number(row, column)?.ok_or_else(|| self.refused(row, &format!(", {}: it is empty", self.names[column])))
    }

    /// What is wrong with a row; `what` follows its line.
    pub fn refused(&self, row: usize, what: &str) -> InputError {
        let line = self.rows[row].position().map_or(0, csv::Position::line);
        InputError::about_file(&self.path, format!("line {line}{what}"))
    }
}
