//! Meshes of relations, made from those of a draw: the whole of a half, finer ones, others of the same order.

use std::collections::BTreeMap;

use pneuflex::mesh::shape::tabulate;
use pneuflex::mesh::{ElementKind, Facet, Mesh};

use super::frame::inside_out;

/// A mesh y ≥ 0 together with its mirror image.
pub fn whole(half: &Mesh) -> Mesh {
    let image = inside_out(half.clone().map_nodes(|[x, y, z]| [x, -y, z]));
    let mut whole = half.clone();
    // Where the image's nodes are among those of the whole.
    let mut place = Vec::new();
    for (node, &x) in image.nodes.iter().enumerate() {
        if x[1].abs() < 1e-9 {
            place.push(node as u32);
        } else {
            place.push(whole.nodes.len() as u32);
            whole.nodes.push(x);
        }
    }
    let elements = half.num_elements() as u32;
    whole.kinds =
        [half, &image].into_iter().flat_map(|mesh| (0..mesh.num_elements()).map(|e| mesh.kind_of(e))).collect();
    whole.connectivity.extend(image.connectivity.iter().map(|&node| place[node as usize]));
    for (name, set) in &image.node_sets {
        let both = whole.node_sets.entry(name.clone()).or_default();
        both.extend(set.iter().map(|&node| place[node as usize]));
        both.sort_unstable();
        both.dedup();
    }
    for (name, set) in &image.facet_sets {
        let moved = set.iter().map(|facet| Facet { element: facet.element + elements, face: facet.face });
        whole.facet_sets.entry(name.clone()).or_default().extend(moved);
    }
    for (name, set) in &image.element_sets {
        whole.element_sets.entry(name.clone()).or_default().extend(set.iter().map(|element| element + elements));
    }
    whole
}

/// The elements without the nodes in their faces and inside: hexahedra of 20 nodes for those of 27, tetrahedra of 10 for those of 15, wedges
/// of 15 for those of 21.
pub fn without_added_nodes(mesh: &Mesh) -> Mesh {
    let poorer = |kind: ElementKind| kind.enriches.first().copied().unwrap_or(kind);
    let kept = |element: usize| &mesh.element(element)[..poorer(mesh.kind_of(element)).num_nodes()];
    let connectivity: Vec<u32> = (0..mesh.num_elements()).flat_map(|element| kept(element).to_vec()).collect();
    let mut number = vec![u32::MAX; mesh.num_nodes()];
    connectivity.iter().for_each(|&node| number[node as usize] = 0);
    let kept: Vec<usize> = (0..number.len()).filter(|&node| number[node] == 0).collect();
    kept.iter().zip(0..).for_each(|(&node, new)| number[node] = new);
    let renumbered =
        |set: &Vec<u32>| set.iter().map(|&node| number[node as usize]).filter(|&new| new != u32::MAX).collect();
    Mesh {
        kinds: (0..mesh.num_elements()).map(|element| poorer(mesh.kind_of(element))).collect(),
        nodes: kept.iter().map(|&node| mesh.nodes[node]).collect(),
        connectivity: connectivity.iter().map(|&node| number[node as usize]).collect(),
        node_sets: mesh.node_sets.iter().map(|(name, set)| (name.clone(), renumbered(set))).collect(),
        facet_sets: mesh.facet_sets.clone(),
        element_sets: mesh.element_sets.clone(),
    }
}

