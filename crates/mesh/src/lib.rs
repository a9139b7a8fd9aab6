//! Meshes of solid finite elements: element families with their shape functions and quadrature,
//! named node and facet sets, and the parametric soft actuator.
//!
//! This crate knows geometry only: no material, no load, no solver. Lengths are in mm.
//!
//! * [`family`]: what every family of elements is: nodes, shape functions, faces, rules, numbering in files; one table each.
//! * [`element`]: the families' names, which stand for their tables.
//! * [`face`]: families of faces with their shape functions.
//! * [`shape`]: shape functions and their gradients.
//! * [`quadrature`]: Gauss rules.
//! * [`mesh`]: the [`Mesh`] itself.
//! * [`Mesh::divided`]: every element divided into eight.
//! * [`Mesh::volume_within`]: the share of a body in a box.
//! * [`Mesh::scaled_jacobians`]: how well elements are shaped.
//! * [`grading`]: element sizes along an axis, small at re-entrant edges.
//! * [`Kinds`]: which family every element is of.
//! * [`lattice`]: structured hexahedra, tetrahedra or wedges on a tensor-product grid from which cells are left out.
//! * [`kuhn`]: the division of a lattice cell into six tetrahedra.
//! * [`testing`]: meshes of several families.
//! * [`vector`]: vectors, boxes and triangles.
//! * [`Mesh::skin`]: the surface with what lies beside its faces; [`Mesh::hollows`]: the hollow spaces behind it.
//! * [`actuator`]: the parametric actuator built on such a lattice.

pub mod actuator;
mod division;
pub mod element;
mod enrichment;
pub mod face;
pub mod family;
pub mod grading;
mod hollows;
mod kinds;
pub mod kuhn;
pub mod lattice;
mod matrix;
pub mod mesh;
mod number_or_list;
mod polynomial;
pub mod quadrature;
mod quality;
pub mod shape;
mod shares;
mod skin;
pub mod testing;
pub mod vector;
mod volume_within;

pub use actuator::{
    Actuator, Chamber, Channel, Cuts, Filling, GeometryError, LENGTHS, LENGTHS_PER_CHAMBER, NotMovable, Part,
    PerChamber, Plan, build_actuator, build_actuator_with,
};
pub use division::{Division, PARTS, Torn};
pub use element::ElementKind;
pub use enrichment::{AddedNode, Place};
pub use face::{FaceKind, Outline, PerFaceKind};
pub use family::ReferenceBody;
pub use grading::MeshSize;
pub use hollows::{Hollow, Mouth, NoMouth};
pub use kinds::{Kinds, PerKind};
pub use mesh::{Facet, Mesh};
pub use number_or_list::{NumberOrList, number_or_list};
pub use skin::{FacePlace, Skin, SkinEdge};
