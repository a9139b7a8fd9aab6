//! The report of a run: one HTML page that opens from disk, with the deformed body in three dimensions, plots against pressure or
//! time and the inputs.
//!
//! Data goes in and a text comes out; reading the result folder and writing the page is up to the caller.
//!
//! * [`summary`]: what is read of `summary.json`.
//! * [`state`]: the fields of one pressure or time, from their `.vtu` files; [`stretch`]: those that are in none of them.
//! * [`subdivision`], [`body`], [`skin`]: elements as tetrahedra, the nodes these need, the surface and its edges.
//! * [`regions`]: parts of the body with materials of their own; `parted`: what jumps between them.
//! * [`obstacles`]: rigid bodies in the way, as far as they are drawn.
//! * [`curves`], [`series`]: what is plotted against pressure or time; [`results`]: the same numbers and more as a table;
//!   [`sensitivity`]: what changes one of them most; [`comparison`]: how they differ from measurements.
//! * [`quantise`]: lists of numbers as text with a known error.
//! * [`setup`]: the page of what would be solved, before it is; [`rounds`]: that of a search for a design.
//! * [`page`], [`tables`], [`inputs`], [`assets`]: the page and what it is made of.
//!
//! Units: mm, MPa, pressures in kPa. In the browser, the modules in `assets/js` do the rest; `assets/js/main.js` is the place
//! to start reading.

pub mod assets;
pub mod body;
pub mod comparison;
mod controls;
pub mod curves;
mod error;
pub mod inputs;
mod numbers;
pub mod obstacles;
pub mod page;
mod parted;
mod payload;
pub mod quantise;
mod quantities;
pub mod regions;
mod report;
pub mod results;
pub mod rounds;
pub mod sensitivity;
pub mod series;
pub mod setup;
pub mod skin;
pub mod state;
pub mod stretch;
pub mod subdivision;
pub mod summary;
pub mod tables;
#[cfg(test)]
mod testing;

pub use error::ReportError;
pub use report::Report;

/// The page as the text of an HTML file. The same report always gives the same text.
///
/// # Errors
/// Fields that do not fit the mesh or the summary, or numbers that are not finite.
pub fn render(report: &Report<'_>) -> Result<String, ReportError> {
    let steps = report.summary.reached().count();
    if let Some(states) = report.states.filter(|states| states.len() != steps) {
        return Err(ReportError::OtherSteps { steps, states: states.len() });
    }
    let series = series::of(report)?;
    let data = payload::of(report, &series)?;
    Ok(page::html(report, &data))
}
