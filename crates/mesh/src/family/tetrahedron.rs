//! What tetrahedra have in common.

/// The edges in the order of their mid-edge nodes 4–9.
pub static EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Faces: corners, then mid-edges in the order of the corners; `r_ξ × r_η` points outwards.
pub static FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]];

/// Abaqus's faces S1, S2, … as our local face numbers; in its own nodes they are 1-2-3, 1-4-2, 2-4-3, 3-4-1.
pub static ABAQUS_FACES: [u8; 4] = [0, 1, 2, 3];
