//! Results for other programs, and beside measurements.

use std::path::PathBuf;

use pneuflex::compare::{Choices, Fit, Line};
use pneuflex::export::Format;
use pneuflex::export_request::Request;
use pneuflex::picture::{Colours, view_named};
use pneuflex::{Error, InputError, json, on_threads};
use pyo3::prelude::*;
use serde::Deserialize;

use crate::error::apart;

/// A request as the package's keywords are.
#[derive(Deserialize)]
struct Asked {
    at: Option<f64>,
    colour: Option<String>,
    range: Option<[f64; 2]>,
    view: Option<String>,
    width: Option<f64>,
    pictures: Option<usize>,
    wall: Option<f64>,
}

/// Writes results of a folder in a format, as asked for in JSON; returns the files.
#[pyfunction]
pub fn export(py: Python<'_>, folder: PathBuf, to: &str, out: PathBuf, asked: &str) -> PyResult<Vec<PathBuf>> {
    apart(py, || {
        let wrong = |error: serde_json::Error| InputError::new(format!("a keyword of another type: {error}"));
        let Asked { at, colour, range, view, width, pictures, wall } = serde_json::from_str(asked).map_err(wrong)?;
        let colour = known("colour", colour, Colours::named, "von-mises, displacement, contact, none")?;
        let view = known("view", view, view_named, "iso, section, side")?;
        let request = Request { at, colour, range, view, width, pictures, wall };
        let format = Format::named(to, &request).map_err(|error| InputError::new(error.to_string()))?;
        on_threads(Some(1), || pneuflex::export::export(&folder, &format, &out))
    })
}

/// Compares a folder with a table of measurements; returns the differences as JSON and the picture as SVG.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    folder: PathBuf,
    table: PathBuf,
    line: Option<String>,
    fit: Vec<String>,
) -> PyResult<(String, String)> {
    apart(py, || {
        let of_name = |name: &str| match name {
            "bottom" => Some(Line::Bottom),
            "outline" => Some(Line::Outline),
            _ => None,
        };
        let line = known("line", line, of_name, "bottom, outline")?;
        if let Some(other) = fit.iter().find(|name| !["scale", "rotation", "offset"].contains(&&name[..])) {
            return Err(InputError::new(format!("fit: {other}; allowed: scale, rotation, offset")).into());
        }
        let has = |name: &str| fit.iter().any(|found| found == name);
        let fit = Fit { scale: has("scale"), rotation: has("rotation"), offset: has("offset") };
        let (found, _) = pneuflex::compare::compare(&folder, &table, Choices { line, fit })?;
        let text = json::pretty(&found).map_err(|error| Error::from(InputError::new(error)))?;
        Ok((text, found.picture))
    })
}

/// What a name stands for, if one is given.
fn known<T>(
    key: &str,
    name: Option<String>,
    of: impl Fn(&str) -> Option<T>,
    allowed: &str,
) -> Result<Option<T>, InputError> {
    let find = |name: String| of(&name).ok_or_else(|| InputError::new(format!("{key}: {name}; allowed: {allowed}")));
    name.map(find).transpose()
}
