//! The surface of the body as triangles, and the lines drawn on it.

use std::collections::BTreeMap;

use pneuflex_mesh::family::ElementFamily;
use pneuflex_mesh::{Facet, Mesh};
use serde::Serialize;

use crate::body::{Block, Body};
use crate::regions::Regions;
use crate::subdivision::face_triangles;

/// Cosine of the angle, 40°, between neighbouring faces from which the edge between them is sharp.
const SHARP: f64 = 0.766;

/// Surface and lines, in runs that are shown or left out together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Node of every vertex of the surface. A node at a sharp edge has a vertex for each side, with a normal of its own.
    pub vertices: Vec<u32>,
    /// Vertices of the triangles; the normal points out of the body, at an interface out of the region.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles' runs, outside first, then the walls around air.
    pub runs: Vec<Run>,
    /// Edges of the elements on the surface, as pairs of nodes.
    pub mesh_edges: Lines,
    /// Sharp edges of the body, and borders between regions, as pairs of nodes.
    pub sharp_edges: Lines,
}

/// Which side of the body a part of its surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// What is seen from outside.
    Outside,
    /// The walls of cavities.
    Air,
    /// What lies in a plane of symmetry: there is none of it where the images of the part are shown, too.
    Symmetry,
    /// Between two regions: there is none of it unless the other one is hidden.
    Interface,
}

/// Triangles or lines that follow each other and are shown together.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Run {
    /// Where they are.
    pub side: Side,
    /// Regions that they belong to: it is enough that one of them is shown.
    pub regions: Vec<u16>,
    /// The region on the other side of an interface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond: Option<u16>,
    /// How many they are.
    pub count: usize,
}

/// Lines as pairs of nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Nodes at both ends.
    pub pairs: Vec<Pair>,
    /// Their runs.
    pub runs: Vec<Run>,
}

/// Nodes at both ends of a line.
pub type Pair = [u32; 2];

/// A facet of the surface of a region.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Piece {
    side: Side,
    region: u16,
    beyond: Option<u16>,
    facet: Facet,
}

/// An element's edge on the surface, with all the faces around it.
#[derive(Default)]
struct Edge {
    lines: Vec<Pair>,
    faces: Vec<([f64; 3], Piece)>,
}

impl Skin {
    /// The surface of a body made from `mesh`, whose air is behind the facets `cavity`, and whose other parts, if it has some,
    /// begin at the nodes of every plane of `symmetry`.
    pub fn new(mesh: &Mesh, cavity: &[Facet], symmetry: &[&[u32]], regions: &Regions, body: &Body) -> Self {
        let mut pieces = boundary(mesh, cavity, symmetry, regions);
        pieces.extend(interfaces(mesh, regions));
        pieces.sort_unstable();
        let mut skin = Self::default();
        skin.draw_triangles(body, &pieces);
        skin.draw_edges(mesh, &pieces);
        skin
    }

    /// The triangles of a side.
    pub fn triangles_of(&self, side: Side) -> impl Iterator<Item = [u32; 3]> {
        let sides = self.runs.iter().flat_map(|run| std::iter::repeat_n(run.side, run.count));
        self.triangles.iter().zip(sides).filter(move |(_, found)| *found == side).map(|(triangle, _)| *triangle)
    }

    fn draw_triangles(&mut self, body: &Body, pieces: &[Piece]) {
        let local: Vec<(&ElementFamily, Vec<Vec<[u8; 3]>>)> =
            body.blocks().iter().map(|Block { family, .. }| (*family, face_triangles(family))).collect();
        let mut of_node = vec![Vec::new(); body.nodes.len()];
        for alike in pieces.chunk_by(|a, b| (a.side, a.region, a.beyond) == (b.side, b.region, b.beyond)) {
            let before = self.triangles.len();
            for Piece { facet, .. } in alike {
                let (family, nodes) = body.element(facet.element as usize);
                let faces =
                    local.iter().find(|(known, _)| std::ptr::eq(*known, family)).map_or(&[][..], |(_, faces)| faces);
                for triangle in &faces[usize::from(facet.face)] {
                    let nodes = triangle.map(|n| nodes[usize::from(n)]);
                    let normal = normal(nodes.map(|n| body.nodes[n as usize]));
                    let vertices = nodes.map(|n| vertex(&mut self.vertices, &mut of_node[n as usize], n, normal));
                    self.triangles.push(vertices);
                }
            }
            let Piece { side, region, beyond, .. } = alike[0];
            self.runs.push(Run { side, regions: vec![region], beyond, count: self.triangles.len() - before });
        }
    }

