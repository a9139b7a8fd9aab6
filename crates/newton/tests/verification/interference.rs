//! Overlaps at rest that are meant: what is pressed out by the first requested load has the state of its closed form.

use std::f64::consts::FRAC_PI_2;

use pneuflex_factor::Parallelism;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::{
    Clock, Contact, ContactMethod, ContactPair, Formulation, Law, LoadParameter, Material, Obstacle, Problem, Shape,
    Solver, Support,
};
use pneuflex_newton::{ConvergedState, Path, State, System};

use crate::fixtures::{difference, follow};

const C10: f64 = 0.2;

fn settings() -> Solver {
    Solver { tolerance: 1e-9, first_step: 0.5, max_step: 0.5, min_step: 1e-3, ..Solver::default() }
}

fn material() -> Material {
    Material { law: Law::NeoHooke { c10: C10 }, bulk_modulus: 2e3, ..Material::default() }
}

/// A body on planes of symmetry through the origin along some axes.
fn body(mesh: Mesh, formulation: Formulation, axes: &[usize]) -> Problem {
    let mut problem = Problem::body(mesh, formulation, material());
    for &axis in axes {
        let nodes = problem.mesh.select_nodes(|x| x[axis].abs() < 1e-9);
        let axes = std::array::from_fn(|k| k == axis);
        problem.supports.push(Support { name: format!("symmetry {axis}"), nodes, axes, motion: None });
    }
    problem.clock = Clock::Steps;
    problem
}

fn obstacle(shape: Shape, facets: Vec<Facet>, tolerance: f64) -> Obstacle {
    Obstacle {
        name: "mandrel".into(),
        shape,
        facets,
        stiffness: 50.0,
        motion: None,
        report_force: true,
        penetration_tolerance: Some(tolerance),
        interference_until: Some(LoadParameter(1.0)),
    }
}

/// Force of a support's nodes along its axis, N.
fn force(problem: &Problem, state: &ConvergedState, support: usize) -> f64 {
    let Support { nodes, axes, .. } = &problem.supports[support];
    nodes.iter().flat_map(|&n| (0..3).filter(|k| axes[*k]).map(move |k| state.reaction[n as usize][k])).sum()
}

/// Nominal stress of the incompressible material under a uniaxial stretch, MPa.
fn uniaxial(stretch: f64) -> f64 {
    2.0 * C10 * (stretch - stretch.powi(-2))
}

#[test]
fn a_plane_in_a_block_presses_it_to_its_height() {
    let (height, overlap) = (1.5, 0.15);
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex27, Formulation::Tet15] {
        let mesh = Lattice::uniform([0.0; 3], [1.0, 1.0, height], [2, 2, 3]).mesh_all(formulation.element_kind());
        let top = mesh.select_facets(|x| (x[2] - height).abs() < 1e-9);
        let mut problem = body(mesh, formulation, &[0, 1, 2]);
        let plane = Shape::Plane { point: [0.0, 0.0, height - overlap], normal: [0.0, 0.0, -1.0] };
        problem.obstacles = vec![obstacle(plane, top, 1e-6)];
        let state = follow(&problem, &[1.0, 2.0], &settings());
        let expected = -uniaxial(1.0 - overlap / height);
        for state in &state {
            let found = force(&problem, state, 2);
            assert!((found / expected - 1.0).abs() < 1e-3, "{formulation}: {found} N instead of {expected}");
        }
        assert!(state[0].iterations <= 14, "{formulation}: {} iterations", state[0].iterations);
        assert!(
            difference(state[0].displacement.as_flattened(), state[1].displacement.as_flattened()) < 1e-9,
            "it does not go on"
        );
    }
}

/// A block on another one, which it overlaps.
fn blocks(overlap: f64, method: ContactMethod) -> Problem {
    // The middle layer is left out, and the upper block moved down.
    let lattice = Lattice::uniform([0.0; 3], [1.0, 1.0, 3.0], [2, 2, 3]);
    let mesh = lattice.mesh(Formulation::Hex27.element_kind(), |cell| cell[2] != 1).mesh;
    let lower = mesh.select_facets(|x| (x[2] - 1.0).abs() < 1e-9);
    let upper = mesh.select_facets(|x| (x[2] - 2.0).abs() < 1e-9);
    let mesh = mesh.map_nodes(|[x, y, z]| [x, y, if z > 1.5 { z - 1.0 - overlap } else { z }]);
    let mut problem = body(mesh, Formulation::Hex27, &[0, 1, 2]);
    let top = problem.mesh.select_nodes(|x| (x[2] - 2.0 + overlap).abs() < 1e-9);
    problem.supports.push(Support { name: "top".into(), nodes: top, axes: [false, false, true], motion: None });
    problem.contact = Contact { method, stiffness: 50.0, ..Contact::default() };
    problem.contact_pairs = vec![ContactPair {
        penetration_tolerance: Some(1e-6),
        interference_until: Some(LoadParameter(1.0)),
        ..ContactPair::new("joint", lower, upper)
    }];
    problem
}

/// With points, and with averages.
#[test]
fn two_blocks_in_each_other_share_the_overlap() {
    let overlap = 0.1;
    for method in [ContactMethod::Mortar, ContactMethod::MultiPoint] {
        let problem = blocks(overlap, method);
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let (found, expected) = (force(&problem, &state, 2), -uniaxial(1.0 - 0.5 * overlap));
        assert!((found / expected - 1.0).abs() < 1e-3, "{method:?}: {found} N instead of {expected}");
        assert!(state.iterations <= 20, "{method:?}: {} iterations", state.iterations);
    }
}

