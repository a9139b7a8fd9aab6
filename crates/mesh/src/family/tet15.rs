//! The quadratic tetrahedron with a node in every face and one inside.
//!
//! Its functions are those of P2, the bubble λ_a λ_b λ_c of every face and the bubble λ₀ λ₁ λ₂ λ₃ of the element; with a discontinuous linear
//! pressure it is the element of Crouzeix and Raviart in space, which is inf-sup stable (Boffi, Brezzi & Fortin 2013, *Mixed Finite Element
//! Methods and Applications*, ch. 8). With the functions B_f = 27 λ_a λ_b λ_c (1 − 4 λ_d) of the face opposite of corner d and
//! C = 256 λ₀ λ₁ λ₂ λ₃, which are 1 at their own node and 0 at all others,
//!
//! ```text
//! corner i:      λᵢ (2 λᵢ − 1) + 1/9 Σ B_f (faces at i) + 1/8 C
//! mid-edge ab:   4 λ_a λ_b − 4/9 Σ B_f (faces at ab) − 1/4 C
//! ```

use super::descriptor::{AbaqusTypes, ElementFamily, Face, GmshTypes, LatticeCell, ReferenceBody};
use super::{tet10, tetrahedron};
use crate::element::ElementKind;
use crate::face::FaceKind;
use crate::quadrature;

static FACES: [Face; 4] = tetrahedron::faces(FaceKind::Tri7, 7);

const THIRD: f64 = 1.0 / 3.0;

static NODES: [[f64; 3]; 15] = [
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
    [THIRD, THIRD, 0.0],
    [THIRD, 0.0, THIRD],
    [THIRD, THIRD, THIRD],
    [0.0, THIRD, THIRD],
    [0.25, 0.25, 0.25],
];

/// The corner opposite of the face in which nodes 10–13 lie.
const OPPOSITE: [usize; 4] = [3, 2, 0, 1];

/// The family.
pub static FAMILY: ElementFamily = ElementFamily {
    body: ReferenceBody::Tetrahedron,
    num_corners: 4,
    nodes: &NODES,
    edges: &tetrahedron::EDGES,
    faces: &FACES,
    shape,
    volume_rule: quadrature::tetrahedron_24,
    fine_rule: quadrature::tetrahedron_64,
    lattice: LatticeCell { nodes_per_cell: [26.0, 34.5], ..tet10::LATTICE },
    enriches: &[ElementKind::Tet10],
    tetrahedra: Some(tetrahedra),
    completed_by: None,
    // Lagrange's tetrahedron of any order, of which that with 15 nodes is one.
    vtk_cell_type: 71,
    abaqus: AbaqusTypes { names: &[], linear_names: &[], faces: &tetrahedron::ABAQUS_FACES },
    gmsh: GmshTypes { number: None, linear_number: None, order: &[] },
};

/// Six around the node of every face, with the inner node as their top.
fn tetrahedra() -> Vec<[u8; 4]> {
    let of_face = |face: &[usize; 7]| {
        let [a, b, c, ab, bc, ca, centre] = face.map(|node| node as u8);
        // Seen from outside they run anticlockwise, and the top is inside.
        [[a, ab], [ab, b], [b, bc], [bc, c], [c, ca], [ca, a]].map(|[from, to]| [from, centre, to, 14])
    };
    tetrahedron::FACES.iter().flat_map(of_face).collect()
}

fn shape([x, y, z]: [f64; 3], values: &mut [f64], gradients: &mut [[f64; 3]]) {
    (tet10::FAMILY.shape)([x, y, z], values, gradients);
    let l = [1.0 - x - y - z, x, y, z];
    const D: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // λ_a λ_b λ_c and its gradient.
    let product = |[a, b, c]: [usize; 3]| -> (f64, [f64; 3]) {
        let gradient = |k: usize| D[a][k] * l[b] * l[c] + l[a] * D[b][k] * l[c] + l[a] * l[b] * D[c][k];
        (l[a] * l[b] * l[c], std::array::from_fn(gradient))
    };
    let (inner, along) = product([1, 2, 3]);
    values[14] = 256.0 * l[0] * inner;
    gradients[14] = std::array::from_fn(|k| 256.0 * (D[0][k] * inner + l[0] * along[k]));
    for (face, d) in OPPOSITE.into_iter().enumerate() {
        let (bubble, along) = product([(d + 1) % 4, (d + 2) % 4, (d + 3) % 4]);
        let rest = 1.0 - 4.0 * l[d];
        values[10 + face] = 27.0 * bubble * rest;
        gradients[10 + face] = std::array::from_fn(|k| 27.0 * (along[k] * rest - 4.0 * bubble * D[d][k]));
    }
    let mut take = |node: usize, of: usize, share: f64| {
        values[node] += share * values[of];
        for k in 0..3 {
            gradients[node][k] += share * gradients[of][k];
        }
    };
    for corner in 0..4 {
        OPPOSITE
            .iter()
            .enumerate()
            .filter(|(_, d)| **d != corner)
            .for_each(|(face, _)| take(corner, 10 + face, 1.0 / 9.0));
        take(corner, 14, 0.125);
    }
    for (edge, ends) in tetrahedron::EDGES.iter().enumerate() {
        let at_edge = OPPOSITE.iter().enumerate().filter(|(_, d)| !ends.contains(d));
        at_edge.for_each(|(face, _)| take(4 + edge, 10 + face, -4.0 / 9.0));
        take(4 + edge, 14, -0.25);
    }
    // Far from the origin, what gradients add up to counts many times.
    values[0] = 1.0 - values[1..15].iter().sum::<f64>();
    gradients[0] = std::array::from_fn(|k| -gradients[1..15].iter().map(|gradient| gradient[k]).sum::<f64>());
}