    fn draw_edges(&mut self, mesh: &Mesh, pieces: &[Piece]) {
        // The edges of an interface are no edges of the body, which does not end there.
        type Owner = Option<(u16, Option<u16>)>;
        let mut edges: BTreeMap<(Owner, Pair), Edge> = BTreeMap::new();
        for piece in pieces {
            let nodes = mesh.facet_nodes(piece.facet);
            let at = |i: usize| mesh.nodes[nodes[i] as usize];
            let normal = normal([at(0), at(1), at(2)]);
            let kind = mesh.face_kind(piece.facet);
            let owner = piece.beyond.map(|beyond| (piece.region, Some(beyond)));
            for (i, ends) in kind.edges().enumerate() {
                let [a, b] = ends.map(|n| nodes[n]);
                // With a node in the middle, the edge is drawn as two lines.
                let edge = edges.entry((owner, [a.min(b), a.max(b)])).or_default();
                edge.lines = match kind.middle_of_edge(i).map(|n| nodes[n]) {
                    Some(middle) => vec![[a, middle], [middle, b]],
                    None => vec![[a, b]],
                };
                edge.faces.push((normal, *piece));
            }
        }
        let [mut of_mesh, mut sharp]: [BTreeMap<Run, Vec<Pair>>; 2] = Default::default();
        for edge in edges.into_values() {
            of_mesh.entry(edge.run(false)).or_default().extend(&edge.lines);
            if edge.is_sharp() {
                sharp.entry(edge.run(true)).or_default().extend(&edge.lines);
            }
        }
        (self.mesh_edges, self.sharp_edges) = (Lines::new(of_mesh), Lines::new(sharp));
    }
}

impl Edge {
    /// The run that it belongs to, as yet without a count.
    fn run(&self, is_sharp: bool) -> Run {
        let mut sides: Vec<Side> = self.faces.iter().map(|(_, piece)| piece.side).collect();
        sides.sort_unstable();
        // The rim of the symmetry plane is a sharp edge of the half alone.
        let side = if is_sharp && sides.contains(&Side::Symmetry) { Side::Symmetry } else { sides[0] };
        let mut regions: Vec<u16> = self.faces.iter().map(|(_, piece)| piece.region).collect();
        regions.sort_unstable();
        regions.dedup();
        Run { side, regions, beyond: self.faces[0].1.beyond, count: 0 }
    }

    /// Whether its faces meet at an angle, or belong to two regions.
    fn is_sharp(&self) -> bool {
        let [first, rest @ ..] = &self.faces[..] else { return false };
        rest.iter().any(|(_, piece)| piece.region != first.1.region)
            || self.faces.iter().any(|(n, _)| self.faces.iter().any(|(m, _)| dot(*n, *m) < SHARP))
    }
}

impl Lines {
    fn new(found: BTreeMap<Run, Vec<Pair>>) -> Self {
        let runs = found.iter().map(|(run, pairs)| Run { count: pairs.len(), ..run.clone() }).collect();
        Self { runs, pairs: found.into_values().flatten().collect() }
    }
}

/// The facets of the boundary: outside, cavity, planes of symmetry.
fn boundary(mesh: &Mesh, cavity: &[Facet], symmetry: &[&[u32]], regions: &Regions) -> Vec<Piece> {
    let in_symmetry = in_planes(mesh, symmetry);
    let mut cavity = cavity.to_vec();
    cavity.sort_unstable();
    let piece = |facet: Facet| {
        let side = match cavity.binary_search(&facet) {
            _ if in_symmetry(facet) => Side::Symmetry,
            Ok(_) => Side::Air,
            Err(_) => Side::Outside,
        };
        Piece { side, region: regions.of_element(facet.element), beyond: None, facet }
    };
    mesh.boundary_facets().into_iter().map(piece).collect()
}

/// Whether a facet lies in one of the planes whose nodes are given.
pub(crate) fn in_planes(mesh: &Mesh, planes: &[&[u32]]) -> impl Fn(Facet) -> bool {
    // A bit for each plane.
    let mut of_node = vec![0_u8; mesh.num_nodes()];
    for (bit, nodes) in planes.iter().enumerate() {
        nodes.iter().for_each(|&node| of_node[node as usize] |= 1 << bit);
    }
    move |facet| mesh.facet_nodes(facet).iter().fold(u8::MAX, |planes, &n| planes & of_node[n as usize]) != 0
}

/// Both sides of the faces between elements of two regions.
fn interfaces(mesh: &Mesh, regions: &Regions) -> Vec<Piece> {
    if !regions.are_many() {
        return Vec::new();
    }
    let between = |facets: [Facet; 2]| {
        let [a, b] = facets.map(|facet| regions.of_element(facet.element));
        let piece = |facet, region, beyond| Piece { side: Side::Interface, region, beyond: Some(beyond), facet };
        (a != b).then(|| [piece(facets[0], a, b), piece(facets[1], b, a)])
    };
    mesh.shared_faces().into_iter().filter_map(between).flatten().collect()
}

/// The vertex of `node` for triangles with about this normal; a new one if there is none yet.
fn vertex(vertices: &mut Vec<u32>, of_node: &mut Vec<(u32, [f64; 3])>, node: u32, normal: [f64; 3]) -> u32 {
    if let Some((vertex, _)) = of_node.iter().find(|(_, other)| dot(*other, normal) >= SHARP) {
        return *vertex;
    }
    let vertex = vertices.len() as u32;
    vertices.push(node);
    of_node.push((vertex, normal));
    vertex
}

fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let minus = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| p[d] - a[d]) };
    let (u, v) = (minus(b), minus(c));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = dot(n, n).sqrt();
    n.map(|x| x / length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subdivision::volume;
    use crate::testing::two_chambers;
    use pneuflex_model::{Formulation, Problem, Region};
    use pneuflex_post::measures;

    /// Two chambers with the lowest layer of elements as a region of its own.
    fn with_layer(formulation: Formulation) -> Problem {
        let mut problem = two_chambers(formulation);
        let mesh = &problem.mesh;
        let is_low =
            |element: &u32| mesh.element(*element as usize).iter().all(|&node| mesh.nodes[node as usize][2] < 2.1);
        let elements = (0..mesh.num_elements() as u32).filter(is_low).collect();
        problem.regions.push(Region { name: "layer".into(), elements, material: problem.material.clone() });
        problem
    }

    fn skin_of(problem: &Problem, body: &Body) -> Skin {
        let planes = [problem.mesh.node_set("symmetry")];
        Skin::new(&problem.mesh, &problem.cavity_facets(), &planes, &Regions::of(problem), body)
    }

    /// Volume of the cones from the origin to triangles.
    fn cones(skin: &Skin, body: &Body, triangles: impl Iterator<Item = [u32; 3]>) -> f64 {
        let at = |vertex: u32| body.nodes[skin.vertices[vertex as usize] as usize];
        triangles.map(|t| volume([[0.0; 3], at(t[0]), at(t[1]), at(t[2])])).sum()
    }

    #[test]
    fn the_skin_encloses_the_body() {
        for formulation in Formulation::ALL {
            let problem = two_chambers(formulation);
            let (mesh, body) = (&problem.mesh, Body::new(&problem.mesh));
            let skin = skin_of(&problem, &body);
            let sum = cones(&skin, &body, skin.triangles.iter().copied());
            assert!((sum / mesh.volume() - 1.0).abs() < 1e-12, "{formulation}: {sum}");
            // Triangles of the symmetry plane y = 0, and they alone, are on that side.
            assert_eq!(
                skin.runs.iter().map(|run| run.side).collect::<Vec<_>>(),
                [Side::Outside, Side::Air, Side::Symmetry]
            );
            let first = skin.triangles.len() - skin.runs[2].count;
            for (i, triangle) in skin.triangles.iter().enumerate() {
                let in_plane = triangle.iter().all(|&v| body.nodes[skin.vertices[v as usize] as usize][1] == 0.0);
                assert_eq!(in_plane, i >= first);
            }
            // The outside with the part of the plane it cuts encloses body and air: the air is as large as it should be.
            let air = cones(&skin, &body, skin.triangles_of(Side::Air));
            let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
            assert!((2.0 * air + measures::cavity_volume(&problem, &rest).unwrap()).abs() < 1e-9, "{air}");
        }
    }

    #[test]
    fn every_region_is_enclosed_by_its_own_surface() {
        for formulation in [Formulation::Hex8Sri, Formulation::Tet15] {
            let problem = with_layer(formulation);
            let body = Body::new(&problem.mesh);
            let skin = skin_of(&problem, &body);
            let mut starts = vec![0];
            skin.runs.iter().for_each(|run| starts.push(starts[starts.len() - 1] + run.count));
            let layer = &problem.regions[0].elements;
            let volumes = [problem.mesh.volume(), problem.mesh.volume_of(layer.iter().copied())];
            for (region, expected) in [(0, volumes[0] - volumes[1]), (1, volumes[1])] {
                let own = skin.runs.iter().enumerate().filter(|(_, run)| run.regions == [region]);
                let triangles = own.flat_map(|(i, _)| skin.triangles[starts[i]..starts[i + 1]].iter().copied());
                let sum = cones(&skin, &body, triangles);
                assert!((sum / expected - 1.0).abs() < 1e-12, "{formulation}: {sum} instead of {expected}");
            }
            let borders = skin.sharp_edges.runs.iter().filter(|run| run.regions == [0, 1]).map(|run| run.count);
            assert!(borders.sum::<usize>() > 0);
        }
    }

    #[test]
    fn sharp_edges_are_those_between_flat_sides() {
        let problem = two_chambers(Formulation::Hex27);
        let mesh = &problem.mesh;
        let skin = skin_of(&problem, &Body::new(mesh));
        // Every side of this body is in a plane across an axis: along a sharp edge two coordinates stay.
        for [a, b] in &skin.sharp_edges.pairs {
            let (a, b) = (mesh.nodes[*a as usize], mesh.nodes[*b as usize]);
            assert_eq!((0..3).filter(|&d| a[d] == b[d]).count(), 2);
        }
        let last = skin.sharp_edges.runs.last().unwrap();
        assert_eq!(last.side, Side::Symmetry);
        let rim = &skin.sharp_edges.pairs[skin.sharp_edges.pairs.len() - last.count..];
        assert!(!rim.is_empty() && rim.iter().flatten().all(|&n| mesh.nodes[n as usize][1] == 0.0));
        assert!(skin.mesh_edges.pairs.len() > skin.sharp_edges.pairs.len());
    }
}
