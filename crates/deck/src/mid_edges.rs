//! Elements that come with their corners alone as quadratic ones: mid-edge nodes, and which of them belong to a set.

use std::collections::BTreeMap;

use pneuflex_mesh::{ElementKind, Mesh, ReferenceBody};

/// The mesh of elements with their nodes. Those that have their corners alone get straight mid-edge nodes where their family has some, which
/// elements share; new nodes come after the old ones, in the order of the elements. Beside elements of other families linear hexahedra get
/// them, too: only quadratic elements fit together.
///
/// There must be an element.
pub(crate) fn completed_mesh(mut nodes: Vec<[f64; 3]>, elements: &[(ElementKind, Vec<u32>)]) -> Mesh {
    let is_mixed = elements.iter().any(|(kind, _)| *kind != elements[0].0);
    let solved = |kind: ElementKind| if is_mixed && kind == ElementKind::Hex8 { ElementKind::Hex20 } else { kind };
    let is_complete = |(kind, nodes): &(ElementKind, Vec<u32>)| nodes.len() == solved(*kind).num_nodes();
    let ends = |[a, b]: [usize; 2], nodes: &[u32]| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
    let mut of_edge: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    if !elements.iter().all(is_complete) {
        for (kind, nodes) in elements.iter().filter(|element| is_complete(element) && element.0.is_quadratic()) {
            let middles = &nodes[kind.num_corners()..];
            of_edge.extend(kind.edges().iter().zip(middles).map(|(&edge, &middle)| (ends(edge, nodes), middle)));
        }
    }
    let mut connectivity = Vec::new();
    for element in elements {
        connectivity.extend_from_slice(&element.1);
        if is_complete(element) {
            continue;
        }
        for &edge in solved(element.0).edges() {
            let [a, b] = ends(edge, &element.1);
            let next = nodes.len() as u32;
            let node = *of_edge.entry([a, b]).or_insert(next);
            if node == next {
                // As the element runs from one to the other: to the last digit what it was.
                let [xa, xb] = edge.map(|corner| nodes[element.1[corner] as usize]);
                nodes.push(std::array::from_fn(|i| 0.5 * (xa[i] + xb[i])));
            }
            connectivity.push(node);
        }
    }
    Mesh {
        kinds: elements.iter().map(|(kind, _)| solved(*kind)).collect(),
        nodes,
        connectivity,
        node_sets: BTreeMap::new(),
        facet_sets: BTreeMap::new(),
        element_sets: BTreeMap::new(),
    }
}

/// Two elements whose faces lie on each other but do not fit, a quadrilateral on triangles, and the middle of the quadrilateral.
pub(crate) fn unmatched_elements(mesh: &Mesh) -> Option<([usize; 2], [f64; 3])> {
    let [quadrilateral, triangle] = mesh.unmatched_faces()?;
    let corners = &mesh.facet_nodes(quadrilateral)[..4];
    let middle = std::array::from_fn(|d| 0.25 * corners.iter().map(|&node| mesh.nodes[node as usize][d]).sum::<f64>());
    Some(([quadrilateral, triangle].map(|facet| facet.element as usize), middle))
}

/// What those who write such meshes can do about it.
pub(crate) const UNMATCHED: &str =
    "the two are not joined there; put wedges between hexahedra and tetrahedra, or divide both into tetrahedra";

/// What a mesh of elements that are not all of one body is solved with, in words.
pub(crate) fn note_on_families(mesh: &Mesh) -> Option<String> {
    let bodies: Vec<ReferenceBody> = mesh.families().iter().map(|kind| kind.body).collect();
    (bodies.iter().any(|body| *body != bodies[0])).then(|| {
        "elements of several kinds are solved together as quadratic ones with nodes in their faces, which fit; those with corners alone get \
         straight mid-edge nodes"
            .to_owned()
    })
}

/// Edges whose mid-edge node may belong to a set of corners.
///
/// A deck of linear elements marks a piece of the surface, an edge of the body or a piece of its inside by corners alone. If both ends
/// of an edge are marked, so is the edge, but not always: in a thin wall both sides of which are marked, edges run from one side to
/// the other through the inside, which nobody marked; a support that held their middle would stiffen the wall. So an edge counts if
/// it lies on the surface of the body, or belongs to an element all of whose corners are marked and which does not reach the surface
/// on both sides: one that has a corner inside the body. Nodes that the deck has itself count where it names them.
#[derive(Debug)]
pub(crate) struct MidEdges {
    /// Ends and middle of edges on the surface.
    surface: Vec<[u32; 3]>,
    /// Elements with a corner inside the body: corners and added mid-edge nodes.
    inner: Vec<[Vec<u32>; 2]>,
}

impl MidEdges {
    /// Of a mesh whose nodes from `first_added` on are added mid-edge nodes.
    pub fn new(mesh: &Mesh, first_added: u32) -> Self {
        let mut on_surface = vec![false; mesh.num_nodes()];
        let mut surface = Vec::new();
        for facet in mesh.boundary_facets() {
            let (kind, nodes) = (mesh.face_kind(facet), mesh.facet_nodes(facet));
            for (edge, [a, b]) in kind.edges().enumerate() {
                on_surface[nodes[a] as usize] = true;
                if let Some(middle) = kind.middle_of_edge(edge).map(|i| nodes[i]).filter(|&node| node >= first_added) {
                    surface.push([nodes[a].min(nodes[b]), nodes[a].max(nodes[b]), middle]);
                }
            }
        }
        surface.sort_unstable();
        surface.dedup();
        let elements = (0..mesh.num_elements()).map(|element| {
            let (corners, others) = mesh.element(element).split_at(mesh.kind_of(element).num_corners());
            [corners.to_vec(), others.iter().copied().filter(|&node| node >= first_added).collect()]
        });
        let inner = elements.filter(|[corners, _]| corners.iter().any(|&n| !on_surface[n as usize])).collect();
        Self { surface, inner }
    }

    /// A set's mid-edge nodes, in ascending order.
    pub fn of(&self, is_marked: impl Fn(u32) -> bool) -> Vec<u32> {
        let on_surface = self.surface.iter().filter(|[a, b, _]| is_marked(*a) && is_marked(*b)).map(|edge| edge[2]);
        let inside = self.inner.iter().filter(|[corners, _]| corners.iter().all(|&n| is_marked(n)));
        let mut found: Vec<u32> = on_surface.chain(inside.flat_map(|[_, middles]| middles.iter().copied())).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}
