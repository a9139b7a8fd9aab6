//! A surface made of faces of one family.

use pneuflex_mesh::{FaceKind, Facet, Mesh};

/// Faces with their nodes, oriented so that `r_ξ × r_η` points out of the solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Family of the faces.
    pub kind: FaceKind,
    nodes: Vec<u32>,
}

impl Surface {
    /// The surface made of the given facets, in their order.
    pub fn new(mesh: &Mesh, facets: &[Facet]) -> Self {
        Self {
            kind: mesh.surface_kind(facets),
            nodes: facets.iter().flat_map(|&facet| mesh.facet_nodes(facet)).collect(),
        }
    }

    /// Number of faces.
    pub fn num_faces(&self) -> usize {
        self.nodes.len() / self.kind.num_nodes()
    }

    /// Nodes of a face.
    pub fn face(&self, face: usize) -> &[u32] {
        let n = self.kind.num_nodes();
        &self.nodes[face * n..(face + 1) * n]
    }

    /// Positions of a face's nodes; entries past the number of nodes are zero.
    pub fn face_positions(&self, face: usize, positions: &[[f64; 3]]) -> [[f64; 3]; 9] {
        let mut local = [[0.0; 3]; 9];
        for (slot, &node) in local.iter_mut().zip(self.face(face)) {
            *slot = positions[node as usize];
        }
        local
    }

    /// Axis-aligned bounding box of a face's nodes: \[low, high\].
    ///
    /// Quadratic faces may bulge beyond their nodes by a fraction of their size; callers inflate the box.
    pub fn bounding_box(&self, face: usize, positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for &node in self.face(face) {
            for d in 0..3 {
                bounds[0][d] = bounds[0][d].min(positions[node as usize][d]);
                bounds[1][d] = bounds[1][d].max(positions[node as usize][d]);
            }
        }
        bounds
    }
}
