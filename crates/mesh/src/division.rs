//! Every element divided into eight, in the shape that it had.
//!
//! Hexahedra are halved along their three axes, wedges are a triangle in four times a line in two, tetrahedra four at the corners and four around a
//! diagonal of the octahedron between them. Every face is divided into four, alike from both of its sides, also where families meet. A part is the
//! image of its family's reference element under an affine map, so that its nodes, which lie where the undivided element has them, give it the
//! shape of its share of that, edges and faces curved as they were.

use std::collections::BTreeMap;

use crate::element::ElementKind;
use crate::family::{ReferenceBody, hex8, tet10};
use crate::kinds::{Kinds, PerKind};
use crate::mesh::{Facet, Mesh};
use crate::shape;

/// Number of parts of an element.
pub const PARTS: usize = 8;

/// All weights of corners at nodes of parts are multiples of one over this: 1/64 in hexahedra, 1/24 in tetrahedra, 1/48 in wedges.
const DENOMINATOR: f64 = 576.0;

/// A mesh with every element divided.
#[derive(Clone, Debug)]
pub struct Division {
    /// The mesh. Nodes of the undivided one come first, with their numbers; the parts of its element `e` are the elements from
    /// [`PARTS`] `e` on. Sets are those of the undivided mesh: parts of their elements and facets, and the nodes that [`Division::nodes`] finds.
    pub mesh: Mesh,
    undivided: Kinds,
    recipes: PerKind<Recipe>,
    /// For every node that was added the nodes around, with the values of their shape functions, which are not zero.
    around: Vec<Vec<(u32, f64)>>,
}

/// Two elements have the corners of an edge or a face in common, but not the nodes between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the elements around nodes {} and {} do not hold together: they share corners, but not the nodes between them", .0[0], .0[1])]
pub struct Torn(pub [u32; 2]);

impl Mesh {
    /// The mesh with every element divided into [`PARTS`].
    ///
    /// # Errors
    /// [`Torn`] for a mesh whose elements do not hold together.
    pub fn divided(&self) -> Result<Division, Torn> {
        let recipes = self.per_kind(Recipe::of);
        let count = self.num_elements();
        let mut known: BTreeMap<Vec<(u32, u32)>, u32> = BTreeMap::new();
        for element in 0..count {
            let kind = self.kind_of(element);
            for (&node, weights) in self.element(element).iter().zip(&recipes[kind].corners_of_nodes) {
                let other = *known.entry(key(self.element(element), weights)).or_insert(node);
                if other != node {
                    return Err(Torn([other, node]));
                }
            }
        }
        let (mut nodes, mut around) = (self.nodes.clone(), Vec::new());
        let mut connectivity = Vec::with_capacity(PARTS * self.connectivity.len());
        for element in 0..count {
            let (recipe, own) = (&recipes[self.kind_of(element)], self.element(element));
            let numbers: Vec<u32> = recipe
                .points
                .iter()
                .map(|point| {
                    *known.entry(key(own, &point.corners)).or_insert_with(|| {
                        let values: Vec<(u32, f64)> = point.values.iter().map(|&(local, v)| (own[local], v)).collect();
                        nodes.push(crate::enrichment::mean(&self.nodes, values.iter().copied()));
                        around.push(values);
                        nodes.len() as u32 - 1
                    })
                })
                .collect();
            connectivity.extend(recipe.parts.iter().flatten().map(|&point| numbers[point]));
        }
        let kinds = match &self.kinds {
            Kinds::One(kind) => Kinds::One(*kind),
            Kinds::Each { kinds, .. } => kinds.iter().flat_map(|kind| [*kind; PARTS]).collect(),
        };
        let (node_sets, facet_sets, element_sets) = Default::default();
        let mesh = Self { kinds, nodes, connectivity, node_sets, facet_sets, element_sets };
        let mut division = Division { mesh, undivided: self.kinds.clone(), recipes, around };
        division.mesh.node_sets = in_each(&self.node_sets, |set| division.nodes(set));
        division.mesh.facet_sets = in_each(&self.facet_sets, |set| division.facets(set));
        division.mesh.element_sets = in_each(&self.element_sets, |set| division.elements(set));
        Ok(division)
    }
}

