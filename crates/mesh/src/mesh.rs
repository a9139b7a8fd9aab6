//! The mesh: nodes, elements, named sets.

use std::collections::BTreeMap;

use crate::element::ElementKind;
use crate::face::FaceKind;
use crate::kinds::{Kinds, PerKind};
use crate::shape;
use crate::vector::bounds;

pub use crate::matrix::{cofactor, determinant};

/// One face of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Element number.
    pub element: u32,
    /// Local face number, see [`crate::family::ElementFamily::faces`].
    pub face: u8,
}

/// Nodes and elements, with named sets of nodes, facets and elements.
///
/// Sets are kept in name order and their members in ascending order, so that nothing depends on insertion.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Families of the elements.
    pub kinds: Kinds,
    /// Reference position of every node, mm.
    pub nodes: Vec<[f64; 3]>,
    /// Node numbers, element by element.
    pub connectivity: Vec<u32>,
    /// Named node sets.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named facet sets; a facet's normal points out of the solid.
    pub facet_sets: BTreeMap<String, Vec<Facet>>,
    /// Named element sets.
    pub element_sets: BTreeMap<String, Vec<u32>>,
}

impl Mesh {
    /// Number of nodes.
    pub fn num_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of elements.
    pub fn num_elements(&self) -> usize {
        match &self.kinds {
            Kinds::One(kind) => self.connectivity.len() / kind.num_nodes(),
            Kinds::Each { kinds, .. } => kinds.len(),
        }
    }

    /// Node numbers of element `element`.
    ///
    /// # Panics
    /// If `element >= self.num_elements()`.
    pub fn element(&self, element: usize) -> &[u32] {
        &self.connectivity[self.kinds.range(element)]
    }

    /// Node numbers of a facet, oriented so that `r_ξ × r_η` points out of the solid.
    pub fn facet_nodes(&self, facet: Facet) -> Vec<u32> {
        let element = self.element(facet.element as usize);
        let kind = self.kind_of(facet.element as usize);
        kind.face_nodes(facet.face as usize).iter().map(|&local| element[local]).collect()
    }

    /// Family of an element.
    pub fn kind_of(&self, element: usize) -> ElementKind {
        self.kinds.of(element)
    }

    /// The families that the mesh has elements of.
    pub fn families(&self) -> Vec<ElementKind> {
        self.kinds.families()
    }

    /// One value for each family that the mesh has elements of.
    pub fn per_kind<T>(&self, value: impl FnMut(ElementKind) -> T) -> PerKind<T> {
        PerKind::new(&self.families(), value)
    }

    /// Its elements in words, as in "hexahedra with 27 nodes and wedges with 21 nodes".
    pub fn words(&self) -> String {
        self.families().iter().map(|kind| kind.words()).collect::<Vec<_>>().join(" and ")
    }

    /// Corners of an element.
    pub fn corners(&self, element: usize) -> &[u32] {
        &self.element(element)[..self.kind_of(element).num_corners()]
    }

    /// Family of a facet.
    pub fn face_kind(&self, facet: Facet) -> FaceKind {
        self.kind_of(facet.element as usize).face_kind(facet.face as usize)
    }

