//! Measurements at pressures: a table in CSV.

use std::path::Path;

use pneuflex::InputError;
use pneuflex::number_table::NumberTable;

/// First columns of a table: what is on the load path.
const POSITIONS: [&str; 2] = ["pressure_kpa", "time"];

/// A number that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Name of its column, by which the results know what it is.
    pub column: String,
    /// Pressure, kPa, or time.
    pub at: f64,
    /// What was measured.
    pub value: f64,
}

/// Reads a table with a column `pressure_kpa` or `time`, and a column for every result that was measured, called as in `pneuflex table`. Empty
/// cells were not measured; lines that begin with `#` are remarks. `wanted` are the columns that count, if not all do.
///
/// # Errors
/// A file that cannot be read; columns and cells that are none, by line and name.
pub fn read(path: &Path, wanted: Option<&[String]>) -> Result<Vec<Measured>, InputError> {
    let refused = |what: String| InputError::about_file(path, what);
    let table = NumberTable::read(path)?;
    let names = table.names();
    let position = names.iter().position(|name| POSITIONS.contains(&name.as_str()));
    let position = position.ok_or_else(|| refused("no column is called pressure_kpa or time".to_owned()))?;
    if let Some(missing) = wanted.into_iter().flatten().find(|name| !names.contains(name)) {
        return Err(refused(format!("no column is called \"{missing}\"")));
    }
    let counts = |column: usize| column != position && wanted.is_none_or(|wanted| wanted.contains(&names[column]));
    let mut found = Vec::new();
    for row in 0..table.num_rows() {
        let at = table.given(row, position)?;
        if at == 0.0 {
            let what = format!(", {}: at 0 the body is at rest, which tells nothing of it", names[position]);
            return Err(table.refused(row, &what));
        }
        for column in (0..names.len()).filter(|column| counts(*column)) {
            let value = table.number(row, column)?;
            found.extend(value.map(|value| Measured { column: names[column].clone(), at, value }));
        }
    }
    if found.is_empty() {
        return Err(refused("holds no measurement".to_owned()));
    }
    Ok(found)
}

/// Where on the load path something was measured, from rest on.
pub fn positions(measured: &[Measured]) -> Vec<f64> {
    let mut found: Vec<f64> = measured.iter().map(|measured| measured.at).collect();
    found.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.total_cmp(b)));
    found.dedup();
    found
}