/// What becomes of sets.
fn in_each<T>(sets: &BTreeMap<String, Vec<T>>, of: impl Fn(&[T]) -> Vec<T>) -> BTreeMap<String, Vec<T>> {
    sets.iter().map(|(name, set)| (name.clone(), of(set))).collect()
}

impl Division {
    /// Parts of elements, in ascending order if these are.
    pub fn elements(&self, undivided: &[u32]) -> Vec<u32> {
        undivided.iter().flat_map(|&element| Self::parts_of(element)).collect()
    }

    /// Parts of an element.
    pub fn parts_of(element: u32) -> std::ops::Range<u32> {
        PARTS as u32 * element..PARTS as u32 * (element + 1)
    }

    /// Parts of facets, four of each one after the other.
    pub fn facets(&self, undivided: &[Facet]) -> Vec<Facet> {
        let parts = |facet: &Facet| {
            let first = PARTS as u32 * facet.element;
            let of_face = &self.recipes[self.undivided.of(facet.element as usize)].faces[usize::from(facet.face)];
            of_face.iter().map(move |&(part, face)| Facet { element: first + part, face }).collect::<Vec<_>>()
        };
        undivided.iter().flat_map(parts).collect()
    }

    /// Nodes of the undivided mesh and those that were added where all nodes around, which have a share in the shape there, are among them: all
    /// on a face, along an edge, or on the line across a face, if its nodes are.
    pub fn nodes(&self, undivided: &[u32]) -> Vec<u32> {
        let first = self.first_added();
        let mut is_member = vec![false; first];
        undivided.iter().for_each(|&node| is_member[node as usize] = true);
        let within = |(_, around): &(usize, &Vec<(u32, f64)>)| around.iter().all(|(node, _)| is_member[*node as usize]);
        let added = self.around.iter().enumerate().filter(within).map(|(number, _)| (first + number) as u32);
        undivided.iter().copied().chain(added).collect()
    }

    /// The nodes that were added, each with the nodes around that have a share in the shape there and the values of their shape functions.
    pub fn added(&self) -> impl Iterator<Item = (u32, &[(u32, f64)])> {
        let first = self.first_added() as u32;
        self.around.iter().enumerate().map(move |(number, around)| (first + number as u32, &around[..]))
    }

    /// A field with one entry per node of the undivided mesh, as the shape functions of its elements continue it.
    pub fn continued(&self, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let at = |around: &Vec<(u32, f64)>| {
            std::array::from_fn(|d| around.iter().map(|&(node, value)| value * field[node as usize][d]).sum())
        };
        field.iter().copied().chain(self.around.iter().map(at)).collect()
    }

    /// A function a₀ + a₁ ξ + a₂ η + a₃ ζ on the reference element of an undivided element, by these numbers on those of its parts.
    pub fn linear(&self, element: usize, coefficients: [f64; 4]) -> [[f64; 4]; PARTS] {
        self.recipes[self.undivided.of(element)].maps.map(|map| {
            let along = |vector: [f64; 3]| (0..3).map(|d| coefficients[1 + d] * vector[d]).sum::<f64>();
            let [x, y, z] = map.axes.map(along);
            [coefficients[0] + along(map.origin), x, y, z]
        })
    }

    /// Number of nodes of the undivided mesh.
    fn first_added(&self) -> usize {
        self.mesh.num_nodes() - self.around.len()
    }
}

/// What is the same for a point whichever of its elements it is seen from: the corners around with their linear shape functions, in 1/576.
fn key(nodes: &[u32], corners: &[(usize, u32)]) -> Vec<(u32, u32)> {
    let mut key: Vec<(u32, u32)> = corners.iter().map(|&(corner, weight)| (nodes[corner], weight)).collect();
    key.sort_unstable();
    // Elements may be collapsed: a corner that comes twice counts once.
    key.dedup_by(|next, first| {
        let is_same = next.0 == first.0;
        first.1 += if is_same { next.1 } else { 0 };
        is_same
    });
    key
}

/// ξ ↦ origin + Σ ξᵢ axisᵢ, from a part's reference element to the undivided one's.
#[derive(Clone, Copy, Debug, Default)]
struct Map {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl Map {
    fn of(&self, xi: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|d| self.origin[d] + (0..3).map(|axis| xi[axis] * self.axes[axis][d]).sum::<f64>())
    }

