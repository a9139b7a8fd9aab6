//! Reading test curves: the text of a file → stretch and nominal stress.
//!
//! A file is a table with a header, its cells separated by commas, semicolons or tabs; lines of any kind may stand above. Long
//! tables name the test in a column, wide ones in the names of their columns; a file may also be one test that its name, a
//! line above the table or the caller names. [`read`] says what it understood and refuses what it does not.

mod decimal;
mod header;
mod read;
mod reading;
mod select;
mod stress_measure;
mod table;
mod text;
mod unit;

pub use decimal::DecimalSign;
pub use read::read;
pub use reading::{ColumnChoice, Curve, CurveError, MAX_BYTES, MAX_POINTS, Point, ReadOptions, Reading};
pub use text::decode;
pub use unit::{StrainMeasure, StressMeasure, StressUnit};
