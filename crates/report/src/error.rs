//! Why there is no report.

use pneuflex_post::PostError;

/// A result that cannot be shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReportError {
    /// A file of fields that does not belong to the case.
    #[error("{what} does not fit the mesh of case.toml: it has {found} where {expected} are expected")]
    OtherMesh {
        /// Which part of the file.
        what: String,
        /// What the mesh has.
        expected: String,
        /// What the file has.
        found: String,
    },
    /// A field that is not in its file.
    #[error("there is no field `{0}`")]
    MissingField(String),
    /// A field that has not as many numbers as a field of its name has.
    #[error("the field `{name}` holds {found} numbers instead of {expected}")]
    OtherKind {
        /// Name of the field.
        name: String,
        /// Numbers that a field of this name has.
        expected: usize,
        /// Numbers that it has.
        found: usize,
    },
    /// A number that cannot be shown.
    #[error("{0} holds a number that is not finite")]
    NotFinite(String),
    /// The summary and the fields do not belong together.
    #[error("summary.json has {steps} reached steps, but there are fields of {states}")]
    OtherSteps {
        /// Steps of the summary.
        steps: usize,
        /// States with fields.
        states: usize,
    },
    /// Steps that do not follow each other.
    #[error("the pressures or times of summary.json do not increase from 0")]
    Order,
    /// A quantity that cannot be derived.
    #[error(transparent)]
    Post(#[from] PostError),
    /// Data that cannot be written as JSON.
    #[error("the page's data cannot be written: {0}")]
    Json(String),
}