    /// Of the unit tetrahedron onto one with the given corners.
    fn onto_tetrahedron([a, b, c, d]: [[f64; 3]; 4]) -> Self {
        Self { origin: a, axes: [b, c, d].map(|corner| std::array::from_fn(|k| corner[k] - a[k])) }
    }
}

/// The parts of a reference element.
fn maps(body: ReferenceBody) -> [Map; PARTS] {
    match body {
        ReferenceBody::Hexahedron => std::array::from_fn(|part| Map {
            origin: hex8::FAMILY.nodes[part].map(|t| 0.5 * t),
            axes: [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]],
        }),
        ReferenceBody::Tetrahedron => tetrahedra().map(Map::onto_tetrahedron),
        ReferenceBody::Wedge => wedges(),
    }
}

/// Corners of the parts of a tetrahedron; pictures have the same ones.
fn tetrahedra() -> [[[f64; 3]; 4]; PARTS] {
    let parts = tet10::FAMILY.tetrahedra.map_or_else(Vec::new, |parts| parts());
    std::array::from_fn(|part| parts[part].map(|node| tet10::FAMILY.nodes[usize::from(node)]))
}

fn wedges() -> [Map; PARTS] {
    // Three triangles at the corners, and the one between them, turned by half a turn.
    const TRIANGLES: [([f64; 2], f64); 4] =
        [([0.0, 0.0], 0.5), ([0.5, 0.0], 0.5), ([0.0, 0.5], 0.5), ([0.5, 0.5], -0.5)];
    std::array::from_fn(|part| {
        let ([x, y], side) = TRIANGLES[part % 4];
        let z = if part < 4 { -0.5 } else { 0.5 };
        Map { origin: [x, y, z], axes: [[side, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, 0.5]] }
    })
}

/// Linear shape functions of a body's corners.
fn corner_values(body: ReferenceBody, [x, y, z]: [f64; 3]) -> Vec<f64> {
    match body {
        ReferenceBody::Hexahedron => shape::tabulate(ElementKind::Hex8, [x, y, z]).0,
        ReferenceBody::Tetrahedron => vec![1.0 - x - y - z, x, y, z],
        ReferenceBody::Wedge => {
            let triangle = [1.0 - x - y, x, y];
            [0.5 * (1.0 - z), 0.5 * (1.0 + z)].iter().flat_map(|level| triangle.map(|t| level * t)).collect()
        }
    }
}

/// How elements of a family are divided.
#[derive(Clone, Debug)]
struct Recipe {
    maps: [Map; PARTS],
    /// For every node of the element its key.
    corners_of_nodes: Vec<Vec<(usize, u32)>>,
    /// Where nodes of parts are.
    points: Vec<Point>,
    /// Points that are the nodes of each part.
    parts: Vec<Vec<usize>>,
    /// Parts and their faces of every face.
    faces: Vec<Vec<(u32, u8)>>,
}

/// A node of a part.
#[derive(Clone, Debug)]
struct Point {
    /// Linear shape functions of the corners, in 1/576, without those that are zero.
    corners: Vec<(usize, u32)>,
    /// Shape functions of the element's nodes, without those that are zero.
    values: Vec<(usize, f64)>,
}

