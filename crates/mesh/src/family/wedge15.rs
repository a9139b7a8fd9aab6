//! The serendipity quadratic wedge. Files have it; it is solved with nodes in its faces and inside.

use super::descriptor::{ElementFamily, Face, GmshTypes, ReferenceBody};
use super::{wedge, wedge21};
use crate::face::FaceKind;
use crate::quadrature;

static FACES: [Face; 5] = [
    Face { kind: FaceKind::Tri6, nodes: &wedge::TRIANGLES[0] },
    Face { kind: FaceKind::Tri6, nodes: &wedge::TRIANGLES[1] },
    Face { kind: FaceKind::Quad8, nodes: &wedge::QUADRILATERALS[0] },
    Face { kind: FaceKind::Quad8, nodes: &wedge::QUADRILATERALS[1] },
    Face { kind: FaceKind::Quad8, nodes: &wedge::QUADRILATERALS[2] },
];

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Wedge,
    num_corners: 6,
    nodes: wedge::NODES.split_at(15).0,
    edges: &wedge::EDGES,
    faces: &FACES,
    shape,
    volume_rule: quadrature::wedge_21,
    fine_rule: quadrature::wedge_64,
    lattice: wedge::LATTICE,
    enriches: &[],
    tetrahedra: None,
    completed_by: Some(|| &wedge21::FAMILY),
    vtk_cell_type: 26,
    abaqus: wedge::ABAQUS,
    gmsh: GmshTypes {
        number: Some(18),
        linear_number: Some(6),
        order: &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11],
    },
};

/// λᵢ ((2 λᵢ − 1)(1 ± ζ) − (1 − ζ²)) / 2 at corners, 2 λ_a λ_b (1 ± ζ) between two of a triangle, λᵢ (1 − ζ²) between the triangles.
fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    let l = [1.0 - x - y, x, y];
    const D: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let bubble = 1.0 - z * z;
    for (i, &d) in D.iter().enumerate() {
        for (level, sign) in [(0, -1.0), (1, 1.0)] {
            let s = 1.0 + sign * z;
            values[3 * level + i] = 0.5 * l[i] * ((2.0 * l[i] - 1.0) * s - bubble);
            let [along_x, along_y] = d.map(|d| 0.5 * d * ((4.0 * l[i] - 1.0) * s - bubble));
            gradients[3 * level + i] = [along_x, along_y, 0.5 * l[i] * ((2.0 * l[i] - 1.0) * sign + 2.0 * z)];
            let j = (i + 1) % 3;
            values[6 + 3 * level + i] = 2.0 * l[i] * l[j] * s;
            let [along_x, along_y] = [0, 1].map(|k| 2.0 * (d[k] * l[j] + l[i] * D[j][k]) * s);
            gradients[6 + 3 * level + i] = [along_x, along_y, 2.0 * l[i] * l[j] * sign];
        }
        values[12 + i] = l[i] * bubble;
        gradients[12 + i] = [d[0] * bubble, d[1] * bubble, -2.0 * l[i] * z];
    }
}
