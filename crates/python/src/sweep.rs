//! What the program's sweeps and the package's have in common: names of designs, numbers of states, the table.

use std::collections::BTreeMap;
use std::path::PathBuf;

use pneuflex::columns::{Tip, columns};
use pneuflex::post::summary::StepSummary;
use pneuflex::{Error, ResultsError};
use pneuflex_sweep::folder::plan_of;
use pneuflex_sweep::{Row, identity, neighbours, space, table};
use pyo3::prelude::*;

use crate::error::apart;
use crate::study::Study;

/// The name of a design of a sweep, by the content of its files.
#[pyfunction]
pub fn identity_of(py: Python<'_>, study: &Study, content: &str, fields: bool) -> PyResult<String> {
    apart(py, || identity::of_study(&study.0, content, fields))
}

/// The name of a design whose values make no body, in a sweep of that origin.
#[pyfunction]
pub fn identity_of_bad_input(origin: &str, design: Vec<(String, String)>, fields: bool) -> String {
    identity::of_bad_input(origin, &design, fields)
}

/// Whether the values of a key are counts.
#[pyfunction]
pub fn is_count(key: &str) -> bool {
    space::is_count(key)
}

/// A digest of the files that a study reads beside its values.
#[pyfunction]
pub fn content_of(py: Python<'_>, study: &Study) -> PyResult<String> {
    apart(py, || Ok(identity::content(&study.0)))
}

/// The numbers of a state by their columns, as JSON, from its part of `summary.json`; `length` is that of an actuator at rest, `tip_at` the
/// place of the probe `tip`.
#[pyfunction]
pub fn numbers(py: Python<'_>, summary: &str, length: Option<f64>, tip_at: Option<[f64; 3]>) -> PyResult<String> {
    let wrong = |error: serde_json::Error| Error::from(ResultsError::not_representable("summary", error));
    apart(py, || {
        let state: StepSummary = serde_json::from_str(summary).map_err(wrong)?;
        let numbers = columns(&state, &Tip { length, probe_at: tip_at });
        serde_json::to_string(&numbers).map_err(wrong)
    })
}

/// Names of the designs that start from another one, each with the name of that.
#[pyfunction]
pub fn neighbours_of(names: Vec<String>, designs: Vec<Vec<(String, String)>>) -> BTreeMap<String, String> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    neighbours::by_name(&names, &designs)
}

/// Removes what the designs of a sweep have left for each other.
#[pyfunction]
pub fn forget_neighbours(py: Python<'_>, folder: PathBuf) {
    py.detach(|| neighbours::forget(&folder));
}

/// The table of a sweep's folder as CSV.
#[pyfunction]
pub fn table_of(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    apart(py, || {
        let plan = plan_of(&folder)?;
        let rows: Vec<Row> = plan.designs.iter().map(|entry| Row::read(&folder, &entry.identity)).collect();
        Ok(table::csv(&plan, &rows).map_err(|why| ResultsError::not_representable("table.csv", why))?)
    })
}
