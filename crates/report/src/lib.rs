//! The report of a run: one HTML page that opens from disk, with the deformed actuator in three dimensions, plots against
//! pressure and the inputs.
//!
//! Data goes in and a text comes out; reading the result folder and writing the page is up to the caller.
//!
//! * [`summary`]: what is read of `summary.json`.
//! * [`state`]: the fields of one pressure, from their `.vtu` files.
//! * [`subdivision`], [`body`], [`skin`]: elements as tetrahedra, the nodes these need, the surface and its edges.
//! * [`series`]: what is plotted against pressure.
//! * [`quantise`]: lists of numbers as text with a known error.
//! * [`page`], [`tables`], [`inputs`], [`assets`]: the page and what it is made of.
//!
//! Units: mm, MPa, pressures in kPa. In the browser, the modules in `assets/js` do the rest; `assets/js/main.js` is the place
//! to start reading.

pub mod assets;
pub mod body;
pub mod inputs;
pub mod page;
mod payload;
pub mod quantise;
pub mod series;
pub mod skin;
pub mod state;
pub mod subdivision;
pub mod summary;
pub mod tables;
#[cfg(test)]
mod testing;

use pneuflex_model::{Case, Problem};
use pneuflex_post::PostError;

use crate::state::State;
use crate::summary::Summary;

/// What a report is made of.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    /// The case as it was solved.
    pub case: &'a Case,
    /// The problem meshed from it.
    pub problem: &'a Problem,
    /// What the run says of itself.
    pub summary: &'a Summary,
    /// The fields at every landed pressure, in the order of the summary's steps; `None` if the run wrote none.
    pub states: Option<&'a [State]>,
}

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
    #[error("summary.json has {steps} landed pressures, but there are fields of {states}")]
    OtherSteps {
        /// Steps of the summary.
        steps: usize,
        /// States with fields.
        states: usize,
    },
    /// A quantity that cannot be derived.
    #[error(transparent)]
    Post(#[from] PostError),
    /// Data that cannot be written as JSON.
    #[error("the page's data cannot be written: {0}")]
    Json(String),
}

/// The page as the text of an HTML file. The same report always gives the same text.
///
/// # Errors
/// Fields that do not fit the mesh or the summary, or numbers that are not finite.
pub fn render(report: &Report<'_>) -> Result<String, ReportError> {
    let steps = report.summary.landed().count();
    if let Some(states) = report.states.filter(|states| states.len() != steps) {
        return Err(ReportError::OtherSteps { steps, states: states.len() });
    }
    let series = series::of(report)?;
    let data = payload::of(report, &series)?;
    Ok(page::html(report, &data))
}
