//! The quadratic wedge with a node in every quadrilateral face: the quadratic triangle times a line with three nodes. Files have it; it is
//! solved with nodes in all faces and inside.

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, ReferenceBody};
use super::{wedge, wedge21};
use crate::face::FaceKind;
use crate::{quadrature, shape as shapes};

static FACES: [Face; 5] = [
    Face { kind: FaceKind::Tri6, nodes: &wedge::TRIANGLES[0] },
    Face { kind: FaceKind::Tri6, nodes: &wedge::TRIANGLES[1] },
    Face { kind: FaceKind::Quad9, nodes: &[0, 1, 4, 3, 6, 13, 9, 12, 15] },
    Face { kind: FaceKind::Quad9, nodes: &[1, 2, 5, 4, 7, 14, 10, 13, 16] },
    Face { kind: FaceKind::Quad9, nodes: &[2, 0, 3, 5, 8, 12, 11, 14, 17] },
];

static NODES: [[f64; 3]; 18] = {
    let mut nodes = [[0.0; 3]; 18];
    let mut node = 0;
    while node < 18 {
        nodes[node] = wedge::NODES[if node < 15 { node } else { node + 2 }];
        node += 1;
    }
    nodes
};

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Wedge,
    num_corners: 6,
    nodes: &NODES,
    edges: &wedge::EDGES,
    faces: &FACES,
    shape,
    volume_rule: quadrature::wedge_21,
    fine_rule: quadrature::wedge_64,
    lattice: super::descriptor::LatticeCell { nodes: places, ..wedge::LATTICE },
    enriches: &[],
    tetrahedra: None,
    completed_by: Some(|| &wedge21::FAMILY),
    vtk_cell_type: 32,
    abaqus: AbaqusTypes { names: &[], linear_names: &[], ..wedge::ABAQUS },
    gmsh: GmshTypes {
        number: Some(13),
        linear_number: None,
        order: &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16],
    },
};

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let triangle = shapes::evaluate_face(FaceKind::Tri6, [x, y]);
    let places = wedge::PLACES.into_iter().chain([(3, 1), (4, 1), (5, 1)]);
    wedge::product(&triangle, z, places, values, gradients);
}

/// Beside those of the wedge without nodes in its faces the middles of these, which lie between mid-edge nodes.
fn places() -> Vec<[usize; 3]> {
    let of_wedge = |nodes: &[[usize; 3]]| {
        let middles = [6, 7, 8].map(|lower| [nodes[lower][0], nodes[lower][1], 1]);
        nodes.iter().copied().chain(middles).collect::<Vec<_>>()
    };
    (wedge::LATTICE.nodes)().chunks(15).flat_map(of_wedge).collect()
}