impl Recipe {
    fn of(kind: ElementKind) -> Self {
        let maps = maps(kind.body);
        let corners = |xi: [f64; 3]| -> Vec<(usize, u32)> {
            let weights = corner_values(kind.body, xi).into_iter().map(|value| (DENOMINATOR * value).round() as u32);
            weights.enumerate().filter(|(_, weight)| *weight > 0).collect()
        };
        let mut points: Vec<Point> = Vec::new();
        let parts = maps.iter().map(|map| {
            let number = |node: &[f64; 3]| {
                let xi = map.of(*node);
                let corners = corners(xi);
                points.iter().position(|point| point.corners == corners).unwrap_or_else(|| {
                    let values = shape::tabulate(kind, xi).0.into_iter().enumerate();
                    let values = values.filter(|(_, value)| value.abs() > 1e-12).collect();
                    points.push(Point { corners, values });
                    points.len() - 1
                })
            };
            kind.nodes.iter().map(number).collect::<Vec<usize>>()
        });
        let parts: Vec<Vec<usize>> = parts.collect();
        // A part's face lies on that of the element whose corners alone have a share at all of its points.
        let is_on = |face: usize, part: usize, own: usize| {
            let of_face = &kind.face_nodes(face)[..kind.face_kind(face).num_corners()];
            let points = kind.face_nodes(own).iter().map(|&local| &points[parts[part][local]]);
            points.flat_map(|point| &point.corners).all(|(corner, _)| of_face.contains(corner))
        };
        let faces = (0..kind.num_faces()).map(|face| {
            let all = (0..PARTS).flat_map(|part| (0..kind.num_faces()).map(move |own| (part, own)));
            all.filter(|&(part, own)| is_on(face, part, own)).map(|(part, own)| (part as u32, own as u8)).collect()
        });
        let faces = faces.collect();
        Self { maps, corners_of_nodes: kind.nodes.iter().map(|&xi| corners(xi)).collect(), points, parts, faces }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Lattice;
    use crate::testing::angle;

    /// Second-order, so that the elements of all families but the trilinear one have its shape, and no part is like another.
    fn bent([x, y, z]: [f64; 3]) -> [f64; 3] {
        [x + 0.05 * y * z - 0.02 * y * y, y - 0.04 * x * x + 0.03 * z, z + 0.03 * x * y + 0.02 * x * x]
    }

    fn meshes() -> impl Iterator<Item = Mesh> {
        let lattice = |kind| Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(kind);
        ElementKind::ALL.into_iter().map(lattice).chain([angle(1)]).map(|mesh| {
            let end = mesh.select_nodes(|x| x[0] == 0.0);
            let mut mesh = mesh;
            mesh.facet_sets.insert("end".into(), mesh.select_facets(|x| x[0] == 0.0));
            mesh.facet_sets.insert("all".into(), mesh.boundary_facets());
            mesh.node_sets.insert("end".into(), end);
            mesh.node_sets.insert("corner".into(), mesh.select_nodes(|x| x == [0.0; 3]));
            mesh.element_sets.insert("half".into(), (0..mesh.num_elements() as u32 / 2).collect());
            mesh.map_nodes(bent)
        })
    }

    fn area(mesh: &Mesh, facets: &[Facet]) -> f64 {
        facets.iter().flat_map(|&facet| mesh.face_weights(facet)).map(|(_, weight)| weight).sum()
    }

    #[test]
    fn parts_fill_the_elements_and_fit_together() {
        for mesh in meshes() {
            let words = mesh.words();
            let division = mesh.divided().unwrap();
            let fine = &division.mesh;
            assert_eq!(fine.num_elements(), PARTS * mesh.num_elements());
            assert_eq!(fine.nodes[..mesh.num_nodes()], mesh.nodes, "{words}");
            for element in 0..mesh.num_elements() as u32 {
                let [whole, parts] = [mesh.volume_of([element]), fine.volume_of(Division::parts_of(element))];
                assert!((whole - parts).abs() < 1e-12, "{words}: {whole} {parts}");
            }
            let least = fine.scaled_jacobians().fold(f64::INFINITY, f64::min);
            assert!(least > 0.05, "{words}: {least}");
            // No gap: the surface is what it was.
            assert!(fine.unmatched_faces().is_none());
            let mut surface = division.facets(&mesh.boundary_facets());
            surface.sort_unstable();
            assert_eq!(surface, fine.boundary_facets(), "{words}");
            let mut numbers: Vec<u32> = fine.connectivity.clone();
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers.len(), fine.num_nodes(), "{words}: every node is one of an element");
        }
    }

