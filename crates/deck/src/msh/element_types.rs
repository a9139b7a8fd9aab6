//! Gmsh's element types and their order of nodes.

use pneuflex_mesh::ElementKind;

/// An element that fills volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Solid {
    Hex8,
    Hex20,
    Hex27,
    Tet10,
    /// Gets mid-edge nodes.
    Tet4,
}

/// Gmsh's node for each of ours. Both begin with the same corners.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];
const HEX27: [usize; 27] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26];
const TET10: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

impl Solid {
    /// By Gmsh's number of the type; `None` for surfaces, curves and points.
    pub const fn of_type(kind: i32) -> Option<Self> {
        Some(match kind {
            4 => Self::Tet4,
            5 => Self::Hex8,
            11 => Self::Tet10,
            12 => Self::Hex27,
            17 => Self::Hex20,
            _ => return None,
        })
    }

    /// Our family; linear tetrahedra become quadratic ones.
    pub const fn kind(self) -> ElementKind {
        match self {
            Self::Hex8 => ElementKind::Hex8,
            Self::Hex20 => ElementKind::Hex20,
            Self::Hex27 => ElementKind::Hex27,
            Self::Tet10 | Self::Tet4 => ElementKind::Tet10,
        }
    }

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Hex8 => "hexahedra with 8 nodes",
            Self::Hex20 => "hexahedra with 20 nodes",
            Self::Hex27 => "hexahedra with 27 nodes",
            Self::Tet10 => "tetrahedra with 10 nodes",
            Self::Tet4 => "tetrahedra with 4 nodes",
        }
    }

    /// Gmsh's node for each of ours.
    pub const fn order(self) -> &'static [usize] {
        match self {
            Self::Hex8 => HEX27.split_at(8).0,
            Self::Hex20 => &HEX20,
            Self::Hex27 => &HEX27,
            Self::Tet10 => &TET10,
            Self::Tet4 => TET10.split_at(4).0,
        }
    }
}

/// Number of nodes of a supported type: solids, and the surfaces, curves and points that name pieces of their surface.
pub(super) const fn nodes_of_type(kind: i32) -> Option<usize> {
    Some(match kind {
        15 => 1,
        1 => 2,
        2 | 8 => 3,
        3 => 4,
        9 => 6,
        16 => 8,
        10 => 9,
        _ => match Solid::of_type(kind) {
            Some(solid) => solid.order().len(),
            None => return None,
        },
    })
}

/// Number of corners of a surface's or a curve's element; they come first.
pub(super) const fn corners_of_type(kind: i32) -> usize {
    match kind {
        15 => 1,
        1 | 8 => 2,
        2 | 9 => 3,
        _ => 4,
    }
}