    /// Edges of a surface that belong to one of its facets only: first corner, last corner and, where there is one, the node in the middle,
    /// in the direction in which the facet's corners run around its outward normal.
    pub fn rim(&self, facets: &[Facet]) -> Vec<Vec<u32>> {
        let mut edges: Vec<([u32; 2], Vec<u32>)> = Vec::new();
        for &facet in facets {
            let (kind, nodes) = (self.face_kind(facet), self.facet_nodes(facet));
            edges.extend(kind.edges().enumerate().map(|(edge, ends)| {
                let [a, b] = ends.map(|i| nodes[i]);
                let middle = kind.middle_of_edge(edge).map(|i| nodes[i]);
                ([a.min(b), a.max(b)], [a, b].into_iter().chain(middle).collect())
            }));
        }
        edges.sort_unstable();
        edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1.clone()).collect()
    }

    /// Nodes of the named set; empty if there is no such set.
    pub fn node_set(&self, name: &str) -> &[u32] {
        self.node_sets.get(name).map_or(&[], Vec::as_slice)
    }

    /// Facets of the named set; empty if there is no such set.
    pub fn facet_set(&self, name: &str) -> &[Facet] {
        self.facet_sets.get(name).map_or(&[], Vec::as_slice)
    }

    /// Elements of the named set; empty if there is no such set.
    pub fn element_set(&self, name: &str) -> &[u32] {
        self.element_sets.get(name).map_or(&[], Vec::as_slice)
    }

    /// Volume of the solid in mm³, by the quadrature of the element family.
    pub fn volume(&self) -> f64 {
        self.volume_of(0..self.num_elements() as u32)
    }

    /// The same of some elements.
    pub fn volume_of(&self, elements: impl IntoIterator<Item = u32>) -> f64 {
        let rules = self.per_kind(|kind| {
            let rule = (kind.volume_rule)().into_iter();
            rule.map(|(xi, w)| (shape::tabulate(kind, xi).1, w)).collect::<Vec<_>>()
        });
        // Element by element: a million numbers one after the other lose four digits.
        let of_element = |e: u32| -> f64 {
            rules[self.kind_of(e as usize)]
                .iter()
                .map(|(gradients, w)| w * determinant(&self.jacobian(e as usize, gradients)))
                .sum()
        };
        elements.into_iter().map(of_element).sum()
    }

    /// ∂X/∂ξ of an element at a point where the shape functions have the given gradients; rows are components of X.
    pub fn jacobian(&self, element: usize, gradients: &[[f64; 3]]) -> [[f64; 3]; 3] {
        let mut jacobian = [[0.0; 3]; 3];
        for (&node, gradient) in self.element(element).iter().zip(gradients) {
            let x = self.nodes[node as usize];
            for i in 0..3 {
                for j in 0..3 {
                    jacobian[i][j] += x[i] * gradient[j];
                }
            }
        }
        jacobian
    }

    /// For every node the lowest node of its part: nodes that elements join belong to one part.
    pub fn parts(&self) -> Vec<usize> {
        let neighbours = (0..self.num_elements()).flat_map(|element| {
            let nodes = self.element(element);
            nodes[1..].iter().map(|&node| [nodes[0] as usize, node as usize])
        });
        joined(self.num_nodes(), neighbours)
    }

    /// For every element the number of its part: elements that faces join belong to one part, which is rigid if its elements are; two parts
    /// may share nodes (a hinge). Parts are numbered in the order of their first elements.
    pub fn parts_by_faces(&self) -> Vec<usize> {
        let mut faces: Vec<([u32; 4], u32)> = Vec::new();
        for facet in (0..self.num_elements() as u32).flat_map(|element| self.facets_of(element)) {
            let corners = self.face_kind(facet).num_corners();
            let mut key = [u32::MAX; 4];
            key.iter_mut().zip(&self.facet_nodes(facet)[..corners]).for_each(|(key, node)| *key = *node);
            key.sort_unstable();
            faces.push((key, facet.element));
        }
        faces.sort_unstable();
        let pairs =
            faces.windows(2).filter(|two| two[0].0 == two[1].0).map(|two| [two[0].1, two[1].1].map(|e| e as usize));
        let lowest = joined(self.num_elements(), pairs);
        let mut number = vec![0; lowest.len()];
        let mut count = 0;
        for element in 0..lowest.len() {
            number[element] = if lowest[element] == element { count } else { number[lowest[element]] };
            count += usize::from(lowest[element] == element);
        }
        number
    }

    /// Largest extent along an axis, mm.
    pub fn extent(&self) -> f64 {
        let longest = |[low, high]: [[f64; 3]; 2]| (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        bounds(self.nodes.iter().copied()).map_or(0.0, longest)
    }

    /// Edge of a cube as large as an element is on the average, mm.
    pub fn mean_element_size(&self) -> f64 {
        (self.volume() / self.num_elements().max(1) as f64).cbrt()
    }

    /// Mean distance of neighbouring nodes, mm: the cube root of the volume per node, about half an element's size for quadratic ones.
    pub fn mean_node_spacing(&self) -> f64 {
        (self.volume() / self.num_nodes().max(1) as f64).cbrt()
    }

    /// Positions of the nodes at a displacement (one entry per node), mm.
    pub fn deformed(&self, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.nodes.iter().zip(displacement).map(|(x, u)| std::array::from_fn(|k| x[k] + u[k])).collect()
    }

    /// Node nearest to `point` and its distance in mm; the lowest number wins a tie. `None` for an empty mesh.
    pub fn nearest_node(&self, point: [f64; 3]) -> Option<(usize, f64)> {
        let squared = |x: &[f64; 3]| (0..3).map(|i| (x[i] - point[i]).powi(2)).sum::<f64>();
        (0..self.num_nodes())
            .map(|node| (node, squared(&self.nodes[node])))
            .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
            .map(|(node, d)| (node, d.sqrt()))
    }

    /// All facets of an element.
    pub fn facets_of(&self, element: u32) -> impl Iterator<Item = Facet> + use<> {
        let faces = self.kind_of(element as usize).num_faces() as u8;
        (0..faces).map(move |face| Facet { element, face })
    }

    /// Facets that belong to one element only: the boundary of the solid, in element order.
    pub fn boundary_facets(&self) -> Vec<Facet> {
        let faces = self.facets_by_face();
        let mut boundary: Vec<Facet> =
            faces.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() == 1).map(|group| group[0].1).collect();
        boundary.sort();
        boundary
    }

    /// Faces that two elements have in common, as the facets of both, in element order.
    pub fn shared_faces(&self) -> Vec<[Facet; 2]> {
        let faces = self.facets_by_face();
        let pairs = faces.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() == 2);
        let mut shared: Vec<[Facet; 2]> = pairs.map(|group| [group[0].1, group[1].1]).collect();
        shared.sort();
        shared
    }

    /// All facets with the sorted corners of their faces; those of one face follow each other.
    fn facets_by_face(&self) -> Vec<(Vec<u32>, Facet)> {
        let mut faces: Vec<(Vec<u32>, Facet)> = (0..self.num_elements() as u32)
            .flat_map(|element| self.facets_of(element))
            .map(|facet| {
                let mut key = self.facet_nodes(facet);
                key.truncate(self.face_kind(facet).num_corners());
                key.sort_unstable();
                (key, facet)
            })
            .collect();
        faces.sort();
        faces
    }

    /// A quadrilateral and a triangle on the boundary that has three of its corners: they lie on each other, but do not hold together. The
    /// first such pair; `None` if there is none.
    pub fn unmatched_faces(&self) -> Option<[Facet; 2]> {
        let families = self.families();
        let has_face =
            |corners| families.iter().any(|kind| kind.faces.iter().any(|face| face.kind.num_corners() == corners));
        if !(has_face(3) && has_face(4)) {
            return None;
        }
        let boundary = self.boundary_facets();
        let corners = |facet: Facet| {
            let mut corners = self.facet_nodes(facet);
            corners.truncate(self.face_kind(facet).num_corners());
            corners.sort_unstable();
            corners
        };
        let (triangles, quadrilaterals): (Vec<Facet>, Vec<Facet>) =
            boundary.into_iter().partition(|&facet| self.face_kind(facet).num_corners() == 3);
        let triangles: BTreeMap<Vec<u32>, Facet> = triangles.into_iter().map(|facet| (corners(facet), facet)).collect();
        quadrilaterals.into_iter().find_map(|facet| {
            let four = corners(facet);
            (0..4).find_map(|left_out| {
                let mut three = four.clone();
                three.remove(left_out);
                triangles.get(&three).map(|&triangle| [facet, triangle])
            })
        })
    }

    /// Selects the nodes for which `predicate` holds, in ascending order.
    pub fn select_nodes(&self, predicate: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
        (0..self.num_nodes() as u32).filter(|&n| predicate(self.nodes[n as usize])).collect()
    }

    /// Boundary facets all of whose nodes satisfy `predicate`.
    pub fn select_facets(&self, predicate: impl Fn([f64; 3]) -> bool) -> Vec<Facet> {
        self.boundary_facets()
            .into_iter()
            .filter(|&facet| self.facet_nodes(facet).iter().all(|&n| predicate(self.nodes[n as usize])))
            .collect()
    }

    /// Moves every node by `map`: curved bodies from straight lattices.
    pub fn map_nodes(mut self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        for node in &mut self.nodes {
            *node = map(*node);
        }
        self
    }
}

/// For every thing the lowest one that pairs join it with.
fn joined(count: usize, pairs: impl Iterator<Item = [usize; 2]>) -> Vec<usize> {
    fn root(of: &mut [usize], mut thing: usize) -> usize {
        while of[thing] != thing {
            of[thing] = of[of[thing]];
            thing = of[thing];
        }
        thing
    }
    let mut of: Vec<usize> = (0..count).collect();
    for pair in pairs {
        let [a, b] = pair.map(|thing| root(&mut of, thing));
        of[a.max(b)] = a.min(b);
    }
    (0..count).map(|thing| root(&mut of, thing)).collect()
}
