//! Gmsh's `.msh` files of versions 4.1 and 2.2, text or binary → a mesh with named sets.
//!
//! Physical groups become sets: of volumes, element sets; of surfaces, facet sets and node sets; of curves and points, node sets. Groups
//! without a name are called after their dimension and tag, as in `surface_5`.
//!
//! The `mshio` library was not used: it panics on files with no elements and on sizes of numbers that it does not know, skips the names of
//! groups, and forgets the tags of nodes in files whose tags have no gaps.

mod cursor;
mod element_types;
mod sections;

use crate::raw_mesh::RawMesh;
use crate::report::DeckError;
use sections::Sections;

pub use crate::raw_mesh::MeshFile;

/// Reads a `.msh` file called `name` from its bytes.
///
/// # Errors
/// What is wrong or not supported, by line; binary numbers are not counted in lines.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<DeckError>> {
    RawMesh::finish(Sections::read(bytes).map(Sections::raw), name)
}
