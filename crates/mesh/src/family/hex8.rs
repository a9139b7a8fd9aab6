//! The trilinear hexahedron.

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, ReferenceBody};
use super::hexahedron;
use crate::face::FaceKind;
use crate::quadrature;

static FACES: [Face; 6] = hexahedron::faces(FaceKind::Quad4, 4);

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Hexahedron,
    num_corners: 8,
    nodes: hexahedron::NODES.split_at(8).0,
    edges: &hexahedron::EDGES,
    faces: &FACES,
    shape,
    volume_rule: || quadrature::hexahedron(2),
    fine_rule: || quadrature::hexahedron(4),
    lattice: hexahedron::lattice_cell(|| hexahedron::places(8), [1.0, 5.8]),
    enriches: &[],
    tetrahedra: Some(|| hexahedron::tetrahedra(8, 1)),
    completed_by: None,
    vtk_cell_type: 12,
    abaqus: AbaqusTypes {
        names: &["C3D8", "C3D8R", "C3D8H", "C3D8I", "C3D8RH", "C3D8IH"],
        linear_names: &[],
        faces: &hexahedron::ABAQUS_FACES,
    },
    gmsh: GmshTypes { number: Some(5), linear_number: None, order: &[0, 1, 2, 3, 4, 5, 6, 7] },
};

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    for (i, [a, b, c]) in hexahedron::NODES[..8].iter().copied().enumerate() {
        let (u, v, w) = (1.0 + a * x, 1.0 + b * y, 1.0 + c * z);
        values[i] = 0.125 * u * v * w;
        gradients[i] = [0.125 * a * v * w, 0.125 * b * u * w, 0.125 * c * u * v];
    }
}
