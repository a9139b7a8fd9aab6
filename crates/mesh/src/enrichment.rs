//! Nodes in the faces and inside of elements that come without them.

use std::collections::BTreeMap;

use crate::mesh::{Facet, Mesh};
use crate::shape;

/// A node that was added in a face or inside of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct AddedNode {
    /// The new node.
    pub node: u32,
    /// Where it lies.
    pub place: Place,
    /// Nodes that the face or element had, corners first, with the values of their shape functions where the new node lies. Values sum to 1.
    pub around: Vec<(u32, f64)>,
}

/// Where a node was added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a face of the body's surface.
    Surface,
    /// In a face between two elements.
    Face,
    /// Inside of an element.
    Element,
}

impl Mesh {
    /// The mesh of the family that [enriches](crate::family::ElementFamily::enriches) its own, and the new nodes. The shapes of the elements are
    /// what they were. New nodes come behind all others: those of faces, then those inside of elements. They belong to the node sets to which
    /// all nodes around them belong. A mesh of a family that has no enriched one stays as it is.
    pub fn enriched(self) -> (Self, Vec<AddedNode>) {
        let (old, Some(new)) = (self.kind, self.kind.enriched()) else { return (self, Vec::new()) };
        let count = old.num_nodes();
        // Quarters, eighths and ninths: equal ones to the last digit.
        let at = |local: usize| -> Vec<f64> {
            shape::tabulate(old, new.nodes[local]).0.iter().map(|value| (144.0 * value).round() / 144.0).collect()
        };
        // Of every face: the new local node, and the old ones with their shape functions there.
        let faces: Vec<(usize, Vec<(usize, f64)>)> = (0..new.num_faces())
            .filter_map(|face| {
                let local = new.face_nodes(face).iter().copied().find(|&node| node >= count)?;
                let values = at(local);
                Some((local, old.face_nodes(face).iter().map(|&node| (node, values[node])).collect()))
            })
            .collect();
        let inner: Vec<(usize, Vec<f64>)> = (count..new.num_nodes())
            .filter(|local| faces.iter().all(|(of_face, _)| of_face != local))
            .map(|local| (local, at(local)))
            .collect();
        let elements = self.num_elements();
        let mut nodes = self.nodes.clone();
        let mut connectivity = vec![0; elements * new.num_nodes()];
        let mut added: Vec<AddedNode> = Vec::new();
        let mut known: BTreeMap<[u32; 4], usize> = BTreeMap::new();
        for element in 0..elements {
            let old_nodes = self.element(element);
            let new_nodes = &mut connectivity[element * new.num_nodes()..][..new.num_nodes()];
            new_nodes[..count].copy_from_slice(old_nodes);
            for (number, (local, around)) in faces.iter().enumerate() {
                let corners = self.face_kind(Facet { element: element as u32, face: number as u8 }).num_corners();
                let mut key = [u32::MAX; 4];
                key.iter_mut().zip(&around[..corners]).for_each(|(key, (node, _))| *key = old_nodes[*node]);
                key.sort_unstable();
                if let Some(&face) = known.get(&key) {
                    added[face].place = Place::Face;
                    new_nodes[*local] = added[face].node;
                    continue;
                }
                known.insert(key, added.len());
                let around: Vec<(u32, f64)> = around.iter().map(|&(node, value)| (old_nodes[node], value)).collect();
                let node = nodes.len() as u32;
                new_nodes[*local] = node;
                nodes.push(mean(&self.nodes, around.iter().copied()));
                added.push(AddedNode { node, place: Place::Surface, around });
            }
        }
        for element in 0..elements {
            for (local, values) in &inner {
                let around: Vec<(u32, f64)> =
                    self.element(element).iter().copied().zip(values.iter().copied()).collect();
                let node = nodes.len() as u32;
                connectivity[element * new.num_nodes() + local] = node;
                nodes.push(mean(&self.nodes, around.iter().copied()));
                added.push(AddedNode { node, place: Place::Element, around });
            }
        }
        let completed = |set: &Vec<u32>| -> Vec<u32> {
            let mut is_member = vec![false; self.num_nodes()];
            set.iter().for_each(|&node| is_member[node as usize] = true);
            let between = added.iter().filter(|node| node.around.iter().all(|(n, _)| is_member[*n as usize]));
            set.iter().copied().chain(between.map(|added| added.node)).collect()
        };
        let node_sets = self.node_sets.iter().map(|(name, set)| (name.clone(), completed(set))).collect();
        let mesh = Self { kind: new, nodes, connectivity, node_sets, ..self };
        (mesh, added)
    }
}

