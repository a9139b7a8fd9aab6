//! Gmsh's element types and their order of nodes.

use pneuflex_mesh::{ElementKind, FaceKind};

use crate::raw_mesh::Form;

/// An element that fills volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Solid {
    /// Our family.
    kind: ElementKind,
    /// Whether there are the corners alone, which get the other nodes.
    is_linear: bool,
}

/// A point, lines with two and three nodes, and a triangle with three: pieces of the surface of elements that have more nodes, too.
const POINT: i32 = 15;
const LINE2: i32 = 1;
const LINE3: i32 = 8;
const TRI3: i32 = 2;

impl Solid {
    /// By Gmsh's number of the type; `None` for surfaces, curves and points.
    fn of_type(number: i32) -> Option<Self> {
        let is = |kind: &ElementKind| kind.gmsh.number == Some(number) || kind.gmsh.linear_number == Some(number);
        let kind = ElementKind::ALL.into_iter().find(is)?;
        Some(Self { kind, is_linear: kind.gmsh.number != Some(number) })
    }

    /// Gmsh's node for each of ours.
    fn order(self) -> &'static [usize] {
        let order = self.kind.family().gmsh.order;
        if self.is_linear { &order[..self.kind.num_corners()] } else { order }
    }
}

fn face_of_type(number: i32) -> Option<FaceKind> {
    FaceKind::ALL.into_iter().find(|kind| kind.gmsh_type == Some(number))
}

/// Number of nodes of a supported type: solids, and the surfaces, curves and points that name pieces of their surface.
pub(super) fn nodes_of_type(number: i32) -> Option<usize> {
    match number {
        POINT => Some(1),
        LINE2 => Some(2),
        LINE3 | TRI3 => Some(3),
        _ => {
            let face = face_of_type(number).map(|kind| kind.num_nodes());
            face.or_else(|| Solid::of_type(number).map(|solid| solid.order().len()))
        }
    }
}

/// What an element of a supported type is; corners of surfaces and curves come first.
pub(super) fn form_of_type(number: i32) -> Form {
    match (number, Solid::of_type(number)) {
        (_, Some(solid)) => Form::Solid(solid.kind, solid.is_linear),
        (POINT, _) => Form::Piece(1),
        (LINE2 | LINE3, _) => Form::Piece(2),
        (TRI3, _) => Form::Piece(3),
        _ => Form::Piece(face_of_type(number).map_or(4, |kind| kind.num_corners())),
    }
}

/// Nodes of an element of a supported type in our order.
pub(super) fn ordered(number: i32, nodes: Vec<u64>) -> Vec<u64> {
    match Solid::of_type(number) {
        Some(solid) => solid.order().iter().filter_map(|&i| nodes.get(i).copied()).collect(),
        None => nodes,
    }
}
