//! Element families: node numbering and faces.
//!
//! Node numbering follows VTK, so that output files need no permutation. The hexahedron's corners:
//!
//! ```text
//!          7────────6          ζ
//!         ╱│       ╱│          │  η
//!        4────────5 │          │ ╱
//!        │ 3──────│─2          │╱
//!        │╱       │╱           └──── ξ
//!        0────────1
//! ```
//!
//! Mid-edge nodes 8–19 follow the edges 01 12 23 30 | 45 56 67 74 | 04 15 26 37; hex27 adds the face
//! centres 20–25 (−ξ, +ξ, −η, +η, −ζ, +ζ) and the centre 26. The tetrahedron has corners 0–3 and
//! mid-edge nodes on 01 12 20 03 13 23.

use serde::{Deserialize, Serialize};

/// Family of solid elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ElementKind {
    /// Trilinear hexahedron.
    Hex8,
    /// Serendipity quadratic hexahedron.
    Hex20,
    /// Full triquadratic hexahedron.
    Hex27,
    /// Quadratic tetrahedron.
    Tet10,
}

/// Family of faces, the two-dimensional trace of an [`ElementKind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FaceKind {
    /// Bilinear quadrilateral.
    Quad4,
    /// Serendipity quadratic quadrilateral.
    Quad8,
    /// Biquadratic quadrilateral.
    Quad9,
    /// Quadratic triangle.
    Tri6,
}

/// The edges of the hexahedron in the order of its mid-edge nodes 8–19.
pub const HEX_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The edges of the tetrahedron in the order of its mid-edge nodes 4–9.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

// Corners, then mid-edges in the order of the corners, then the centre; `r_ξ × r_η` points outwards.
const HEX_FACES: [[usize; 9]; 6] = [
    [0, 4, 7, 3, 16, 15, 19, 11, 20],
    [1, 2, 6, 5, 9, 18, 13, 17, 21],
    [0, 1, 5, 4, 8, 17, 12, 16, 22],
    [3, 7, 6, 2, 19, 14, 18, 10, 23],
    [0, 3, 2, 1, 11, 10, 9, 8, 24],
    [4, 5, 6, 7, 12, 13, 14, 15, 25],
];
const TET_FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]];

impl ElementKind {
    /// Number of nodes of one element.
    pub const fn num_nodes(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Hex20 => 20,
            Self::Hex27 => 27,
            Self::Tet10 => 10,
        }
    }

    /// Number of corner nodes; corners come first in the numbering.
    pub const fn num_corners(self) -> usize {
        match self {
            Self::Tet10 => 4,
            _ => 8,
        }
    }

    /// Number of faces of one element.
    pub const fn num_faces(self) -> usize {
        match self {
            Self::Tet10 => 4,
            _ => 6,
        }
    }

    /// Family of the element's faces.
    pub const fn face_kind(self) -> FaceKind {
        match self {
            Self::Hex8 => FaceKind::Quad4,
            Self::Hex20 => FaceKind::Quad8,
            Self::Hex27 => FaceKind::Quad9,
            Self::Tet10 => FaceKind::Tri6,
        }
    }

    /// Local nodes of face `face`, numbered so that `r_ξ × r_η` points out of the element.
    ///
    /// # Panics
    /// If `face >= self.num_faces()`.
    pub fn face_nodes(self, face: usize) -> &'static [usize] {
        match self {
            Self::Tet10 => &TET_FACES[face],
            _ => &HEX_FACES[face][..self.face_kind().num_nodes()],
        }
    }

    /// Edges as pairs of corners, in the order of the mid-edge nodes.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Tet10 => &TET_EDGES,
            _ => &HEX_EDGES,
        }
    }

    /// Reference coordinates of the nodes: hexahedra on [−1, 1]³, the tetrahedron on the unit simplex.
    pub fn reference_nodes(self) -> Vec<[f64; 3]> {
        let corners: Vec<[f64; 3]> = match self {
            Self::Tet10 => vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            _ => vec![
                [-1.0, -1.0, -1.0],
                [1.0, -1.0, -1.0],
                [1.0, 1.0, -1.0],
                [-1.0, 1.0, -1.0],
                [-1.0, -1.0, 1.0],
                [1.0, -1.0, 1.0],
                [1.0, 1.0, 1.0],
                [-1.0, 1.0, 1.0],
            ],
        };
        let mut nodes = corners.clone();
        if self.num_nodes() > self.num_corners() {
            nodes.extend(
                self.edges().iter().map(|&[a, b]| std::array::from_fn(|i| 0.5 * (corners[a][i] + corners[b][i]))),
            );
        }
        if self == Self::Hex27 {
            nodes.extend([
                [-1.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, -1.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, -1.0],
                [0.0, 0.0, 1.0],
                [0.0, 0.0, 0.0],
            ]);
        }
        nodes
    }

    /// Cell type number of the VTK file formats.
    pub const fn vtk_cell_type(self) -> u8 {
        match self {
            Self::Hex8 => 12,
            Self::Hex20 => 25,
            Self::Hex27 => 29,
            Self::Tet10 => 24,
        }
    }

    /// Number of elements that one lattice cell is divided into.
    pub const fn elements_per_cell(self) -> usize {
        match self {
            Self::Tet10 => crate::kuhn::TETRAHEDRA,
            _ => 1,
        }
    }

    /// Whether nodes sit on mid-edges, so that edges may be curved.
    pub const fn is_quadratic(self) -> bool {
        !matches!(self, Self::Hex8)
    }
}

impl FaceKind {
    /// Number of nodes of one face: corners, then mid-edges, then the centre.
    pub const fn num_nodes(self) -> usize {
        match self {
            Self::Quad4 => 4,
            Self::Quad8 => 8,
            Self::Quad9 => 9,
            Self::Tri6 => 6,
        }
    }

    /// Number of corners.
    pub const fn num_corners(self) -> usize {
        match self {
            Self::Tri6 => 3,
            _ => 4,
        }
    }

    /// Reference coordinates of the face's centre.
    pub const fn centre(self) -> [f64; 2] {
        match self {
            Self::Tri6 => [1.0 / 3.0, 1.0 / 3.0],
            _ => [0.0, 0.0],
        }
    }

    /// Area of the reference face.
    pub const fn reference_area(self) -> f64 {
        match self {
            Self::Tri6 => 0.5,
            _ => 4.0,
        }
    }

    /// Cell type number of the VTK file formats.
    pub const fn vtk_cell_type(self) -> u8 {
        match self {
            Self::Quad4 => 9,
            Self::Quad8 => 23,
            Self::Quad9 => 28,
            Self::Tri6 => 22,
        }
    }
}
