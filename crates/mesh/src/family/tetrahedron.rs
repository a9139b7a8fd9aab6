//! What tetrahedra have in common.

use super::descriptor::Face;
use crate::face::FaceKind;

/// The edges in the order of their mid-edge nodes 4–9.
pub static EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Faces: corners, then mid-edges in the order of the corners, then the centre; `r_ξ × r_η` points outwards.
pub static FACES: [[usize; 7]; 4] =
    [[0, 2, 1, 6, 5, 4, 10], [0, 1, 3, 4, 8, 7, 11], [1, 2, 3, 5, 9, 8, 12], [0, 3, 2, 7, 9, 6, 13]];

/// The faces of a family whose faces have the first `count` nodes.
pub const fn faces(kind: FaceKind, count: usize) -> [Face; 4] {
    [
        Face { kind, nodes: FACES[0].split_at(count).0 },
        Face { kind, nodes: FACES[1].split_at(count).0 },
        Face { kind, nodes: FACES[2].split_at(count).0 },
        Face { kind, nodes: FACES[3].split_at(count).0 },
    ]
}

/// Abaqus's faces S1, S2, … as our local face numbers; in its own nodes they are 1-2-3, 1-4-2, 2-4-3, 3-4-1.
pub static ABAQUS_FACES: [u8; 4] = [0, 1, 2, 3];
