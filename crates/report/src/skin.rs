//! The surface of the body as triangles, and the lines drawn on it.

use std::collections::BTreeMap;

use pneuflex_mesh::family::ElementFamily;
use pneuflex_mesh::{Facet, Mesh};

use crate::body::{Block, Body};
use crate::subdivision::face_triangles;

/// Cosine of the angle, 40°, between neighbouring faces from which the edge between them is sharp.
const SHARP: f64 = 0.766;

/// Surface and lines, in three parts: the outside, the cavity, and what lies in the symmetry plane of a half model. Each can so
/// be left out at the end of a list: the last when both halves are shown, the cavity too where only the outside matters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Node of every vertex of the surface. A node at a sharp edge has a vertex for each side, with a normal of its own.
    pub vertices: Vec<u32>,
    /// Vertices of the triangles; the normal points out of the body.
    pub triangles: Vec<[u32; 3]>,
    /// Number of triangles of the outside, and of those with the cavity's.
    pub parts: [usize; 2],
    /// Edges of the elements on the surface, as pairs of nodes.
    pub mesh_edges: Lines,
    /// Sharp edges of the body, as pairs of nodes.
    pub sharp_edges: Lines,
}

/// Lines as pairs of nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Nodes at both ends.
    pub pairs: Vec<Pair>,
    /// Number of lines of the outside, and of those with the cavity's.
    pub parts: [usize; 2],
}

/// Nodes at both ends of a line.
pub type Pair = [u32; 2];

/// An element's edge on the surface, with all the faces around it.
#[derive(Default)]
struct Edge {
    lines: Vec<Pair>,
    sides: Vec<EdgeSide>,
}

/// A side of an element's edge on the surface.
struct EdgeSide {
    normal: [f64; 3],
    part: usize,
}

impl Skin {
    /// The surface of a body made from `mesh`, whose air is behind the facets `cavity`, and whose other parts, if it has some,
    /// begin at the nodes of every plane of `symmetry`.
    pub fn new(mesh: &Mesh, cavity: &[Facet], symmetry: &[&[u32]], body: &Body) -> Self {
        let facets = parts(mesh, cavity, symmetry);
        let mut local: Vec<(&ElementFamily, Vec<Vec<[u8; 3]>>)> = Vec::new();
        for Block { family, .. } in body.blocks() {
            local.push((family, face_triangles(family)));
        }
        let mut of_node = vec![Vec::new(); body.nodes.len()];
        let mut skin = Self::default();
        for (part, facets) in facets.iter().enumerate() {
            for facet in facets {
                let (family, nodes) = body.element(facet.element as usize);
                let faces =
                    local.iter().find(|(known, _)| std::ptr::eq(*known, family)).map_or(&[][..], |(_, faces)| faces);
                for triangle in &faces[usize::from(facet.face)] {
                    let nodes = triangle.map(|n| nodes[usize::from(n)]);
                    let normal = normal(nodes.map(|n| body.nodes[n as usize]));
                    let vertices = nodes.map(|n| vertex(&mut skin.vertices, &mut of_node[n as usize], n, normal));
                    skin.triangles.push(vertices);
                }
            }
            if let Some(count) = skin.parts.get_mut(part) {
                *count = skin.triangles.len();
            }
        }
        skin.draw_edges(mesh, &facets);
        skin
    }

    fn draw_edges(&mut self, mesh: &Mesh, facets: &[Vec<Facet>; 3]) {
        let mut edges: BTreeMap<Pair, Edge> = BTreeMap::new();
        for (part, facet) in facets.iter().enumerate().flat_map(|(part, list)| list.iter().map(move |f| (part, f))) {
            let nodes = mesh.facet_nodes(*facet);
            let at = |i: usize| mesh.nodes[nodes[i] as usize];
            let normal = normal([at(0), at(1), at(2)]);
            let kind = mesh.face_kind(*facet);
            for (i, ends) in kind.edges().enumerate() {
                let [a, b] = ends.map(|n| nodes[n]);
                // With a node in the middle, the edge is drawn as two lines.
                let edge = edges.entry([a.min(b), a.max(b)]).or_default();
                edge.lines = match kind.middle_of_edge(i).map(|n| nodes[n]) {
                    Some(middle) => vec![[a, middle], [middle, b]],
                    None => vec![[a, b]],
                };
                edge.sides.push(EdgeSide { normal, part });
            }
        }
        let [mut of_mesh, mut sharp]: [[Vec<Pair>; 3]; 2] = Default::default();
        for Edge { lines, sides } in edges.into_values() {
            let first = sides.iter().map(|side| side.part).min().unwrap_or(0);
            of_mesh[first].extend(&lines);
            if sides.iter().any(|s| sides.iter().any(|t| dot(s.normal, t.normal) < SHARP)) {
                // The rim of the symmetry plane is an edge of the half alone.
                let in_plane = sides.iter().any(|side| side.part == 2);
                sharp[if in_plane { 2 } else { first }].extend(&lines);
            }
        }
        (self.mesh_edges, self.sharp_edges) = (Lines::new(&of_mesh), Lines::new(&sharp));
    }
}

