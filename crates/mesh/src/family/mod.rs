//! Families of solid elements. What a family is stands in one [`ElementFamily`] of a file of its own; everything else reads these tables.

mod descriptor;
pub mod hex20;
pub mod hex27;
pub mod hex8;
mod hexahedron;
pub mod tet10;
pub mod tet15;
pub(crate) mod tetrahedron;
mod wedge;
pub mod wedge15;
pub mod wedge18;
pub mod wedge21;

pub use descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, LatticeCell, ReferenceBody};
