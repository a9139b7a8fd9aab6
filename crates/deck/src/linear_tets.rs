//! Linear tetrahedra as quadratic ones: mid-edge nodes, and which of them belong to a set.

use std::collections::BTreeMap;

use pneuflex_mesh::Mesh;

/// Turns a mesh of elements given by their corners into one with straight mid-edge nodes, which elements share. New nodes come after
/// the old ones, in the order of the elements.
pub(crate) fn add_mid_edge_nodes(mesh: &mut Mesh) {
    let mut of_edge: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut connectivity = Vec::new();
    for corners in mesh.connectivity.chunks_exact(mesh.kind.num_corners()) {
        connectivity.extend_from_slice(corners);
        for &[a, b] in mesh.kind.edges() {
            let (a, b) = (corners[a], corners[b]);
            let next = mesh.nodes.len() as u32;
            let node = *of_edge.entry([a.min(b), a.max(b)]).or_insert(next);
            if node == next {
                let [xa, xb] = [a, b].map(|corner| mesh.nodes[corner as usize]);
                mesh.nodes.push(std::array::from_fn(|i| 0.5 * (xa[i] + xb[i])));
            }
            connectivity.push(node);
        }
    }
    mesh.connectivity = connectivity;
}

/// Edges whose mid-edge node may belong to a set of corners.
///
/// A deck of linear tetrahedra marks a piece of the surface, an edge of the body or a piece of its inside by corners alone. If both ends
/// of an edge are marked, so is the edge, but not always: in a thin wall both sides of which are marked, edges run from one side to
/// the other through the inside, which nobody marked; a support that held their middle would stiffen the wall. So an edge counts if
/// it lies on the surface of the body, or belongs to a tetrahedron all of whose corners are marked and which does not reach the surface
/// on both sides: one that has a corner inside the body.
#[derive(Debug)]
pub(crate) struct MidEdges {
    /// Ends and middle of edges on the surface.
    surface: Vec<[u32; 3]>,
    /// Tetrahedra with a corner inside the body: corners and mid-edge nodes.
    inner: Vec<[u32; 10]>,
}

impl MidEdges {
    /// Of a mesh of quadratic tetrahedra.
    pub fn new(mesh: &Mesh) -> Self {
        let mut on_surface = vec![false; mesh.num_nodes()];
        let mut surface = Vec::new();
        for facet in mesh.boundary_facets() {
            let nodes = mesh.facet_nodes(facet);
            for i in 0..3 {
                on_surface[nodes[i] as usize] = true;
                let (a, b) = (nodes[i], nodes[(i + 1) % 3]);
                surface.push([a.min(b), a.max(b), nodes[3 + i]]);
            }
        }
        surface.sort_unstable();
        surface.dedup();
        let elements = (0..mesh.num_elements()).filter_map(|element| mesh.element(element).try_into().ok());
        let inner = elements.filter(|nodes: &[u32; 10]| nodes[..4].iter().any(|&n| !on_surface[n as usize])).collect();
        Self { surface, inner }
    }

    /// A set's mid-edge nodes, in ascending order.
    pub fn of(&self, is_marked: impl Fn(u32) -> bool) -> Vec<u32> {
        let on_surface = self.surface.iter().filter(|[a, b, _]| is_marked(*a) && is_marked(*b)).map(|edge| edge[2]);
        let inside = self.inner.iter().filter(|nodes| nodes[..4].iter().all(|&n| is_marked(n)));
        let mut found: Vec<u32> = on_surface.chain(inside.flat_map(|nodes| nodes[4..].iter().copied())).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}
