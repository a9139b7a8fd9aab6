//! Values out of range, with the keys that they are written under.

use std::fmt;

use pneuflex_mesh::GeometryError;

/// A value out of range; names the key as written in the case file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} is out of range: {allowed}")]
pub struct CaseError {
    /// Dotted key, e.g. `mesh.size`; entries of a list by their number from 0, e.g. `probe[1].at`.
    pub key: String,
    /// The offending value as text.
    pub value: String,
    /// What would be allowed.
    pub allowed: String,
}

impl From<GeometryError> for CaseError {
    fn from(error: GeometryError) -> Self {
        Self { key: format!("actuator.{}", error.key), value: error.value.to_string(), allowed: error.allowed }
    }
}

/// Values found out of range.
#[derive(Default)]
pub(crate) struct Problems(pub(crate) Vec<CaseError>);

impl Problems {
    pub(crate) fn add(&mut self, key: &str, value: &dyn fmt::Debug, allowed: &str) {
        self.0.push(CaseError { key: key.into(), value: format!("{value:?}"), allowed: allowed.into() });
    }

    pub(crate) fn unless_positive(&mut self, key: &str, value: f64, unit: &str) {
        if !(value.is_finite() && value > 0.0) {
            self.add(key, &value, &format!("must be a finite number greater than 0{unit}"));
        }
    }
}
