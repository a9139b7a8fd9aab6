//! Shares of nodes in what is spread evenly over a set of them.

use std::collections::BTreeMap;

use crate::face::FaceKind;
use crate::mesh::{Facet, Mesh, determinant};
use crate::shape;
use crate::vector::{cross, norm};

/// Gauss's rule with three points for integrals along an edge.
const LINE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// A part of a mesh and ∫ N over it for every of its nodes.
type Piece = Vec<(u32, f64)>;

/// The parts of a kind all of whose nodes belong to a set.
type Within = fn(&Mesh, &[bool]) -> Vec<Piece>;

impl Mesh {
    /// Shares, summing to 1, of nodes in what is spread evenly over them: ∫ N / ∫ 1 over all elements whose nodes are all among them, then
    /// over faces (those of the surface first), then over edges. Nodes of several kinds divide the whole by their number, and those that
    /// belong to no complete element, face or edge get equal shares. Corners of quadratic faces may have no share, or a negative one.
    pub fn shares(&self, nodes: &[u32]) -> Vec<f64> {
        let mut shares = vec![0.0; self.num_nodes()];
        let mut rest = vec![false; self.num_nodes()];
        nodes.iter().for_each(|&node| rest[node as usize] = true);
        let count = |rest: &[bool]| rest.iter().filter(|is_left| **is_left).count();
        let each = 1.0 / count(&rest).max(1) as f64;
        let pieces: [Within; 4] = [Self::elements_within, Self::surface_within, Self::faces_within, Self::edges_within];
        for within in pieces {
            let left = count(&rest);
            if left == 0 {
                break;
            }
            let found = within(self, &rest);
            let whole: f64 = found.iter().flatten().map(|(_, weight)| weight).sum();
            if !(whole > 0.0 && whole.is_finite()) {
                continue;
            }
            found.iter().flatten().for_each(|&(node, _)| rest[node as usize] = false);
            let group = each * (left - count(&rest)) as f64;
            for &(node, weight) in found.iter().flatten() {
                shares[node as usize] += group * weight / whole;
            }
        }
        for (share, is_left) in shares.iter_mut().zip(&rest) {
            *share += if *is_left { each } else { 0.0 };
        }
        nodes.iter().map(|&node| shares[node as usize]).collect()
    }

    /// Nodes of some faces in ascending order with their shares, summing to 1, in what is spread evenly over the faces: ∫ N dA / ∫ dA.
    pub fn shares_of_faces(&self, facets: &[Facet]) -> Piece {
        let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
        for (node, weight) in facets.iter().flat_map(|&facet| self.face_weights(facet)) {
            *sums.entry(node).or_default() += weight;
        }
        let whole: f64 = sums.values().sum();
        sums.into_iter().map(|(node, weight)| (node, weight / whole)).collect()
    }

    /// Faces of a named surface; those of the body's surface all of whose nodes belong to the node set of that name where there is none.
    pub fn faces_named(&self, name: &str) -> Vec<Facet> {
        let facets = self.facet_set(name);
        let nodes = self.node_set(name);
        if !facets.is_empty() || nodes.is_empty() {
            return facets.to_vec();
        }
        let mut is_member = vec![false; self.num_nodes()];
        nodes.iter().for_each(|&node| is_member[node as usize] = true);
        self.boundary_facets().into_iter().filter(|&facet| all(&self.facet_nodes(facet), &is_member)).collect()
    }

    /// ∫ N dA for every node of a face at rest, mm².
    pub fn face_weights(&self, facet: Facet) -> Piece {
        let (kind, nodes): (FaceKind, _) = (self.face_kind(facet), self.facet_nodes(facet));
        let mut weights = vec![0.0; nodes.len()];
        for (xi, weight) in (kind.rule)() {
            let shape = shape::evaluate_face(kind, xi);
            let mut tangents = [[0.0; 3]; 2];
            for (&node, gradient) in nodes.iter().zip(&shape.gradients) {
                for d in 0..3 {
                    tangents[0][d] += gradient[0] * self.nodes[node as usize][d];
                    tangents[1][d] += gradient[1] * self.nodes[node as usize][d];
                }
            }
            let area = weight * norm(cross(tangents[0], tangents[1]));
            weights.iter_mut().zip(&shape.values).for_each(|(sum, value)| *sum += value * area);
        }
        nodes.into_iter().zip(weights).collect()
    }

