//! A surface made of faces, and points on them.

use std::ops::Range;

use pneuflex_mesh::{FaceKind, Facet, Mesh, PerFaceKind, shape};

use crate::projection::{FaceGeometry, face_geometry, unit_normal};

/// Faces with their nodes, oriented so that `r_ξ × r_η` points out of the solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    kinds: Vec<FaceKind>,
    nodes: Vec<u32>,
    /// Where the nodes of every face begin, and where the last one's end.
    starts: Vec<usize>,
}

impl Surface {
    /// The surface made of the given facets, in their order.
    pub fn new(mesh: &Mesh, facets: &[Facet]) -> Self {
        let (mut nodes, mut starts) = (Vec::new(), vec![0]);
        for &facet in facets {
            nodes.extend(mesh.facet_nodes(facet));
            starts.push(nodes.len());
        }
        Self { kinds: facets.iter().map(|&facet| mesh.face_kind(facet)).collect(), nodes, starts }
    }

    /// Number of faces.
    pub fn num_faces(&self) -> usize {
        self.kinds.len()
    }

    /// Family of a face.
    pub fn kind(&self, face: usize) -> FaceKind {
        self.kinds[face]
    }

    /// Nodes of a face.
    pub fn face(&self, face: usize) -> &[u32] {
        &self.nodes[self.starts[face]..self.starts[face + 1]]
    }

    /// Position and derivatives of a face at a reference point.
    pub fn geometry(&self, face: usize, xi: [f64; 2], positions: &[[f64; 3]]) -> FaceGeometry {
        let kind = self.kinds[face];
        face_geometry(&self.face_positions(face, positions)[..kind.num_nodes()], &shape::evaluate_face(kind, xi))
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

/// Points of a surface, face by face: those of a rule for the face's family.
#[derive(Clone, Debug)]
pub(crate) struct FacePoints {
    rules: PerFaceKind<Vec<([f64; 2], f64)>>,
    /// Number of the first point of every face, and how many there are in all.
    starts: Vec<usize>,
    /// Area at rest that every point stands for, mm².
    pub areas: Vec<f64>,
}

impl FacePoints {
    /// The points of a surface with its nodes at `nodes` at rest; areas are multiplied by `share`.
    pub fn of(
        surface: &Surface,
        rule: impl FnMut(FaceKind) -> Vec<([f64; 2], f64)>,
        nodes: &[[f64; 3]],
        share: f64,
    ) -> Self {
        let rules = PerFaceKind::new(rule);
        let (mut starts, mut areas) = (vec![0], Vec::new());
        for face in 0..surface.num_faces() {
            let area = |&(xi, weight): &([f64; 2], f64)| {
                share * weight * unit_normal(&surface.geometry(face, xi, nodes).tangents).1
            };
            areas.extend(rules[surface.kind(face)].iter().map(area));
            starts.push(areas.len());
        }
        Self { rules, starts, areas }
    }

    /// Reference points and weights on faces of a family.
    pub fn rule(&self, kind: FaceKind) -> &[([f64; 2], f64)] {
        &self.rules[kind]
    }

    /// Numbers of a face's points.
    pub fn of_face(&self, face: usize) -> Range<usize> {
        self.starts[face]..self.starts[face + 1]
    }
}