/// Eight hexahedra for every one of a mesh that has no other elements, on the same surface. Sets of faces and elements are those of the same parts; nodes of sets are those that
/// were there.
pub fn refined(mesh: &Mesh) -> Mesh {
    /// Places on an element in quarters of its edges: exact, so that neighbours agree on the nodes that they share.
    type Place = [usize; 3];
    let family = mesh.kind_of(0);
    let shapes: BTreeMap<Place, Vec<f64>> = (0..125)
        .map(|i| [i % 5, i / 5 % 5, i / 25])
        .map(|place| (place, tabulate(family, place.map(|q| 0.5 * q as f64 - 1.0)).0))
        .collect();
    let place_of = |child: Place, node: &[f64; 3]| -> Place {
        std::array::from_fn(|d| 2 * child[d] + (node[d] + 1.0).round() as usize)
    };
    // Nodes that are shared have the same parents with the same weights.
    let mut numbers: BTreeMap<Vec<(u32, u64)>, u32> = BTreeMap::new();
    let mut fine = Mesh { nodes: Vec::new(), connectivity: Vec::new(), ..mesh.clone() };
    let mut node_at = |nodes: &[u32], place: Place, all: &mut Vec<[f64; 3]>| -> u32 {
        let weights = &shapes[&place];
        let mut parents: Vec<(u32, f64)> = nodes.iter().copied().zip(weights.iter().copied()).collect();
        parents.retain(|(_, weight)| weight.abs() > 1e-12);
        parents.sort_unstable_by_key(|(node, _)| *node);
        let key = parents.iter().map(|(node, weight)| (*node, (1e6 * (weight + 2.0)).round() as u64)).collect();
        *numbers.entry(key).or_insert_with(|| {
            let at = |d: usize| parents.iter().map(|&(node, weight)| weight * mesh.nodes[node as usize][d]).sum();
            all.push([at(0), at(1), at(2)]);
            all.len() as u32 - 1
        })
    };
    let children: Vec<Place> = (0..8).map(|i| [i % 2, i / 2 % 2, i / 4]).collect();
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        for &child in &children {
            for node in family.nodes {
                let number = node_at(nodes, place_of(child, node), &mut fine.nodes);
                fine.connectivity.push(number);
            }
        }
    }
    // The nodes that were there.
    let mut number = vec![0; mesh.num_nodes()];
    for element in 0..mesh.num_elements() {
        let nodes = mesh.element(element);
        for (&node, at) in nodes.iter().zip(family.nodes) {
            let place = at.map(|t| (2.0 * (t + 1.0)).round() as usize);
            number[node as usize] = node_at(nodes, place, &mut fine.nodes);
        }
    }
    for set in fine.node_sets.values_mut() {
        set.iter_mut().for_each(|node| *node = number[*node as usize]);
        set.sort_unstable();
    }
    // Faces come in the order of the sides −ξ, +ξ, −η, +η, −ζ, +ζ.
    let is_on = |child: &Place, face: u8| child[usize::from(face) / 2] == usize::from(face) % 2;
    for set in fine.facet_sets.values_mut() {
        let of_facet = |facet: &Facet| {
            let Facet { element, face } = *facet;
            let those = (0..8).filter(|&child| is_on(&children[child as usize], face)).collect::<Vec<u32>>();
            those.into_iter().map(move |child| Facet { element: 8 * element + child, face })
        };
        *set = set.iter().flat_map(of_facet).collect();
        set.sort_unstable();
    }
    for set in fine.element_sets.values_mut() {
        *set = set.iter().flat_map(|element| 8 * element..8 * element + 8).collect();
    }
    fine
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex::mesh::lattice::Lattice;

    #[test]
    fn a_refined_mesh_is_the_finer_lattice() {
        for kind in [ElementKind::Hex8, ElementKind::Hex27] {
            let with = |n: usize| {
                let lattice = Lattice::uniform([0.0; 3], [3.0, 2.0, 1.0], [2 * n, n, n]);
                let mut mesh = lattice.mesh_all(kind);
                for facet in mesh.boundary_facets() {
                    if mesh.facet_nodes(facet).iter().all(|&node| mesh.nodes[node as usize][0] < 1e-9) {
                        mesh.facet_sets.entry("x0".into()).or_default().push(facet);
                    }
                }
                let corner = mesh.select_nodes(|[x, y, z]| x > 2.9 && y > 1.9 && z > 0.9);
                mesh.node_sets.insert("corner".into(), corner.into_iter().take(1).collect());
                mesh
            };
            let (fine, lattice) = (refined(&with(1)), with(2));
            assert_eq!((fine.num_nodes(), fine.num_elements()), (lattice.num_nodes(), lattice.num_elements()));
            assert!((fine.volume() - 6.0).abs() < 1e-12);
            assert_eq!(fine.boundary_facets().len(), lattice.boundary_facets().len());
            assert_eq!(fine.facet_set("x0").len(), 4);
            let on_side = |&facet: &Facet| fine.facet_nodes(facet).iter().all(|&n| fine.nodes[n as usize][0] < 1e-9);
            assert!(fine.facet_set("x0").iter().all(on_side));
            assert_eq!(
                fine.node_set("corner").iter().map(|&n| fine.nodes[n as usize]).collect::<Vec<_>>(),
                [[3.0, 2.0, 1.0]]
            );
        }
    }
}
