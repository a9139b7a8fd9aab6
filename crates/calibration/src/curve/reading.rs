//! What is read, and how.

use super::decimal::DecimalSign;
use super::unit::{StrainMeasure, StressMeasure, StressUnit};
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
    /// Undeformed area (mm²) and length (mm) of the specimen: force and change of length are read.
    pub specimen: Option<[f64; 2]>,
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

/// Columns named by the caller, each by its number from 1 or by its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnChoice {
    /// Stretch or strain, with what it holds; `None` to let its name say that.
    pub strain: Option<(String, Option<StrainMeasure>)>,
    /// Stress, with what it holds.
    pub stress: Option<(String, Option<StressMeasure>)>,
    /// Kind of test.
    pub test: Option<String>,
}

/// A cell as it is shown in messages.
pub(crate) fn shown(cell: &str) -> String {
    let mut short: String = cell.trim().chars().take(40).collect();
    if cell.trim().chars().count() > 40 {
        short.push('…');
    }
    short
}
