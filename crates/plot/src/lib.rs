//! Line charts and pictures of deformed bodies.
//!
//! * [`chart`]: curves, scatter and bars over one or two axes.
//! * [`picture`]: deformed bodies from any side, coloured by a nodal field, with contact marked.
//! * [`drawing`]: what both are made of: shapes on a sheet, written as SVG or PNG.
//!
//! It knows what is drawn from `pneuflex_post` and nothing of solvers, and touches neither files nor terminal.

pub mod chart;
pub mod drawing;
mod error;
pub mod picture;
#[cfg(test)]
mod testing;

pub use error::PlotError;
