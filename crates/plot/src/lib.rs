//! Line charts and pictures of deformed bodies.
//!
//! * [`chart`]: curves and scatter over axes; [`tornado`]: bars.
//! * [`picture`]: deformed bodies from any side, coloured by a nodal field, with contact marked.
//! * [`drawing`]: what both are made of: shapes on a sheet, written as SVG or PNG.
//!
//! It knows what is drawn from `pneuflex_post` and nothing of solvers, and touches neither files nor terminal.

mod axis;
pub mod chart;
pub mod drawing;
mod error;
pub mod picture;
#[cfg(test)]
mod testing;
pub mod tornado;

pub use error::PlotError;
