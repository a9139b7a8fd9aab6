//! The surface of a body: where its faces lie, which way they look, what lies beside them.

use crate::mesh::{Facet, Mesh};
use crate::shape;
use crate::vector::{angle_between, cross, distance_to_triangle, dot, norm};

/// Where a face lies at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePlace {
    /// Centre of its area, mm.
    pub centre: [f64; 3],
    /// Mean of its outward unit normal; shorter than 1 where the face is curved.
    pub normal: [f64; 3],
    /// mm².
    pub area: f64,
    /// ⅓ ∫ x·n dA, mm³: summed over a closed surface, the volume in it.
    pub volume: f64,
}

/// The faces of a body's surface, in the order of its elements.
#[derive(Clone, Debug)]
pub struct Skin {
    /// The faces.
    pub facets: Vec<Facet>,
    /// Where each lies.
    pub places: Vec<FacePlace>,
    /// Edges between two faces; where more meet, none of them lie beside each other.
    pub edges: Vec<SkinEdge>,
    /// For every face its edges, by number.
    pub edges_of: Vec<Vec<usize>>,
}

/// An edge between two faces of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkinEdge {
    /// Its ends.
    pub ends: [u32; 2],
    /// The two faces, by their numbers in the skin.
    pub faces: [usize; 2],
}

impl SkinEdge {
    /// The face on the other side.
    pub fn beyond(&self, face: usize) -> usize {
        if self.faces[0] == face { self.faces[1] } else { self.faces[0] }
    }
}

impl Mesh {
    /// Where a face lies at rest.
    pub fn face_place(&self, facet: Facet) -> FacePlace {
        let (kind, nodes) = (self.face_kind(facet), self.facet_nodes(facet));
        let mut place = FacePlace { centre: [0.0; 3], normal: [0.0; 3], area: 0.0, volume: 0.0 };
        for (xi, weight) in (kind.rule)() {
            let at = shape::evaluate_face(kind, xi);
            let (mut x, mut tangents) = ([0.0; 3], [[0.0; 3]; 2]);
            for ((&node, gradient), value) in nodes.iter().zip(&at.gradients).zip(&at.values) {
                for d in 0..3 {
                    let t = self.nodes[node as usize][d];
                    x[d] += value * t;
                    tangents[0][d] += gradient[0] * t;
                    tangents[1][d] += gradient[1] * t;
                }
            }
            let normal = cross(tangents[0], tangents[1]).map(|t| weight * t);
            let area = norm(normal);
            place.area += area;
            place.volume += dot(x, normal) / 3.0;
            for d in 0..3 {
                place.centre[d] += area * x[d];
                place.normal[d] += normal[d];
            }
        }
        let whole = place.area;
        place.centre = place.centre.map(|t| t / whole);
        place.normal = place.normal.map(|t| t / whole);
        place
    }

    /// The body's surface.
    pub fn skin(&self) -> Skin {
        let facets = self.boundary_facets();
        let places = facets.iter().map(|&facet| self.face_place(facet)).collect();
        let mut halves: Vec<([u32; 2], usize)> = Vec::new();
        for (number, &facet) in facets.iter().enumerate() {
            let nodes = self.facet_nodes(facet);
            let ends = self.face_kind(facet).edges().map(|[a, b]| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]);
            halves.extend(ends.map(|ends| (ends, number)));
        }
        halves.sort_unstable();
        let mut edges = Vec::with_capacity(halves.len() / 2);
        let mut edges_of = vec![Vec::new(); facets.len()];
        for meeting in halves.chunk_by(|a, b| a.0 == b.0) {
            let [(ends, one), (_, other)] = *meeting else { continue };
            [one, other].into_iter().for_each(|face| edges_of[face].push(edges.len()));
            edges.push(SkinEdge { ends, faces: [one, other] });
        }
        Skin { facets, places, edges, edges_of }
    }
}

impl Skin {
    /// Angle between the outward normals of the faces at an edge, degrees.
    pub fn angle(&self, edge: &SkinEdge) -> f64 {
        let [one, other] = edge.faces.map(|face| self.places[face].normal);
        angle_between(one, other)
    }

    /// The number of its piece for every face: faces that edges join for which `joins` holds belong to one piece.
    pub fn pieces(&self, joins: impl Fn(&SkinEdge) -> bool) -> Vec<usize> {
        const NONE: usize = usize::MAX;
        let mut of = vec![NONE; self.facets.len()];
        let mut waiting = Vec::new();
        let mut count = 0;
        for first in 0..of.len() {
            if of[first] != NONE {
                continue;
            }
            of[first] = count;
            waiting.push(first);
            while let Some(face) = waiting.pop() {
                for edge in self.edges_of[face].iter().map(|&edge| &self.edges[edge]) {
                    let next = edge.beyond(face);
                    if of[next] == NONE && joins(edge) {
                        of[next] = count;
                        waiting.push(next);
                    }
                }
            }
            count += 1;
        }
        of
    }

    /// The face that is nearest to a point and its distance, mm; faces count as the triangles between their corners.
    pub fn nearest(&self, mesh: &Mesh, point: [f64; 3]) -> Option<(usize, f64)> {
        let distance = |facet: Facet| {
            let (corners, nodes) = (mesh.face_kind(facet).num_corners(), mesh.facet_nodes(facet));
            let x = |i: usize| mesh.nodes[nodes[i] as usize];
            (1..corners - 1).map(|i| distance_to_triangle(point, [x(0), x(i), x(i + 1)])).fold(f64::INFINITY, f64::min)
        };
        let faces = self.facets.iter().map(|&facet| distance(facet)).enumerate();
        faces.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;
    use crate::lattice::Lattice;

    #[test]
    fn the_faces_of_every_family_enclose_the_body() {
        for kind in ElementKind::ALL {
            let mesh = Lattice::uniform([1.0, -2.0, 0.5], [4.0, 1.0, 2.5], [3, 3, 3])
                .mesh(kind, |cell| cell != [1, 1, 1])
                .mesh;
            let skin = mesh.skin();
            let volume: f64 = skin.places.iter().map(|place| place.volume).sum();
            assert!((volume - mesh.volume()).abs() < 1e-12, "{kind:?}: {volume}");
            let area: f64 = skin.places.iter().map(|place| place.area).sum();
            assert!((area - (9.0 + 6.0 + 6.0) * 2.0 * (1.0 + 1.0 / 9.0)).abs() < 1e-12, "{kind:?}: {area}");
            let shells = skin.pieces(|_| true);
            assert_eq!(shells.iter().max(), Some(&1));
            let sides = skin.pieces(|edge| skin.angle(edge) < 1.0);
            assert_eq!(sides.iter().max(), Some(&11), "six outside, six inside");
            let (face, distance) = skin.nearest(&mesh, [4.1, -0.5, 1.5]).unwrap();
            assert!(angle_between(skin.places[face].normal, [1.0, 0.0, 0.0]) < 1e-6 && (distance - 0.1).abs() < 1e-12);
        }
    }
}
