//! The quadratic tetrahedron.

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, LatticeCell, ReferenceBody};
use super::tetrahedron;
use crate::face::FaceKind;
use crate::{kuhn, quadrature};

static FACES: [Face; 4] = tetrahedron::faces(FaceKind::Tri6, 6);

static NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

/// Six of a cell.
pub const LATTICE: LatticeCell = LatticeCell {
    elements: kuhn::TETRAHEDRA,
    nodes: || kuhn::node_offsets().into_iter().flatten().collect(),
    facets_on_sides: || kuhn::faces_on_sides().map(Vec::from),
    nodes_per_cell: [8.0, 23.0],
};

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Tetrahedron,
    num_corners: 4,
    nodes: &NODES,
    edges: &tetrahedron::EDGES,
    faces: &FACES,
    shape,
    volume_rule: quadrature::tetrahedron_8,
    fine_rule: quadrature::tetrahedron_64,
    lattice: LATTICE,
    enriches: &[],
    tetrahedra: Some(tetrahedra),
    completed_by: None,
    vtk_cell_type: 24,
    abaqus: AbaqusTypes {
        names: &["C3D10", "C3D10H", "C3D10M", "C3D10MH", "C3D10I", "C3D10T", "C3D10HS"],
        linear_names: &["C3D4", "C3D4H"],
        faces: &tetrahedron::ABAQUS_FACES,
    },
    gmsh: GmshTypes { number: Some(11), linear_number: Some(4), order: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8] },
};

/// Four at the corners, and four around a diagonal of the octahedron between them.
fn tetrahedra() -> Vec<[u8; 4]> {
    vec![[0, 4, 6, 7], [1, 5, 4, 8], [2, 6, 5, 9], [3, 7, 9, 8], [4, 9, 5, 6], [4, 9, 6, 7], [4, 9, 7, 8], [4, 9, 8, 5]]
}

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let l = [1.0 - x - y - z, x, y, z];
    const D: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for i in 0..4 {
        values[i] = l[i] * (2.0 * l[i] - 1.0);
        gradients[i] = D[i].map(|d| d * (4.0 * l[i] - 1.0));
    }
    for (e, &[a, b]) in tetrahedron::EDGES.iter().enumerate() {
        values[4 + e] = 4.0 * l[a] * l[b];
        gradients[4 + e] = std::array::from_fn(|i| 4.0 * (D[a][i] * l[b] + l[a] * D[b][i]));
    }
}
