//! Nodes in the faces and inside of elements that come without them.

use std::collections::BTreeMap;

use crate::element::ElementKind;
use crate::kinds::{Kinds, PerKind};
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
    /// The mesh of the families that [enrich](crate::family::ElementFamily::enriches) its own, and the new nodes. The shapes of the elements are
    /// what they were. New nodes come behind all others: those of faces, then those inside of elements. They belong to the node sets to which
    /// all nodes around them belong. Elements of a family that no other one enriches stay as they are.
    pub fn enriched(self) -> (Self, Vec<AddedNode>) {
        let recipes = self.per_kind(Recipe::of);
        if recipes.values().all(|recipe| recipe.new == recipe.old) {
            return (self, Vec::new());
        }
        let elements = self.num_elements();
        let mut nodes = self.nodes.clone();
        let kinds: Kinds = (0..elements).map(|element| recipes[self.kind_of(element)].new).collect();
        let mut connectivity = vec![0; (0..elements).map(|element| kinds.of(element).num_nodes()).sum()];
        let mut added: Vec<AddedNode> = Vec::new();
        let mut known = self.given_centres(&recipes);
        for element in 0..elements {
            let old_nodes = self.element(element);
            let recipe = &recipes[self.kind_of(element)];
            let new_nodes = &mut connectivity[kinds.range(element)];
            recipe.kept.iter().zip(old_nodes).for_each(|(&place, &node)| new_nodes[place] = node);
            for NewCentre { face, local, around } in &recipe.faces {
                let key = self.face_key(Facet { element: element as u32, face: *face });
                match known.get(&key) {
                    Some(&Centre::Given(node)) => new_nodes[*local] = node,
                    Some(&Centre::Added(number)) => {
                        added[number].place = Place::Face;
                        new_nodes[*local] = added[number].node;
                    }
                    None => {
                        known.insert(key, Centre::Added(added.len()));
                        let around: Vec<(u32, f64)> =
                            around.iter().map(|&(node, value)| (old_nodes[node], value)).collect();
                        let node = nodes.len() as u32;
                        new_nodes[*local] = node;
                        nodes.push(mean(&self.nodes, around.iter().copied()));
                        added.push(AddedNode { node, place: Place::Surface, around });
                    }
                }
            }
        }
        for element in 0..elements {
            for (local, values) in &recipes[self.kind_of(element)].inner {
                let around: Vec<(u32, f64)> =
                    self.element(element).iter().copied().zip(values.iter().copied()).collect();
                let node = nodes.len() as u32;
                connectivity[kinds.range(element).start + local] = node;
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
        let mesh = Self { kinds, nodes, connectivity, node_sets, ..self };
        (mesh, added)
    }

    /// Nodes that elements have in their faces already, by the faces' corners.
    fn given_centres(&self, recipes: &PerKind<Recipe>) -> BTreeMap<[u32; 4], Centre> {
        // In a mesh of one family all faces lack them, or their neighbours have the same ones.
        if self.families().len() < 2
            && recipes.values().all(|recipe| recipe.old.faces.iter().all(|face| !face.has_centre()))
        {
            return BTreeMap::new();
        }
        let facets = (0..self.num_elements() as u32).flat_map(|element| self.facets_of(element));
        let with_centre =
            facets.filter(|&facet| self.kind_of(facet.element as usize).faces[usize::from(facet.face)].has_centre());
        let centre = |facet| self.facet_nodes(facet).last().map(|&node| (self.face_key(facet), Centre::Given(node)));
        with_centre.filter_map(centre).collect()
    }

    /// The corners of a face in ascending order, behind which `u32::MAX` fills up.
    fn face_key(&self, facet: Facet) -> [u32; 4] {
        let corners = self.face_kind(facet).num_corners();
        let (nodes, family) = (self.element(facet.element as usize), self.kind_of(facet.element as usize));
        let mut key = [u32::MAX; 4];
        let of_face = &family.face_nodes(usize::from(facet.face))[..corners];
        key.iter_mut().zip(of_face).for_each(|(key, &local)| *key = nodes[local]);
        key.sort_unstable();
        key
    }
}

/// The node at the centre of a face.
#[derive(Clone, Copy)]
enum Centre {
    /// An element came with it.
    Given(u32),
    /// Number among those that were added.
    Added(usize),
}

/// What is added to elements of a family.
struct Recipe {
    old: ElementKind,
    new: ElementKind,
    /// Where the nodes that there are come.
    kept: Vec<usize>,
    /// Of every face that lacks its node.
    faces: Vec<NewCentre>,
    /// New local nodes inside, and the shape functions of all old nodes there.
    inner: Vec<(usize, Vec<f64>)>,
}

/// The node that a face of an element gets: the face, the new local node, and the old ones with their shape functions there.
struct NewCentre {
    face: u8,
    local: usize,
    around: Vec<(usize, f64)>,
}

impl Recipe {
    fn of(old: ElementKind) -> Self {
        let new = old.enriched().unwrap_or(old);
        let place = |local| new.place_of(&old, local).expect("an enriched family has all nodes of the poorer one");
        let kept: Vec<usize> = (0..old.num_nodes()).map(place).collect();
        // Quarters, eighths and ninths: equal ones to the last digit.
        let at = |local: usize| -> Vec<f64> {
            shape::tabulate(old, new.nodes[local]).0.iter().map(|value| (144.0 * value).round() / 144.0).collect()
        };
        let faces: Vec<NewCentre> = (0..new.num_faces())
            .filter_map(|face| {
                let local = new.face_nodes(face).iter().copied().find(|node| !kept.contains(node))?;
                let values = at(local);
                let around = old.face_nodes(face).iter().map(|&node| (node, values[node])).collect();
                Some(NewCentre { face: face as u8, local, around })
            })
            .collect();
        let inner = (0..new.num_nodes())
            .filter(|local| !kept.contains(local) && faces.iter().all(|face| face.local != *local))
            .map(|local| (local, at(local)))
            .collect();
        Self { old, new, kept, faces, inner }
    }
}

/// Σ N x: to the last digit the same in whatever order the nodes come, and in a plane normal to an axis if they all are.
pub(crate) fn mean(nodes: &[[f64; 3]], values: impl Iterator<Item = (u32, f64)> + Clone) -> [f64; 3] {
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
    use crate::lattice::Lattice;

    #[test]
    fn enriched_elements_have_the_shape_that_they_had() {
        for kind in [ElementKind::Hex20, ElementKind::Tet10, ElementKind::Wedge15, ElementKind::Wedge18] {
            let block = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(kind);
            let end = block.select_nodes(|x| x[0] == 0.0);
            let mut mesh = block.map_nodes(|[x, y, z]| [x + 0.1 * y * z, y - 0.05 * x * x, z + 0.1 * x * y]);
            mesh.node_sets.insert("end".into(), end.clone());
            mesh.node_sets.insert("all".into(), mesh.select_nodes(|_| true));
            let (old, (rich, added)) = (mesh.clone(), mesh.enriched());
            assert_eq!(rich.kinds.only(), kind.enriched());
            assert_eq!(rich.num_nodes(), old.num_nodes() + added.len());
            assert_eq!(added.iter().filter(|node| node.place == Place::Element).count(), old.num_elements());
            assert_eq!(rich.boundary_facets(), old.boundary_facets());
            let lacks_centre = |facet: &&Facet| !old.kind_of(0).faces[usize::from(facet.face)].has_centre();
            let boundary = old.boundary_facets();
            let lacking = boundary.iter().filter(lacks_centre).count();
            assert_eq!(added.iter().filter(|node| node.place == Place::Surface).count(), lacking);
            assert!(added.iter().all(|f| (f.around.iter().map(|(_, v)| v).sum::<f64>() - 1.0).abs() < 1e-14));
            for xi in [[0.2, 0.3, 0.1], [0.1, 0.1, 0.7]] {
                let [a, b] = [&old, &rich].map(|mesh| {
                    let values = shape::tabulate(mesh.kind_of(0), xi).0;
                    let at = |e| mean(&mesh.nodes, mesh.element(e).iter().copied().zip(values.iter().copied()));
                    (0..mesh.num_elements()).map(at).collect::<Vec<_>>()
                });
                assert!(a.iter().zip(&b).all(|(a, b)| (0..3).all(|d| (a[d] - b[d]).abs() < 1e-13)), "{kind:?}");
            }
            // A hexahedron or wedge has one face there, Kuhn's tetrahedra have two.
            let sides = match kind {
                ElementKind::Wedge18 => 0,
                ElementKind::Tet10 => 2,
                _ => 1,
            };
            assert_eq!(rich.node_set("end").len(), end.len() + sides);
            assert_eq!(rich.node_set("all"), rich.select_nodes(|_| true));
            assert!(rich.node_set("end").is_sorted() && rich.enriched().1.is_empty());
        }
    }

    /// A hexahedron with its face's node beside a wedge that lacks it: they share one.
    #[test]
    fn neighbours_of_several_families_share_the_nodes_of_their_faces() {
        let block = |kind| Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(kind);
        for hexahedron in [ElementKind::Hex20, ElementKind::Hex27] {
            for wedge in [ElementKind::Wedge15, ElementKind::Wedge18] {
                let mesh = crate::testing::mixed(&block(hexahedron), &block(wedge), |x| x[0] < 1.0);
                let (rich, _) = mesh.enriched();
                assert_eq!(rich.families(), [ElementKind::Hex27, ElementKind::Wedge21]);
                let expected =
                    crate::testing::mixed(&block(ElementKind::Hex27), &block(ElementKind::Wedge21), |x| x[0] < 1.0);
                assert_eq!(rich.num_nodes(), expected.num_nodes(), "{hexahedron:?} {wedge:?}");
                assert!((rich.volume() - 2.0).abs() < 1e-14 && rich.unmatched_faces().is_none());
                assert_eq!(rich.boundary_facets().len(), 5 + 2 * 2 + 3);
            }
        }
        // A quadrilateral on two triangles.
        let torn = crate::testing::mixed(&block(ElementKind::Hex27), &block(ElementKind::Tet15), |x| x[0] < 1.0);
        let [quadrilateral, triangle] = torn.unmatched_faces().unwrap();
        assert!(torn.facet_nodes(triangle)[..3].iter().all(|node| torn.facet_nodes(quadrilateral).contains(node)));
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