/// Σ N x: to the last digit the same in whatever order the nodes come, and in a plane normal to an axis if they all are.
fn mean(nodes: &[[f64; 3]], values: impl Iterator<Item = (u32, f64)> + Clone) -> [f64; 3] {
    std::array::from_fn(|d| {
        let at = |node: u32| nodes[node as usize][d];
        let low = values.clone().map(|(node, _)| at(node)).fold(f64::INFINITY, f64::min);
        let mut terms: Vec<f64> = values.clone().map(|(node, value)| value * (at(node) - low)).collect();
        terms.sort_by(f64::total_cmp);
        low + terms.iter().sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;
    use crate::lattice::Lattice;

    #[test]
    fn enriched_elements_have_the_shape_that_they_had() {
        for kind in [ElementKind::Hex20, ElementKind::Tet10] {
            let block = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(kind);
            let end = block.select_nodes(|x| x[0] == 0.0);
            let mut mesh = block.map_nodes(|[x, y, z]| [x + 0.1 * y * z, y - 0.05 * x * x, z + 0.1 * x * y]);
            mesh.node_sets.insert("end".into(), end.clone());
            mesh.node_sets.insert("all".into(), mesh.select_nodes(|_| true));
            let (old, (rich, added)) = (mesh.clone(), mesh.enriched());
            assert_eq!(Some(rich.kind), kind.enriched());
            assert_eq!(rich.num_nodes(), old.num_nodes() + added.len());
            assert_eq!(added.iter().filter(|node| node.place == Place::Element).count(), old.num_elements());
            assert_eq!(rich.boundary_facets(), old.boundary_facets());
            assert_eq!(added.iter().filter(|node| node.place == Place::Surface).count(), old.boundary_facets().len());
            assert!(added.iter().all(|f| (f.around.iter().map(|(_, v)| v).sum::<f64>() - 1.0).abs() < 1e-14));
            for xi in [[0.2, 0.3, 0.1], [0.1, 0.1, 0.7]] {
                let [a, b] = [&old, &rich].map(|mesh| {
                    let values = shape::tabulate(mesh.kind, xi).0;
                    let at = |e| mean(&mesh.nodes, mesh.element(e).iter().copied().zip(values.iter().copied()));
                    (0..mesh.num_elements()).map(at).collect::<Vec<_>>()
                });
                assert!(a.iter().zip(&b).all(|(a, b)| (0..3).all(|d| (a[d] - b[d]).abs() < 1e-13)), "{kind:?}");
            }
            let sides = if kind == ElementKind::Tet10 { 2 } else { 1 };
            assert_eq!(rich.node_set("end").len(), end.len() + sides);
            assert_eq!(rich.node_set("all"), rich.select_nodes(|_| true));
            assert!(rich.node_set("end").is_sorted() && rich.enriched().1.is_empty());
        }
    }

    #[test]
    fn enriched_serendipity_blocks_are_those_of_the_lattice() {
        let lattice = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]);
        let (rich, full) = (lattice.mesh_all(ElementKind::Hex20).enriched().0, lattice.mesh_all(ElementKind::Hex27));
        for element in 0..2 {
            for (&a, &b) in rich.element(element).iter().zip(full.element(element)) {
                let [a, b] = [rich.nodes[a as usize], full.nodes[b as usize]];
                assert!((0..3).all(|d| (a[d] - b[d]).abs() < 1e-14), "{a:?} {b:?}");
            }
        }
    }
}
