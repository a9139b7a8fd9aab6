//! The serendipity quadratic hexahedron.

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, ReferenceBody};
use super::{hex27, hexahedron};
use crate::face::FaceKind;
use crate::quadrature;

static FACES: [Face; 6] = hexahedron::faces(FaceKind::Quad8, 8);

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Hexahedron,
    num_corners: 8,
    nodes: hexahedron::NODES.split_at(20).0,
    edges: &hexahedron::EDGES,
    faces: &FACES,
    shape,
    volume_rule: || quadrature::hexahedron(3),
    fine_rule: || quadrature::hexahedron(4),
    lattice: hexahedron::lattice_cell(|| hexahedron::places(20), [4.0, 17.3]),
    enriches: &[],
    tetrahedra: None,
    completed_by: Some(|| &hex27::FAMILY),
    vtk_cell_type: 25,
    abaqus: AbaqusTypes {
        names: &["C3D20", "C3D20R", "C3D20H", "C3D20RH"],
        linear_names: &[],
        faces: &hexahedron::ABAQUS_FACES,
    },
    gmsh: GmshTypes {
        number: Some(17),
        linear_number: None,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    },
};

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    for (i, [a, b, c]) in hexahedron::NODES[..20].iter().copied().enumerate() {
        let (u, v, w) = (1.0 + a * x, 1.0 + b * y, 1.0 + c * z);
        if i < 8 {
            let s = a * x + b * y + c * z - 2.0;
            values[i] = 0.125 * u * v * w * s;
            gradients[i] = [0.125 * a * v * w * (s + u), 0.125 * b * u * w * (s + v), 0.125 * c * u * v * (s + w)];
        } else if a == 0.0 {
            let q = 1.0 - x * x;
            values[i] = 0.25 * q * v * w;
            gradients[i] = [-0.5 * x * v * w, 0.25 * q * b * w, 0.25 * q * v * c];
        } else if b == 0.0 {
            let q = 1.0 - y * y;
            values[i] = 0.25 * u * q * w;
            gradients[i] = [0.25 * a * q * w, -0.5 * y * u * w, 0.25 * u * q * c];
        } else {
            let q = 1.0 - z * z;
            values[i] = 0.25 * u * v * q;
            gradients[i] = [0.25 * a * v * q, 0.25 * u * b * q, -0.5 * z * u * v];
        }
    }
}