    fn elements_within(&self, set: &[bool]) -> Vec<Piece> {
        let rules = self.per_kind(|kind| {
            let rule = (kind.volume_rule)().into_iter();
            rule.map(|(xi, w)| (shape::tabulate(kind, xi), w)).collect::<Vec<_>>()
        });
        let weights = |element: usize| {
            let nodes = self.element(element);
            let mut piece: Piece = nodes.iter().map(|&node| (node, 0.0)).collect();
            for ((values, gradients), weight) in &rules[self.kind_of(element)] {
                let volume = weight * determinant(&self.jacobian(element, gradients));
                piece.iter_mut().zip(values).for_each(|((_, sum), value)| *sum += value * volume);
            }
            piece
        };
        (0..self.num_elements()).filter(|&element| all(self.element(element), set)).map(weights).collect()
    }

    fn surface_within(&self, set: &[bool]) -> Vec<Piece> {
        let facets = self.boundary_facets().into_iter().filter(|&facet| all(&self.facet_nodes(facet), set));
        facets.map(|facet| self.face_weights(facet)).collect()
    }

    /// Faces inside of the body, each once.
    fn faces_within(&self, set: &[bool]) -> Vec<Piece> {
        let mut faces: BTreeMap<Vec<u32>, Facet> = BTreeMap::new();
        for facet in (0..self.num_elements() as u32).flat_map(|element| self.facets_of(element)) {
            let mut nodes = self.facet_nodes(facet);
            if all(&nodes, set) {
                nodes.sort_unstable();
                faces.entry(nodes).or_insert(facet);
            }
        }
        faces.into_values().map(|facet| self.face_weights(facet)).collect()
    }

    fn edges_within(&self, set: &[bool]) -> Vec<Piece> {
        let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for facet in (0..self.num_elements() as u32).flat_map(|element| self.facets_of(element)) {
            let (kind, nodes) = (self.face_kind(facet), self.facet_nodes(facet));
            for (edge, ends) in kind.edges().enumerate() {
                let [a, b] = ends.map(|i| nodes[i]);
                let whole: Vec<u32> = [a, b].into_iter().chain(kind.middle_of_edge(edge).map(|i| nodes[i])).collect();
                if all(&whole, set) {
                    edges.entry([a.min(b), a.max(b)]).or_insert(whole);
                }
            }
        }
        edges.into_values().map(|nodes| self.edge_weights(&nodes)).collect()
    }

    /// ∫ N ds for the ends of an edge and, where there is one, the node in its middle, mm.
    fn edge_weights(&self, nodes: &[u32]) -> Piece {
        let mut weights = vec![0.0; nodes.len()];
        for (t, weight) in LINE {
            let (values, slopes) = match nodes.len() {
                2 => ([0.5 * (1.0 - t), 0.5 * (1.0 + t), 0.0], [-0.5, 0.5, 0.0]),
                _ => ([0.5 * t * (t - 1.0), 0.5 * t * (t + 1.0), 1.0 - t * t], [t - 0.5, t + 0.5, -2.0 * t]),
            };
            let tangent: [f64; 3] = std::array::from_fn(|d| {
                nodes.iter().zip(slopes).map(|(&node, slope)| slope * self.nodes[node as usize][d]).sum()
            });
            let length = weight * norm(tangent);
            weights.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * length);
        }
        nodes.iter().copied().zip(weights).collect()
    }
}

