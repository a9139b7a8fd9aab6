//! What hexahedra have in common.
//!
//! The corners:
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
//! Mid-edge nodes 8–19 follow the edges, 20–25 the faces, 26 is the centre.

use super::descriptor::{Face, LatticeCell};
use crate::face::FaceKind;
use crate::kuhn;

/// The edges in the order of their mid-edge nodes.
pub static EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

// Corners, then mid-edges in the order of the corners, then the centre; `r_ξ × r_η` points outwards.
static FACES: [[usize; 9]; 6] = [
    [0, 4, 7, 3, 16, 15, 19, 11, 20],
    [1, 2, 6, 5, 9, 18, 13, 17, 21],
    [0, 1, 5, 4, 8, 17, 12, 16, 22],
    [3, 7, 6, 2, 19, 14, 18, 10, 23],
    [0, 3, 2, 1, 11, 10, 9, 8, 24],
    [4, 5, 6, 7, 12, 13, 14, 15, 25],
];

/// The faces of a family whose faces have the first `count` nodes.
pub const fn faces(kind: FaceKind, count: usize) -> [Face; 6] {
    [
        Face { kind, nodes: FACES[0].split_at(count).0 },
        Face { kind, nodes: FACES[1].split_at(count).0 },
        Face { kind, nodes: FACES[2].split_at(count).0 },
        Face { kind, nodes: FACES[3].split_at(count).0 },
        Face { kind, nodes: FACES[4].split_at(count).0 },
        Face { kind, nodes: FACES[5].split_at(count).0 },
    ]
}

/// Abaqus's faces S1, S2, … as our local face numbers; in its own nodes they are 1-2-3-4, 5-8-7-6, 1-5-6-2, 2-6-7-3, 3-7-8-4, 4-8-5-1.
pub static ABAQUS_FACES: [u8; 6] = [4, 5, 2, 1, 3, 0];

/// A cell is one element.
pub const fn lattice_cell(nodes: fn() -> Vec<[usize; 3]>, nodes_per_cell: [f64; 2]) -> LatticeCell {
    // The faces come in the order of the sides.
    LatticeCell {
        elements: 1,
        nodes,
        facets_on_sides: || std::array::from_fn(|side| vec![(0, side as u8)]),
        nodes_per_cell,
    }
}

/// Places of the first `count` nodes on a lattice cell.
pub fn places(count: usize) -> Vec<[usize; 3]> {
    NODES[..count].iter().map(|x| x.map(|t| (t + 1.0) as usize)).collect()
}

/// Six tetrahedra along Kuhn's paths in each of `parts`³ equal parts of a hexahedron whose first `count` nodes are the corners of these
/// parts.
pub fn tetrahedra(count: usize, parts: usize) -> Vec<[u8; 4]> {
    let local = |place: [usize; 3]| {
        let xi = place.map(|i| 2.0 * i as f64 / parts as f64 - 1.0);
        NODES[..count].iter().position(|node| *node == xi).expect("every corner of a part is a node") as u8
    };
    let corner = |n: usize| [n % parts, n / parts % parts, n / parts / parts];
    (0..parts.pow(3))
        .flat_map(|part| {
            kuhn::node_offsets().map(|offsets| {
                std::array::from_fn(|i| local(std::array::from_fn(|d| corner(part)[d] + offsets[i][d] / 2)))
            })
        })
        .collect()
}

/// Reference coordinates of the nodes of the triquadratic hexahedron; other families have the first of them.
pub static NODES: [[f64; 3]; 27] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
];
