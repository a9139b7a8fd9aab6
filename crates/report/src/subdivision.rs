//! Elements as tetrahedra through all their nodes.
//!
//! Each family says how it is divided ([`ElementFamily::tetrahedra`]). Neighbours of one lattice are cut alike on the face they share, so
//! that sections have no cracks. The serendipity hexahedron has no nodes in its faces and is completed to the triquadratic one first
//! ([`crate::body`]).

use pneuflex_mesh::family::ElementFamily;
use pneuflex_mesh::mesh::determinant;

/// Local nodes of a tetrahedron with positive volume.
pub type Tetrahedron = [u8; 4];

/// Local nodes of the tetrahedra that an element is divided into; none for a family that has to be completed first.
pub fn tetrahedra(family: &ElementFamily) -> Vec<Tetrahedron> {
    let mut parts = family.tetrahedra.map_or_else(Vec::new, |tetrahedra| tetrahedra());
    for part in &mut parts {
        if volume(part.map(|n| family.nodes[usize::from(n)])) < 0.0 {
            part.swap(2, 3);
        }
    }
    parts
}

/// Local triangles of every face of an element, those of its tetrahedra, with normals that point out of the element.
pub fn face_triangles(family: &ElementFamily) -> Vec<Vec<[u8; 3]>> {
    let parts = tetrahedra(family);
    (0..family.num_faces())
        .map(|face| {
            let on_face = |n: &u8| family.face_nodes(face).contains(&usize::from(*n));
            let sides = |&[a, b, c, d]: &Tetrahedron| [[a, c, b], [a, b, d], [b, c, d], [a, d, c]];
            parts.iter().flat_map(sides).filter(|triangle| triangle.iter().all(on_face)).collect()
        })
        .collect()
}

/// Signed volume of a tetrahedron.
pub fn volume(corners: [[f64; 3]; 4]) -> f64 {
    let edge = |i: usize| -> [f64; 3] { std::array::from_fn(|d| corners[i][d] - corners[0][d]) };
    determinant(&[edge(1), edge(2), edge(3)]) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::{ElementKind, FaceKind};

    const KINDS: [(ElementKind, usize, f64); 5] = [
        (ElementKind::Hex8, 6, 8.0),
        (ElementKind::Hex27, 48, 8.0),
        (ElementKind::Tet10, 8, 1.0 / 6.0),
        (ElementKind::Tet15, 24, 1.0 / 6.0),
        (ElementKind::Wedge21, 36, 1.0),
    ];

    #[test]
    fn the_parts_fill_the_element_and_use_every_node() {
        for (kind, count, expected) in KINDS {
            let (nodes, parts) = (kind.nodes, tetrahedra(kind.family()));
            assert_eq!(parts.len(), count);
            let volumes: Vec<f64> = parts.iter().map(|part| volume(part.map(|n| nodes[usize::from(n)]))).collect();
            // Equal parts: none overlaps another if together they fill the element.
            assert!(volumes.iter().all(|v| (v - expected / count as f64).abs() < 1e-12), "{kind:?} {volumes:?}");
            let mut used: Vec<u8> = parts.concat();
            used.sort_unstable();
            used.dedup();
            assert_eq!(used.len(), kind.num_nodes());
        }
    }

    #[test]
    fn the_faces_are_a_closed_surface_around_the_element() {
        for (kind, _, expected) in KINDS {
            let nodes = kind.nodes;
            let faces = face_triangles(kind.family());
            for (face, triangles) in faces.iter().enumerate() {
                let expected = match kind.face_kind(face) {
                    FaceKind::Quad4 => 2,
                    FaceKind::Quad9 => 8,
                    FaceKind::Tri7 => 6,
                    _ => 4,
                };
                assert_eq!(triangles.len(), expected, "{kind:?}");
            }
            // Divergence theorem: the cones from the origin to outward triangles add up to the volume.
            let cone = |t: &[u8; 3]| {
                let [a, b, c] = t.map(|n| nodes[usize::from(n)]);
                volume([[0.0; 3], a, b, c])
            };
            let sum: f64 = faces.iter().flatten().map(cone).sum();
            assert!((sum - expected).abs() < 1e-12, "{kind:?} {sum}");
        }
    }
}