fn all(nodes: &[u32], set: &[bool]) -> bool {
    nodes.iter().all(|&node| set[node as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;
    use crate::lattice::Lattice;

    /// A bar of 4 × 2 × 1 mm whose cells are of different sizes.
    fn bar(kind: ElementKind) -> Mesh {
        let lines = [vec![0.0, 1.0, 4.0], vec![0.0, 0.5, 2.0], vec![0.0, 0.3, 1.0]];
        Lattice { lines }.mesh(kind, |_| true).mesh
    }

    /// Σ share x: where the resultant of an even load acts.
    fn centre(mesh: &Mesh, nodes: &[u32], shares: &[f64]) -> [f64; 3] {
        let moment = |d: usize| nodes.iter().zip(shares).map(|(&n, share)| share * mesh.nodes[n as usize][d]).sum();
        std::array::from_fn(moment)
    }

    #[test]
    fn an_even_load_acts_at_the_centre_of_faces_edges_and_bodies_whatever_the_mesh() {
        for kind in ElementKind::ALL {
            let mesh = bar(kind);
            let ends: [(&str, Vec<u32>, [f64; 3]); 5] = [
                ("face", mesh.select_nodes(|x| x[0] == 4.0), [4.0, 1.0, 0.5]),
                ("face inside", mesh.select_nodes(|x| x[0] == 1.0), [1.0, 1.0, 0.5]),
                ("edge", mesh.select_nodes(|x| x[0] == 4.0 && x[1] == 2.0), [4.0, 2.0, 0.5]),
                ("edge inside", mesh.select_nodes(|x| x[1] == 0.5 && x[2] == 0.3), [2.0, 0.5, 0.3]),
                ("body", mesh.select_nodes(|_| true), [2.0, 1.0, 0.5]),
            ];
            for (name, nodes, expected) in ends {
                let shares = mesh.shares(&nodes);
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{kind:?} {name}");
                let found = centre(&mesh, &nodes, &shares);
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{kind:?} {name}: {found:?}");
            }
        }
    }

    #[test]
    fn shares_are_those_of_the_elements_shape_functions() {
        let one = |kind| Lattice { lines: [vec![0.0, 1.0], vec![0.0, 1.0], vec![0.0, 1.0]] }.mesh(kind, |_| true).mesh;
        for (kind, corner, side, inner) in [
            (ElementKind::Hex8, 1.0 / 4.0, None, None),
            (ElementKind::Hex20, -1.0 / 12.0, Some(1.0 / 3.0), None),
            (ElementKind::Hex27, 1.0 / 36.0, Some(1.0 / 9.0), Some(4.0 / 9.0)),
            (ElementKind::Tet10, 0.0, Some(1.0 / 6.0), Some(1.0 / 3.0)),
        ] {
            let mesh = one(kind);
            let nodes = mesh.select_nodes(|x| x[0] == 1.0);
            for (&node, share) in nodes.iter().zip(mesh.shares(&nodes)) {
                let middles = mesh.nodes[node as usize][1..].iter().filter(|t| **t == 0.5).count();
                let expected = [Some(corner), side, inner][middles].unwrap();
                assert!((share - expected).abs() < 1e-14, "{kind:?} {share} {expected}");
            }
        }
    }

    #[test]
    fn nodes_of_no_complete_part_get_equal_shares_beside_those_of_faces() {
        let mesh = bar(ElementKind::Hex27);
        // Every other node along a line: no edge is complete.
        let loose = mesh.select_nodes(|x| x[1] == 0.0 && x[2] == 0.0 && [0.5, 2.5].contains(&x[0]));
        assert_eq!(mesh.shares(&loose), [0.5, 0.5]);
        let mut both = mesh.select_nodes(|x| x[0] == 4.0);
        let of_face = both.len() as f64;
        both.extend(&loose);
        let (shares, whole) = (mesh.shares(&both), both.len() as f64);
        assert!(shares[both.len() - 2..].iter().all(|share| (share - 1.0 / whole).abs() < 1e-14));
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((shares[..both.len() - 2].iter().sum::<f64>() - of_face / whole).abs() < 1e-12);
        assert!(mesh.shares(&[]).is_empty());
        assert_eq!(mesh.shares(&[7]), [1.0]);
    }

    #[test]
    fn a_surface_is_found_by_its_faces_or_by_its_nodes() {
        let mut mesh = bar(ElementKind::Hex20);
        let facets = mesh.select_facets(|x| x[0] == 4.0);
        mesh.node_sets.insert("end".into(), mesh.select_nodes(|x| x[0] == 4.0));
        assert_eq!(mesh.faces_named("end"), facets);
        let shares = mesh.shares_of_faces(&facets);
        let nodes: Vec<u32> = shares.iter().map(|(node, _)| *node).collect();
        assert_eq!(nodes, mesh.node_set("end"));
        let of_nodes = mesh.shares(&nodes);
        assert!(shares.iter().zip(of_nodes).all(|((_, a), b)| (a - b).abs() < 1e-15));
        mesh.facet_sets.insert("end".into(), facets[..1].to_vec());
        assert_eq!(mesh.faces_named("end"), facets[..1]);
        assert!(mesh.faces_named("nothing").is_empty());
    }
}
