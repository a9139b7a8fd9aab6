//! The triquadratic hexahedron.

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, ReferenceBody};
use super::hexahedron;
use crate::element::ElementKind;
use crate::face::FaceKind;
use crate::polynomial::quadratic_line;
use crate::quadrature;

static FACES: [Face; 6] = hexahedron::faces(FaceKind::Quad9, 9);

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Hexahedron,
    num_corners: 8,
    nodes: &hexahedron::NODES,
    edges: &hexahedron::EDGES,
    faces: &FACES,
    shape,
    volume_rule: || quadrature::hexahedron(3),
    fine_rule: || quadrature::hexahedron(4),
    lattice: hexahedron::lattice_cell(|| hexahedron::places(27), [8.0, 23.0]),
    enriches: &[ElementKind::Hex20],
    tetrahedra: Some(|| hexahedron::tetrahedra(27, 2)),
    completed_by: None,
    vtk_cell_type: 29,
    abaqus: AbaqusTypes { names: &[], linear_names: &[], faces: &hexahedron::ABAQUS_FACES },
    gmsh: GmshTypes {
        number: Some(12),
        linear_number: None,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26],
    },
};

fn shape(xi: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let line: [[[f64; 3]; 3]; 3] = std::array::from_fn(|d| quadratic_line(xi[d]));
    for (i, signs) in hexahedron::NODES.iter().enumerate() {
        // Position of the node along each axis: −1, 0, +1 become 0, 1, 2.
        let [a, b, c] = signs.map(|s| (s + 1.0) as usize);
        let (u, v, w) = (line[0][a], line[1][b], line[2][c]);
        values[i] = u[0] * v[0] * w[0];
        gradients[i] = [u[1] * v[0] * w[0], u[0] * v[1] * w[0], u[0] * v[0] * w[1]];
    }
}
