//! Kuhn's division of the cube into six tetrahedra.
//!
//! Every permutation (a, b, c) of the axes is a path along the cube's edges from its lowest to its highest corner: first
//! along a, then b, then c. The four corners on the path span one tetrahedron; the six together fill the cube (Kuhn 1960,
//! *IBM J. Res. Dev.* 4; Freudenthal 1942). On every face they cut along the diagonal from the face's lowest to its
//! highest corner, so cubes that are translates of each other conform, and facing walls are cut alike.
//!
//! The tetrahedra's 19 edges are the cube's 12, its 6 face diagonals and 1 body diagonal: their midpoints and the corners
//! are the 27 nodes of the triquadratic hexahedron.

use crate::family::tetrahedron::{EDGES, FACES};

/// Tetrahedra per cube.
pub const TETRAHEDRA: usize = 6;

/// Axes in the order in which the paths follow them. Lexicographic, so that the tetrahedra with a face in the cube's
/// lower and those with one in its upper side along an axis come in the same order of their triangles.
const PATHS: [[usize; 3]; TETRAHEDRA] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// Positions (0, 1 or 2 along each axis) of the ten nodes of every tetrahedron on the cube with halved edges.
pub fn node_offsets() -> [[[usize; 3]; 10]; TETRAHEDRA] {
    PATHS.map(|[a, b, c]| {
        let mut corners = [[0; 3]; 4];
        corners[1][a] = 2;
        corners[2] = corners[1];
        corners[2][b] = 2;
        corners[3] = [2; 3];
        // An odd permutation turns the path the other way round.
        let is_even = (b + 3 - a) % 3 == 1 && (c + 3 - b) % 3 == 1;
        if !is_even {
            corners.swap(1, 2);
        }
        let mut nodes = [[0; 3]; 10];
        nodes[..4].copy_from_slice(&corners);
        for (node, [p, q]) in nodes[4..].iter_mut().zip(EDGES) {
            *node = std::array::from_fn(|d| (corners[p][d] + corners[q][d]) / 2);
        }
        nodes
    })
}

/// The two faces on every side (−x, +x, −y, +y, −z, +z) of the cube: tetrahedron and its local face.
pub fn faces_on_sides() -> [[(usize, u8); 2]; 6] {
    let offsets = node_offsets();
    std::array::from_fn(|side| {
        let (axis, position) = (side / 2, 2 * (side % 2));
        let mut found = offsets.iter().enumerate().flat_map(|(tetrahedron, nodes)| {
            (0..4_u8)
                .filter(move |&face| FACES[face as usize][..6].iter().all(|&n| nodes[n][axis] == position))
                .map(move |face| (tetrahedron, face))
        });
        std::array::from_fn(|_| found.next().expect("two of Kuhn's tetrahedra have a face on each side"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_nodes_are_those_of_the_triquadratic_hexahedron() {
        let nodes: BTreeSet<[usize; 3]> = node_offsets().into_iter().flatten().collect();
        assert_eq!(nodes.len(), 27);
    }

    #[test]
    fn the_tetrahedra_are_equal_parts_of_the_cube_and_turned_alike() {
        for nodes in node_offsets() {
            let edge =
                |i: usize| -> [f64; 3] { std::array::from_fn(|d| (nodes[i][d] as f64 - nodes[0][d] as f64) / 2.0) };
            assert_eq!(crate::matrix::determinant(&[edge(1), edge(2), edge(3)]), 1.0);
        }
    }

    /// Corners of a side's triangles, without the axis across it, in the order of the tetrahedra.
    #[test]
    fn opposite_sides_are_cut_alike_and_listed_in_the_same_order() {
        let offsets = node_offsets();
        let sides = faces_on_sides();
        for axis in 0..3 {
            let triangles = |side: usize| {
                sides[side].map(|(tetrahedron, face)| -> BTreeSet<[usize; 2]> {
                    let corners = &FACES[face as usize][..3];
                    let across = |n: usize| {
                        let x = offsets[tetrahedron][n];
                        [x[(axis + 1) % 3], x[(axis + 2) % 3]]
                    };
                    corners.iter().map(|&n| across(n)).collect()
                })
            };
            assert_eq!(triangles(2 * axis), triangles(2 * axis + 1));
            assert!(triangles(2 * axis).iter().all(|t| t.contains(&[0, 0]) && t.contains(&[2, 2])));
        }
    }
}
