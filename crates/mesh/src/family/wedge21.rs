//! The quadratic wedge with a node in every face and one inside: the triangle with seven nodes times a line with three.
//!
//! Its faces are those of `hex27` and of `tet15`. Its discontinuous linear pressure has what makes these two stable: functions of its own
//! for the flux through every face, and one inside for each of the pressure's slopes (Boffi, Brezzi & Fortin 2013, *Mixed Finite Element
//! Methods and Applications*, ch. 8).

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, LatticeCell, ReferenceBody};
use super::wedge;
use crate::element::ElementKind;
use crate::face::FaceKind;
use crate::{quadrature, shape as shapes};

static FACES: [Face; 5] = [
    Face { kind: FaceKind::Tri7, nodes: &[0, 2, 1, 8, 7, 6, 15] },
    Face { kind: FaceKind::Tri7, nodes: &[3, 4, 5, 9, 10, 11, 16] },
    Face { kind: FaceKind::Quad9, nodes: &[0, 1, 4, 3, 6, 13, 9, 12, 17] },
    Face { kind: FaceKind::Quad9, nodes: &[1, 2, 5, 4, 7, 14, 10, 13, 18] },
    Face { kind: FaceKind::Quad9, nodes: &[2, 0, 3, 5, 8, 12, 11, 14, 19] },
];

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Wedge,
    num_corners: 6,
    nodes: &wedge::NODES,
    edges: &wedge::EDGES,
    faces: &FACES,
    shape,
    volume_rule: quadrature::wedge_21,
    fine_rule: quadrature::wedge_64,
    lattice: LatticeCell { nodes_per_cell: [12.0, 27.0], ..wedge::LATTICE },
    enriches: &[ElementKind::Wedge15, ElementKind::Wedge18],
    tetrahedra: Some(tetrahedra),
    completed_by: None,
    // Lagrange's wedge of any order, of which that with 21 nodes is one.
    vtk_cell_type: 73,
    abaqus: AbaqusTypes { names: &[], linear_names: &[], ..wedge::ABAQUS },
    gmsh: GmshTypes { number: None, linear_number: None, order: &[] },
};

/// Around the node of every face one for each half of its edges, with the inner node as their top.
fn tetrahedra() -> Vec<[u8; 4]> {
    let of_face = |face: &Face| {
        let corners = face.kind.num_corners();
        let nodes: Vec<u8> = face.nodes.iter().map(|&node| node as u8).collect();
        // Seen from outside they run anticlockwise, and the top is inside.
        let of_edge = |edge: usize| {
            let (from, middle, to) = (nodes[edge], nodes[corners + edge], nodes[(edge + 1) % corners]);
            [[from, nodes[2 * corners], middle, 20], [middle, nodes[2 * corners], to, 20]]
        };
        (0..corners).flat_map(of_edge).collect::<Vec<_>>()
    };
    FACES.iter().flat_map(of_face).collect()
}

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let triangle = shapes::evaluate_face(FaceKind::Tri7, [x, y]);
    let places = wedge::PLACES.into_iter().chain([(6, 0), (6, 2), (3, 1), (4, 1), (5, 1), (6, 1)]);
    wedge::product(&triangle, z, places, values, gradients);
}
