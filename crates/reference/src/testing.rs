//! Fixtures of this crate's tests.

use nalgebra::{DMatrix, DVector};
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Actuator, Mesh, MeshSize, ReferenceBody};
use pneuflex_model::{
    Contact, ContactMethod, ContactPair, Curve, Formulation, Invariant, Material, Motion, Problem, Support,
};

pub const INVARIANTS: [Invariant; 2] = [Invariant::Full, Invariant::Isochoric];

pub fn material(invariant: Invariant) -> Material {
    Material { invariant, ..Material::default() }
}

/// A body without loads.
pub fn body(mesh: Mesh, formulation: Formulation, material: Material) -> Problem {
    Problem::body(mesh, formulation, material)
}

/// A block [0, size] with curved and slanted elements when `distort` is not zero.
pub fn block(formulation: Formulation, size: [f64; 3], cells: [usize; 3], distort: f64) -> Mesh {
    let mesh = Lattice::uniform([0.0; 3], size, cells).mesh_all(formulation.element_kind());
    mesh.map_nodes(|[x, y, z]| {
        [
            x + distort * (2.1 * y + 0.3).sin() * (1.0 + z),
            y + distort * (1.3 * z - x).cos(),
            z + distort * (1.7 * x + y).sin(),
        ]
    })
}

/// Holds u along `axis` on the nodes that satisfy `predicate`.
pub fn hold(problem: &mut Problem, axes: [bool; 3], predicate: impl Fn([f64; 3]) -> bool) {
    let nodes = problem.mesh.select_nodes(predicate);
    assert!(!nodes.is_empty(), "a support that holds nothing");
    problem.supports.push(Support { name: "test".into(), nodes, axes, motion: None });
}

/// Moves every held node to its place in `displacement` (three per node) while the load parameter goes from 0 to 1.
pub fn move_supports(problem: &mut Problem, displacement: &[f64]) {
    let moved = |support: &Support, node: u32| {
        let displacement = std::array::from_fn(|axis| displacement[3 * node as usize + axis]);
        let motion = Some(Motion { displacement, curve: Curve::Proportional(1.0) });
        Support { nodes: vec![node], motion, ..support.clone() }
    };
    let supports = problem.supports.iter().flat_map(|support| support.nodes.iter().map(|&node| moved(support, node)));
    problem.supports = supports.collect();
}

/// Two coarse chambers as in the theory with a given gap between their walls.
pub fn two_chambers(size: [f64; 3], gap: f64, formulation: Formulation, method: ContactMethod) -> Problem {
    Problem::from_actuator(
        &Actuator { gap: gap.into(), ..Actuator::two_chambers() },
        &MeshSize::per_axis(size),
        formulation,
        Material::default(),
        Contact { method, ..Contact::default() },
    )
    .unwrap()
}

/// Two blocks with facing sides x = 1 (slave) and x = 1.1 (master), each cut into 2 × 2 elements across x.
///
/// The slave covers \[0, 2\]² in y and z. With `shifted` the master overlaps it on all sides and is cut elsewhere, so that
/// slave facets straddle master facets; without, both are the same.
pub fn two_blocks(formulation: Formulation, method: ContactMethod, shifted: bool) -> Problem {
    let kind = formulation.element_kind();
    let mut mesh = Lattice::uniform([0.0; 3], [1.0, 2.0, 2.0], [1, 2, 2]).mesh_all(kind);
    let [y, z] = if shifted { [[-0.3, 0.8, 2.4], [-0.2, 1.3, 2.3]] } else { [[0.0, 1.0, 2.0]; 2] };
    let right = Lattice { lines: [vec![1.1, 2.1], y.to_vec(), z.to_vec()] }.mesh_all(kind);
    let shift = mesh.num_nodes() as u32;
    mesh.connectivity.extend(right.connectivity.iter().map(|n| n + shift));
    mesh.nodes.extend(right.nodes);
    let side = |x: f64| mesh.select_facets(|point| (point[0] - x).abs() < 1e-9);
    let contact_pairs = vec![ContactPair::new("gap", side(1.0), side(1.1))];
    let per_cell = if formulation.element.body == ReferenceBody::Tetrahedron { 2 } else { 1 };
    assert_eq!((contact_pairs[0].slave.len(), contact_pairs[0].master.len()), (4 * per_cell, 4 * per_cell));
    let problem = body(mesh, formulation, Material::default());
    Problem { contact: Contact { method, ..Contact::default() }, contact_pairs, ..problem }
}

/// Displacements that look random but are always the same.
pub fn noise(n: usize, amplitude: f64) -> Vec<f64> {
    (0..n).map(|i| amplitude * ((i as f64 + 1.0) * 12.9898).sin() * ((i as f64) * 78.233 + 0.5).cos()).collect()
}

/// Displacements u = a(X).
pub fn displacement(mesh: &Mesh, deformed: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.nodes
        .iter()
        .flat_map(|&x| {
            let r = deformed(x);
            [r[0] - x[0], r[1] - x[1], r[2] - x[2]]
        })
        .collect()
}

/// Requires that `gradient` and `hessian` are the derivatives of `energy`, along a few directions, and that neither vanishes.
#[track_caller]
pub fn check_derivatives(
    energy: impl Fn(&[f64]) -> f64,
    gradient: impl Fn(&[f64]) -> DVector<f64>,
    hessian: impl Fn(&[f64]) -> DMatrix<f64>,
    u: &[f64],
) {
    let (g, k, h) = (gradient(u), hessian(u), 1e-5);
    assert!(g.norm() > 1e-3 && k.norm() > 1e-3, "nothing to differentiate: {:.1e}, {:.1e}", g.norm(), k.norm());
    assert!((&k - k.transpose()).norm() < 1e-12 * k.norm(), "not symmetric");
    for seed in 1..4 {
        let direction = DVector::from_fn(u.len(), |i, _| ((i * seed) as f64 * 1.7 + seed as f64).sin());
        let at = |t: f64| -> Vec<f64> { u.iter().zip(direction.iter()).map(|(u, d)| u + t * d).collect() };
        let slope = (energy(&at(h)) - energy(&at(-h))) / (2.0 * h);
        let exact = g.dot(&direction);
        assert!((slope - exact).abs() < 1e-6 * g.norm() * direction.norm(), "energy {slope}, gradient {exact}");
        let change = (gradient(&at(h)) - gradient(&at(-h))) / (2.0 * h);
        let exact = &k * &direction;
        let error = (&change - &exact).norm() / exact.norm();
        assert!(error < 1e-6, "gradient's change and Hessian differ by {error:.1e}");
    }
}
