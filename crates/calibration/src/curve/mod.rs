//! Reading test curves: the text of a file → stretch and nominal stress.
//!
//! A file is a table with a header, its cells separated by commas, semicolons or tabs; lines of any kind may stand above. Long
//! tables name the test in a column, wide ones in the names of their columns; a file may also be one test that its name, a
//! line above the table or the caller names. [`read`] says what it understood and refuses what it does not.

mod decimal;
mod header;
mod read;
mod select;
mod table;
mod unit;

use std::borrow::Cow;

pub use decimal::DecimalSign;
pub use read::read;
pub use select::ColumnChoice;
pub use unit::{StrainMeasure, StressMeasure, StressUnit};

use crate::law::Mode;

/// Largest file that is read, bytes.
pub const MAX_BYTES: usize = 50 << 20;

/// Most points that are kept of a file.
pub const MAX_POINTS: usize = 1_000_000;

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Stretch λ along the load; less than 1 in compression.
    pub stretch: f64,
    /// Nominal stress (force per undeformed area), MPa.
    pub stress: f64,
    /// Line of the file, from 1.
    pub line: usize,
}

/// The points of one test in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// File it was read from.
    pub file: String,
    /// Kind of test.
    pub mode: Mode,
    /// Points.
    pub points: Vec<Point>,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// One curve per kind of test, in the order of [`Mode::ALL`]; at least one, none without points.
    pub curves: Vec<Curve>,
    /// How columns and units were understood, one sentence per line.
    pub understood: Vec<String>,
}

/// What the caller knows about a file; everything that is `None` must be in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The test of a file that names none.
    pub test: Option<Mode>,
    /// Columns to read.
    pub columns: ColumnChoice,
    /// Unit of stresses whose header names none.
    pub unit: Option<StressUnit>,
    /// Strain measure of the abscissa.
    pub strain: Option<StrainMeasure>,
    /// Stress measure of the ordinate.
    pub stress: Option<StressMeasure>,
    /// Decimal sign.
    pub decimal: Option<DecimalSign>,
}

/// A file that cannot be used: where, why, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct CurveError {
    /// Line from 1, if there is one.
    pub line: Option<usize>,
    /// What is wrong; names the column.
    pub message: String,
    /// Advice.
    pub help: Option<String>,
}

impl CurveError {
    /// An error about the file as a whole.
    pub fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into(), help: None }
    }

    pub(crate) fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(message) }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// The text of a file: UTF-8, UTF-16 with a byte order mark, and otherwise Windows-1252, which machines like to write.
///
/// # Errors
/// A file larger than [`MAX_BYTES`], or with zero bytes, which is no text.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, CurveError> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} MiB; at most {} MiB are read", bytes.len() >> 20, MAX_BYTES >> 20);
        return Err(CurveError::new(message).help("keep every tenth row, or only the part that is to be fitted"));
    }
    let text = match encoding_rs::Encoding::for_bom(bytes) {
        Some((encoding, length)) => encoding.decode_without_bom_handling(&bytes[length..]).0,
        None => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0,
        },
    };
    if text.contains('\0') {
        return Err(CurveError::new("the file is no text (it has zero bytes)")
            .help("export the table as CSV; spreadsheets (.xlsx) are not read"));
    }
    Ok(text)
}

/// The words of a text in lower case.
pub(crate) fn words(text: &str) -> Vec<String> {
    header::tokens(text)
}

/// A cell as it is shown in messages.
pub(crate) fn shown(cell: &str) -> String {
    let mut short: String = cell.trim().chars().take(40).collect();
    if cell.trim().chars().count() > 40 {
        short.push('…');
    }
    short
}
