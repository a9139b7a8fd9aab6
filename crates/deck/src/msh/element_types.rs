//! Gmsh's element types and their order of nodes.

use pneuflex_mesh::{ElementKind, FaceKind};

/// An element that fills volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Solid {
    /// Our family.
    pub kind: ElementKind,
    /// Whether there are the corners alone, which get the other nodes.
    pub is_linear: bool,
}

/// A point, lines with two and three nodes, and a triangle with three: pieces of the surface of elements that have more nodes, too.
const POINT: i32 = 15;
const LINE2: i32 = 1;
const LINE3: i32 = 8;
const TRI3: i32 = 2;

impl Solid {
    /// By Gmsh's number of the type; `None` for surfaces, curves and points.
    pub fn of_type(number: i32) -> Option<Self> {
        let is = |kind: &ElementKind| kind.gmsh.number == Some(number) || kind.gmsh.linear_number == Some(number);
        let kind = ElementKind::ALL.into_iter().find(is)?;
        Some(Self { kind, is_linear: kind.gmsh.number != Some(number) })
    }

    /// Gmsh's node for each of ours.
    pub fn order(self) -> &'static [usize] {
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

/// Number of corners of a surface's or a curve's element; they come first.
pub(super) fn corners_of_type(number: i32) -> usize {
    match number {
        POINT => 1,
        LINE2 | LINE3 => 2,
        TRI3 => 3,
        _ => face_of_type(number).map_or(4, |kind| kind.num_corners()),
    }
}
