//! The report of a run: one HTML page that opens from disk, with the deformed body in three dimensions, plots against pressure or
//! time and the inputs.
//!
//! Data goes in and a text comes out; reading the result folder and writing the page is up to the caller.
//!
//! * [`summary`]: what is read of `summary.json`.
//! * [`state`]: the fields of one pressure or time, from their `.vtu` files.
//! * [`subdivision`], [`body`], [`skin`]: elements as tetrahedra, the nodes these need, the surface and its edges.
//! * [`obstacles`]: rigid bodies in the way, as far as they are drawn.
//! * [`series`]: what is plotted against pressure or time; [`results`]: the same numbers and more as a table.
//! * [`quantise`]: lists of numbers as text with a known error.
//! * [`page`], [`tables`], [`inputs`], [`assets`]: the page and what it is made of.
//!
//! Units: mm, MPa, pressures in kPa. In the browser, the modules in `assets/js` do the rest; `assets/js/main.js` is the place
//! to start reading.

pub mod assets;
pub mod body;
pub mod inputs;
pub mod obstacles;
pub mod page;
mod payload;
pub mod quantise;
pub mod results;
pub mod series;
pub mod skin;
pub mod state;
pub mod subdivision;
pub mod summary;
pub mod tables;
#[cfg(test)]
mod testing;

use pneuflex_model::{Clock, Problem};
use pneuflex_post::PostError;

use crate::inputs::Group;
use crate::state::State;
use crate::summary::Summary;

/// What a report is made of.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    /// Title; may be empty.
    pub title: &'a str,
    /// What was solved in a few words: the number of chambers, or the name of a file.
    pub about: &'a str,
    /// The case or the model as it was solved, see [`inputs::groups`].
    pub inputs: &'a [Group],
    /// Whether the problem is one half (y ≥ 0) of a body that is symmetric to y = 0.
    pub mirrored: bool,
    /// The problem that was solved.
    pub problem: &'a Problem,
    /// What the run says of itself.
    pub summary: &'a Summary,
    /// The fields at every landed step, in the order of the summary's; `None` if the run wrote none.
    pub states: Option<&'a [State]>,
}

impl Report<'_> {
    /// How many of the modelled part make the whole body.
    pub fn halves(&self) -> f64 {
        if self.mirrored { 2.0 } else { 1.0 }
    }

    /// Whether there are walls that may touch each other.
    fn has_walls(&self) -> bool {
        self.problem.clock == Clock::Pressure || !self.problem.contact_pairs.is_empty()
    }

    /// Whether there is contact to be shown.
    fn may_touch(&self) -> bool {
        self.has_walls() || !self.problem.obstacles.is_empty()
    }

    /// Whether a support holds the whole body, and not just the modelled half at its plane of symmetry.
    fn holds_whole(&self, support: &str) -> bool {
        !(self.mirrored && support == "symmetry")
    }

    /// What the body is called.
    fn noun(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "actuator",
            Clock::Steps => "body",
        }
    }

    /// What results depend on.
    fn parameter(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "pressure",
            Clock::Steps => "time",
        }
    }

    /// Unit of the parameter; empty for none.
    fn unit(&self) -> &'static str {
        match self.problem.clock {
            Clock::Pressure => "kPa",
            Clock::Steps => "",
        }
    }

    /// A value of the parameter as words, e.g. `35 kPa`.
    fn words(&self, time: f64) -> String {
        match self.problem.clock {
            Clock::Pressure => format!("{} kPa", tables::number(time)),
            Clock::Steps => format!("time {}", tables::number(time)),
        }
    }
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
    #[error("summary.json has {steps} landed steps, but there are fields of {states}")]
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