    #[test]
    fn nodes_are_those_of_a_mesh_of_half_the_size() {
        // By their number, and nowhere else than where the map has them: those of an undivided mesh that was finer from the beginning.
        for kind in
            [ElementKind::Hex8, ElementKind::Hex20, ElementKind::Hex27, ElementKind::Wedge15, ElementKind::Wedge21]
        {
            let lattice = |n: usize| Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2 * n, n, n]).mesh_all(kind);
            let (fine, expected) = (lattice(1).divided().unwrap().mesh, lattice(2));
            assert_eq!(fine.num_nodes(), expected.num_nodes(), "{kind:?}");
            for x in &fine.nodes {
                assert!(expected.nearest_node(*x).unwrap().1 < 1e-14, "{kind:?} {x:?}");
            }
        }
    }

    #[test]
    fn sets_are_carried_over() {
        for mesh in meshes() {
            let words = mesh.words();
            let division = mesh.divided().unwrap();
            let fine = &division.mesh;
            for name in ["end", "all"] {
                let [before, after] = [&mesh, fine].map(|mesh| area(mesh, mesh.facet_set(name)));
                assert_eq!(fine.facet_set(name).len(), 4 * mesh.facet_set(name).len());
                // Areas of faces that are not plane are no polynomials.
                assert!((before - after).abs() < 1e-4 * before && before > 0.5, "{words} {name}: {before} {after}");
            }
            assert_eq!(fine.element_set("half").len(), PARTS * mesh.element_set("half").len());
            assert_eq!(fine.node_set("corner"), mesh.node_set("corner"));
            let mut of_faces: Vec<u32> =
                fine.facet_set("end").iter().flat_map(|&facet| fine.facet_nodes(facet)).collect();
            of_faces.sort_unstable();
            of_faces.dedup();
            assert_eq!(fine.node_set("end"), of_faces, "{words}");
        }
    }

    /// The shape of each part is that of its share of the undivided element, as is a field.
    #[test]
    fn parts_have_the_shape_and_the_field_of_their_share() {
        let point = [0.2, 0.3, 0.1];
        for mesh in meshes() {
            let division = mesh.divided().unwrap();
            let field: Vec<[f64; 3]> =
                mesh.nodes.iter().map(|&[x, y, z]| [x + 2.0 * y, 1.0 - z, 0.5 * x - y]).collect();
            let continued = division.continued(&field);
            assert_eq!(continued[..mesh.num_nodes()], field);
            let at = |mesh: &Mesh, of: &[[f64; 3]], element: usize, xi: [f64; 3]| -> [f64; 3] {
                let values = shape::tabulate(mesh.kind_of(element), xi).0;
                let nodes = mesh.element(element);
                std::array::from_fn(|d| nodes.iter().zip(&values).map(|(&n, v)| v * of[n as usize][d]).sum())
            };
            for element in 0..mesh.num_elements() {
                let pressures = division.linear(element, [0.3, -1.0, 2.0, 0.7]);
                for (part, map) in maps(mesh.kind_of(element).body).into_iter().enumerate() {
                    let (xi, own) = (map.of(point), PARTS * element + part);
                    for [coarse, fine] in [[&mesh.nodes, &division.mesh.nodes], [&field, &continued]] {
                        let [a, b] = [at(&mesh, coarse, element, xi), at(&division.mesh, fine, own, point)];
                        assert!((0..3).all(|d| (a[d] - b[d]).abs() < 1e-13), "{}: {a:?} {b:?}", mesh.words());
                    }
                    let linear = |c: [f64; 4], xi: [f64; 3]| c[0] + c[1] * xi[0] + c[2] * xi[1] + c[3] * xi[2];
                    let [a, b] = [linear([0.3, -1.0, 2.0, 0.7], xi), linear(pressures[part], point)];
                    assert!((a - b).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn a_line_of_nodes_is_refined_and_torn_elements_are_refused() {
        let mut mesh = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(ElementKind::Hex20);
        mesh.node_sets.insert("line".into(), mesh.select_nodes(|x| x[1] == 0.0 && x[2] == 0.0));
        let fine = mesh.divided().unwrap().mesh;
        assert_eq!((mesh.node_set("line").len(), fine.node_set("line").len()), (5, 9));
        // The second element has a node of its own in the middle of an edge that both have.
        let ends = mesh.select_nodes(|x| x[0] == 1.0 && x[1] == 0.5);
        let second = mesh.kinds.range(1);
        mesh.nodes.push(mesh.nodes[ends[0] as usize]);
        let own = mesh.num_nodes() as u32 - 1;
        mesh.connectivity[second].iter_mut().filter(|node| **node == ends[0]).for_each(|node| *node = own);
        assert_eq!(mesh.divided().unwrap_err(), Torn([ends[0], own]));
    }
}