impl Lines {
    fn new(parts: &[Vec<Pair>; 3]) -> Self {
        let outside = parts[0].len();
        Self { pairs: parts.concat(), parts: [outside, outside + parts[1].len()] }
    }
}

/// The facets of the boundary: outside, cavity, planes of symmetry.
fn parts(mesh: &Mesh, cavity: &[Facet], symmetry: &[&[u32]]) -> [Vec<Facet>; 3] {
    // A bit for each plane.
    let mut in_planes = vec![0_u8; mesh.num_nodes()];
    for (bit, nodes) in symmetry.iter().enumerate() {
        nodes.iter().for_each(|&node| in_planes[node as usize] |= 1 << bit);
    }
    let mut cavity = cavity.to_vec();
    cavity.sort_unstable();
    let mut parts: [Vec<Facet>; 3] = Default::default();
    for facet in mesh.boundary_facets() {
        let in_symmetry =
            mesh.facet_nodes(facet).iter().fold(u8::MAX, |planes, &n| planes & in_planes[n as usize]) != 0;
        let part = if in_symmetry { 2 } else { usize::from(cavity.binary_search(&facet).is_ok()) };
        parts[part].push(facet);
    }
    parts
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
    use pneuflex_model::Formulation;
    use pneuflex_post::measures;

    #[test]
    fn the_skin_encloses_the_body() {
        for formulation in Formulation::ALL {
            let problem = two_chambers(formulation);
            let (mesh, body) = (&problem.mesh, Body::new(&problem.mesh));
            let skin = Skin::new(mesh, &problem.cavity_facets(), &[mesh.node_set("symmetry")], &body);
            let at = |vertex: u32| body.nodes[skin.vertices[vertex as usize] as usize];
            let cone = |t: &[u32; 3]| volume([[0.0; 3], at(t[0]), at(t[1]), at(t[2])]);
            let sum: f64 = skin.triangles.iter().map(cone).sum();
            assert!((sum / mesh.volume() - 1.0).abs() < 1e-12, "{formulation}: {sum}");
            // Triangles of the symmetry plane y = 0, and they alone, come last.
            for (i, triangle) in skin.triangles.iter().enumerate() {
                let in_plane = triangle.iter().all(|&v| at(v)[1] == 0.0);
                assert_eq!(in_plane, i >= skin.parts[1]);
            }
            // The outside with the part of the plane it cuts encloses body and air: the air is as large as it should be.
            let air: f64 = skin.triangles[skin.parts[0]..skin.parts[1]].iter().map(cone).sum();
            let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
            assert!((2.0 * air + measures::cavity_volume(&problem, &rest).unwrap()).abs() < 1e-9, "{air}");
        }
    }

    #[test]
    fn sharp_edges_are_those_between_flat_sides() {
        let problem = two_chambers(Formulation::Hex27);
        let mesh = &problem.mesh;
        let skin = Skin::new(mesh, &problem.cavity_facets(), &[mesh.node_set("symmetry")], &Body::new(mesh));
        // Every side of this body is in a plane across an axis: along a sharp edge two coordinates stay.
        for [a, b] in &skin.sharp_edges.pairs {
            let (a, b) = (mesh.nodes[*a as usize], mesh.nodes[*b as usize]);
            assert_eq!((0..3).filter(|&d| a[d] == b[d]).count(), 2);
        }
        let rim = &skin.sharp_edges.pairs[skin.sharp_edges.parts[1]..];
        assert!(!rim.is_empty() && rim.iter().flatten().all(|&n| mesh.nodes[n as usize][1] == 0.0));
        assert!(skin.mesh_edges.pairs.len() > skin.sharp_edges.pairs.len());
    }
}
