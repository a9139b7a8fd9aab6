//! Meshes of several families from lattices of one.

use std::collections::BTreeMap;

use crate::element::ElementKind;
use crate::kinds::Kinds;
use crate::lattice::Lattice;
use crate::mesh::Mesh;

/// The elements of `inside` whose centres are where `is_inside` holds and those of `outside` whose centres are elsewhere; nodes at the same
/// place are one.
pub fn mixed(inside: &Mesh, outside: &Mesh, is_inside: impl Fn([f64; 3]) -> bool) -> Mesh {
    let mut number: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let (mut nodes, mut connectivity, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    let extent = inside.extent();
    for (mesh, side) in [(inside, true), (outside, false)] {
        for element in 0..mesh.num_elements() {
            let corners = mesh.corners(element);
            let centre = std::array::from_fn(|d| {
                corners.iter().map(|&node| mesh.nodes[node as usize][d]).sum::<f64>() / corners.len() as f64
            });
            if is_inside(centre) != side {
                continue;
            }
            kinds.push(mesh.kind_of(element));
            for &node in mesh.element(element) {
                let x = mesh.nodes[node as usize];
                let key = x.map(|t| (1e6 * t / extent).round() as i64);
                connectivity.push(*number.entry(key).or_insert_with(|| {
                    nodes.push(x);
                    nodes.len() as u32 - 1
                }));
            }
        }
    }
    Mesh {
        kinds: if kinds.is_empty() { ElementKind::Hex8.into() } else { kinds.into_iter().collect::<Kinds>() },
        nodes,
        connectivity,
        node_sets: BTreeMap::new(),
        facet_sets: BTreeMap::new(),
        element_sets: BTreeMap::new(),
    }
}

/// An angle of 3 × 2 × 3 mm with hexahedra of 27 nodes for x < 1, beside them wedges of 21 for z < 2, and tetrahedra of 15 on these; nothing
/// for x < 1 and z > 2. Each millimetre is divided into `cells`.
pub fn angle(cells: usize) -> Mesh {
    let lattice = Lattice::uniform([0.0; 3], [3.0, 2.0, 3.0], [3 * cells, 2 * cells, 3 * cells]);
    let of_family = |kind| lattice.mesh(kind, |cell| cell[0] >= cells || cell[2] < 2 * cells).mesh;
    let beside = mixed(&of_family(ElementKind::Wedge21), &of_family(ElementKind::Tet15), |x| x[2] < 2.0);
    mixed(&of_family(ElementKind::Hex27), &beside, |x| x[0] < 1.0)
}