/// The column that the guess of a step feels is the change of the residual as the overlap goes.
#[test]
fn what_an_overlap_does_to_the_body_is_the_derivative_of_its_force() {
    for method in [ContactMethod::Mortar, ContactMethod::MultiPoint] {
        let problem = blocks(0.1, method);
        let mut system = System::new(&problem, Parallelism::Threads).unwrap();
        let u: Vec<[f64; 3]> =
            problem.mesh.nodes.iter().map(|x| [0.01 * x[2], 0.0, -0.02 * x[2] + 0.01 * x[0] * x[1]]).collect();
        let at = |time: f64| State::new(time, u.clone(), Vec::new());
        let (assembled, tangent) = system.tangent(&at(0.5)).unwrap();
        assert!(assembled.contact_points > 0);
        let [motion] = tangent.motions() else { panic!("one overlap") };
        let h = 1e-4;
        let residual = |system: &mut System, time| system.residual(&at(time)).unwrap().residual;
        let [before, after] = [0.5 - h, 0.5 + h].map(|time| residual(&mut system, time));
        let slope = (motion.curve.at(LoadParameter(0.5 + h)) - motion.curve.at(LoadParameter(0.5 - h))) / (2.0 * h);
        assert!((slope + 1.0).abs() < 1e-9);
        let by_difference: Vec<f64> =
            (before.as_flattened().iter().zip(after.as_flattened())).map(|(a, b)| (b - a) / (2.0 * h)).collect();
        let by_column: Vec<f64> = motion.column.as_flattened().iter().map(|x| slope * x).collect();
        let off = difference(&by_difference, &by_column);
        assert!(off < 1e-6, "{method:?}: {off}");
    }
}

/// A quarter of a ring shrunk onto a rigid mandrel in plane strain. Of an incompressible neo-Hookean one p = μ ∫ (λ² − λ⁻²)/r dr with the hoop
/// stretch λ = r/R and r² − R² the same everywhere; for small δ this is Lamé's 2 μ δ/a (1 − a²/b²).
#[test]
fn a_ring_shrunk_on_a_mandrel_carries_the_pressure_of_lame() {
    let (inner, outer, overlap) = (2.0, 3.0, 0.1);
    let lattice = Lattice::uniform([inner, 0.0, 0.0], [outer, FRAC_PI_2, 0.4], [3, 6, 1]);
    let mesh = lattice.mesh_all(Formulation::Hex27.element_kind());
    let bore = mesh.select_facets(|x| (x[0] - inner).abs() < 1e-9);
    let mesh = mesh.map_nodes(|[r, phi, z]| [r * phi.cos(), r * phi.sin(), z]);
    let mut problem = body(mesh, Formulation::Hex27, &[0, 1]);
    let all = (0..problem.mesh.num_nodes() as u32).collect();
    problem.supports.push(Support {
        name: "plane strain".into(),
        nodes: all,
        axes: [false, false, true],
        motion: None,
    });
    let radius = inner + overlap;
    let mandrel = Shape::Cylinder { point: [0.0; 3], axis: [0.0, 0.0, 1.0], radius, is_hollow: false };
    problem.obstacles = vec![obstacle(mandrel, bore, 1e-3)];
    let state = follow(&problem, &[1.0], &settings()).remove(0);
    let grown = radius * radius - inner * inner;
    let (steps, end) = (2000, (outer * outer + grown).sqrt());
    let width = (end - radius) / f64::from(steps);
    let at = |step: i32| {
        let r = radius + (f64::from(step) + 0.5) * width;
        let square = r * r / (r * r - grown);
        (square - 1.0 / square) / r * width
    };
    let pressure = 2.0 * C10 * (0..steps).map(at).sum::<f64>();
    let lame = 4.0 * C10 * overlap / inner * (1.0 - (inner / outer).powi(2));
    assert!((pressure / lame - 1.0).abs() < 0.1, "{pressure} {lame}");
    let (found, expected) = (force(&problem, &state, 0), pressure * radius * 0.4);
    assert!((found.abs() / expected - 1.0).abs() < 5e-3, "{found} N instead of {expected}");
    assert!(state.iterations <= 20, "{} iterations", state.iterations);
}

/// What a checkpoint holds is enough, in the middle of the way.
#[test]
fn a_path_goes_on_from_half_of_an_overlap() {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [2, 2, 2]).mesh_all(Formulation::Hex8Q1p0.element_kind());
    let top = mesh.select_facets(|x| (x[2] - 1.0).abs() < 1e-9);
    let mut problem = body(mesh, Formulation::Hex8Q1p0, &[0, 1, 2]);
    let plane = Shape::Plane { point: [0.0, 0.0, 0.8], normal: [0.1, 0.0, -1.0] };
    problem.obstacles = vec![obstacle(plane, top, 1e-4)];
    let mut kept = None;
    let mut path = Path::new(&problem, &settings()).unwrap();
    let expected = path
        .advance_to(1.0, &mut |event| {
            if let pneuflex_newton::Event::StepAccepted(checkpoint) = event {
                kept.get_or_insert_with(|| checkpoint.clone());
            }
        })
        .unwrap();
    let mut again = Path::new(&problem, &settings()).unwrap();
    again.resume(kept.unwrap()).unwrap();
    let found = again.advance_to(1.0, &mut |_| {}).unwrap();
    assert!(
        expected.load_steps > 1
            && difference(found.displacement.as_flattened(), expected.displacement.as_flattened()) < 1e-10
    );
}
