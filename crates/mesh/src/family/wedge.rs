//! What wedges have in common: a triangle times a line.
//!
//! The corners:
//!
//! ```text
//!        3─────────5
//!        │╲       ╱│      0 → 1 is ξ, 0 → 2 is η,
//!        │  ╲   ╱  │      0 → 3 is ζ, from −1 to 1
//!        │    4    │
//!        0 ─ ─│─ ─ 2
//!          ╲  │  ╱
//!            ╲│╱
//!             1
//! ```
//!
//! Mid-edge nodes 6–14 follow the edges: those of the lower triangle, of the upper one, and those between the two.

use super::descriptor::{AbaqusTypes, LatticeCell};
use crate::face::FaceShape;
use crate::polynomial::quadratic_line;

/// The edges in the order of their mid-edge nodes.
pub static EDGES: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];

/// The triangular faces: corners, then mid-edges in the order of the corners; `r_ξ × r_η` points outwards.
pub static TRIANGLES: [[usize; 6]; 2] = [[0, 2, 1, 8, 7, 6], [3, 4, 5, 9, 10, 11]];

/// The quadrilateral ones.
pub static QUADRILATERALS: [[usize; 8]; 3] =
    [[0, 1, 4, 3, 6, 13, 9, 12], [1, 2, 5, 4, 7, 14, 10, 13], [2, 0, 3, 5, 8, 12, 11, 14]];

/// Types of Abaqus; its faces S1 to S5, in its own nodes 1-2-3, 4-6-5, 1-4-5-2, 2-5-6-3, 3-6-4-1, come in our order.
pub const ABAQUS: AbaqusTypes =
    AbaqusTypes { names: &["C3D15", "C3D15H"], linear_names: &["C3D6", "C3D6H"], faces: &[0, 1, 2, 3, 4] };

/// Two of a cell, on either side of the diagonal from the lowest to the highest corner of its lower and upper side.
pub const LATTICE: LatticeCell = LatticeCell {
    elements: 2,
    nodes: || {
        let triangles =
            [[[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]], [[0, 0], [2, 2], [0, 2], [1, 1], [1, 2], [0, 1]]];
        let place = |triangle: [[usize; 2]; 6], (at, level): (usize, usize)| [triangle[at][0], triangle[at][1], level];
        triangles.iter().flat_map(|&triangle| PLACES.map(|node| place(triangle, node))).collect()
    },
    facets_on_sides: || {
        [vec![(1, 4)], vec![(0, 3)], vec![(0, 2)], vec![(1, 3)], vec![(0, 0), (1, 0)], vec![(0, 1), (1, 1)]]
    },
    nodes_per_cell: [8.0, 23.0],
};

/// Where corners and mid-edge nodes are: the node of the triangle with six nodes, and the level, 0, 1 or 2 for ζ = −1, 0, 1.
pub const PLACES: [(usize, usize); 15] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (0, 2),
    (1, 2),
    (2, 2),
    (3, 0),
    (4, 0),
    (5, 0),
    (3, 2),
    (4, 2),
    (5, 2),
    (0, 1),
    (1, 1),
    (2, 1),
];

/// Functions of a triangle times those of a line with three nodes; `places` are the nodes, as in [`PLACES`].
pub fn product(
    triangle: &FaceShape,
    z: f64,
    places: impl IntoIterator<Item = (usize, usize)>,
    values: &mut [f64],
    gradients: &mut [[f64; 3]],
) {
    let line = quadratic_line(z);
    for (node, (at, level)) in places.into_iter().enumerate() {
        let ([along_x, along_y], value, [w, slope, _]) = (triangle.gradients[at], triangle.values[at], line[level]);
        values[node] = value * w;
        gradients[node] = [along_x * w, along_y * w, value * slope];
    }
}

const THIRD: f64 = 1.0 / 3.0;

/// Reference coordinates of the nodes of the richest wedge; the one without nodes in its faces and inside has the first 15.
pub static NODES: [[f64; 3]; 21] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, -1.0],
    [0.5, 0.5, -1.0],
    [0.0, 0.5, -1.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [THIRD, THIRD, -1.0],
    [THIRD, THIRD, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [THIRD, THIRD, 0.0],
];
