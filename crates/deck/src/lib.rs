//! Input decks of other programs as problems.
//!
//! Texts go in, plain data comes out: this crate opens no files (included files come from a function that the caller passes) and
//! solves nothing.
//!
//! * [`syntax`]: the text of an Abaqus or CalculiX `.inp` deck → keywords with their parameters and data lines.
//! * [`inp`]: the meaning of such a deck → a problem with a schedule.
//! * [`feb`]: FEBio's `.feb` files → the same.
//! * [`msh`]: Gmsh's `.msh` files → a mesh with named sets.
//! * [`vtk`], [`vtu`]: legacy `.vtk` and `.vtu` files of VTK → the same.
//! * [`surface`]: surfaces of triangles, `.stl` and `.obj`, and what they bound.
//! * [`report`]: places in files, what is wrong there, what is worth knowing.
//!
//! A deck has no units. It is taken in mm, N, MPa (and tonnes per mm³ for densities).

mod deck;
pub mod feb;
pub mod inp;
mod jacobian;
mod mid_edges;
pub mod msh;
mod raw_mesh;
pub mod report;
pub mod surface;
pub mod syntax;
pub mod vtk;
mod vtk_cells;
pub mod vtu;

pub use deck::{Deck, Extent, Label, Schedule, read, read_extent};
pub use report::{DeckError, Note};
