//! Load paths against the reference: everything that a problem may have beside air at a given pressure and one law of contact.

use std::sync::Arc;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::testing::mixed;
use pneuflex_mesh::{Actuator, ElementKind, Facet, Mesh};
use pneuflex_model::load::Load;
use pneuflex_model::{
    Cavity, Clock, ContactMethod, Control, Curve, Formulation, Gas, Invariant, Law, LinearEquation, Material, Motion,
    Obstacle, Problem, Region, Shape, Solver, Support,
};
use pneuflex_newton::ConvergedState;
use pneuflex_reference::{PathOptions, ReferenceSolver, ReferenceState};

use crate::fixtures::{
    actuator_problem, assert_same_states, coarse_chambers, follow, follow_reference, strict, touching,
};

const SIDES: [f64; 3] = [3.0, 1.0, 1.2];

/// A bar that is clamped at x = 0.
fn bar(formulation: Formulation) -> Problem {
    bar_of(Lattice::uniform([0.0; 3], SIDES, [3, 1, 1]).mesh_all(formulation.element_kind()), formulation)
}

/// Bars of every formulation, and one that begins with a hexahedron and goes on with wedges.
fn bars() -> impl Iterator<Item = (String, Problem)> {
    let of_family = |kind| Lattice::uniform([0.0; 3], SIDES, [3, 1, 1]).mesh_all(kind);
    let first = SIDES[0] / 3.0;
    let several = mixed(&of_family(ElementKind::Hex27), &of_family(ElementKind::Wedge21), |x| x[0] < first);
    let several = bar_of(several, Formulation::Hex27);
    let of_one = Formulation::ALL.into_iter().map(|formulation| (formulation.name().to_owned(), bar(formulation)));
    of_one.chain([(several.element_names(), several)])
}

fn bar_of(mesh: Mesh, formulation: Formulation) -> Problem {
    let mut problem = Problem::body(mesh, formulation, Material { density: 1.1, ..Material::default() });
    hold(&mut problem, 0.0, [true; 3], None);
    problem.clock = Clock::Steps;
    problem
}

fn hold(problem: &mut Problem, at: f64, axes: [bool; 3], motion: Option<Motion>) {
    let nodes = problem.mesh.select_nodes(|x| (x[0] - at).abs() < 1e-9);
    problem.supports.push(Support { name: "end".into(), nodes, axes, motion });
}

fn facets_at(problem: &Problem, axis: usize) -> Vec<Facet> {
    problem.mesh.select_facets(|x| (x[axis] - SIDES[axis]).abs() < 1e-9)
}

fn ramp() -> Curve {
    Curve::Proportional(1.0)
}

/// Follows a problem to these positions both ways, the solver in steps of `step`, and compares; at the first the body must have moved.
fn check(
    name: &str,
    problem: &Problem,
    parameters: &[f64],
    step: f64,
) -> (ReferenceSolver, Vec<ReferenceState>, Vec<ConvergedState>) {
    let settings = Solver { first_step: step, max_step: step, min_step: 1e-3, residual_tolerance: 1e-10, ..strict() };
    let found = follow(problem, parameters, &settings);
    let solver = ReferenceSolver::new(problem).unwrap();
    let options = PathOptions { max_step: 0.5, ..PathOptions::default() };
    let expected = solver.follow_path(parameters, &options).unwrap();
    let largest = expected[0].displacement.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(largest > 0.03, "{name}: {largest} mm");
    assert_same_states(name, &found, &expected);
    (solver, expected, found)
}

/// Two of each kind, so that they add up; gravity on elements of two densities.
#[test]
fn forces_tractions_and_weights() {
    for (formulation, mut problem) in bars() {
        let elements: Vec<u32> = (0..problem.mesh.num_elements() as u32 / 3).collect();
        let material = Material { density: 2.0, ..Law::NeoHooke { c10: 0.4 }.into() };
        problem.regions = vec![Region { name: "first".into(), elements: elements.clone(), material }];
        let node = problem.mesh.nearest_node(SIDES).unwrap().0 as u32;
        let table = Curve::Table(vec![[0.0, 0.0], [0.5, 1.0], [1.0, 0.4]]);
        let (side, end) = (facets_at(&problem, 1), facets_at(&problem, 0));
        problem.loads = vec![
            Load::Force { nodes: vec![(node, 1.5), (node, 0.5)], force: [0.01, 0.0, 0.005], curve: ramp() },
            Load::Traction { facets: end, traction: [0.1, 0.0, -0.01], curve: table.clone() },
            Load::Traction { facets: side, traction: [0.0, 0.0, 0.004], curve: ramp() },
            Load::Gravity { elements: None, acceleration: [0.0, 1e6, 0.0], curve: table },
            Load::Gravity { elements: Some(elements), acceleration: [0.0, 0.0, -9e6], curve: ramp() },
        ];
        check(&format!("loads, {formulation}"), &problem, &[0.5, 1.0], 0.25);
    }
}

/// The rims of both faces are free: the tangent is not symmetric.
#[test]
fn pressure_on_faces_with_a_free_rim() {
    for (formulation, mut problem) in bars() {
        let (top, end) = (facets_at(&problem, 2), facets_at(&problem, 0));
        problem.loads = vec![
            Load::Pressure { facets: top.clone(), curve: Curve::Proportional(0.02) },
            Load::Pressure { facets: end, curve: Curve::Proportional(-0.1) },
        ];
        check(&format!("pressure, {formulation}"), &problem, &[0.5, 1.0], 0.25);
        // The same as a cavity that encloses nothing.
        problem.loads.remove(0);
        let control = Control::Pressure(Curve::Proportional(0.02));
        problem.cavities = vec![Cavity { name: "open".into(), facets: top, control }];
        assert!(problem.cavity_plane(&problem.cavities[0]).is_err());
        check(&format!("open cavity, {formulation}"), &problem, &[1.0], 0.25);
    }
}

#[test]
fn moved_supports() {
    for formulation in Formulation::ALL {
        let mut problem = bar(formulation);
        let curve = Curve::Table(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.3]]);
        hold(&mut problem, SIDES[0], [true, false, true], Some(Motion { displacement: [0.5, 9.0, -0.8], curve }));
        check(&format!("supports, {formulation}"), &problem, &[1.0, 2.0], 0.25);
    }
}

/// One equation prescribes a mean, others tie nodes of the end to one of them.
#[test]
fn linear_equations() {
    for formulation in Formulation::ALL {
        let mut problem = bar(formulation);
        let end = problem.mesh.select_nodes(|x| (x[0] - SIDES[0]).abs() < 1e-9);
        let mean = end.iter().map(|&node| (node, 2, 1.0 / end.len() as f64)).collect();
        problem.equations = vec![LinearEquation { terms: mean, value: Curve::Proportional(-0.6) }];
        for &node in &end[1..] {
            let terms = vec![(node, 0, 2.0), (end[0], 0, -2.0)];
            problem.equations.push(LinearEquation { terms, value: Curve::ZERO });
        }
        problem.loads = vec![Load::Force { nodes: vec![(end[0], 1.0)], force: [0.2, 0.0, 0.0], curve: ramp() }];
        check(&format!("equations, {formulation}"), &problem, &[0.5, 1.0], 0.25);
    }
}

#[test]
fn cavities_by_volume_and_by_gas() {
    let mut actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
    actuator.channel.half_width = 0.0;
    let gas = |exponent: f64| {
        Control::Gas(Gas { atmosphere: 0.1013, exponent, amount: Curve::Table(vec![[0.0, 1.0], [1.0, 1.5]]) })
    };
    let volume = || Control::Volume(Curve::Proportional(60.0));
    for (formulation, controls) in [
        (Formulation::Hex8Q1p0, vec![volume(), gas(1.0), gas(1.4)]),
        (Formulation::Hex27, vec![volume(), gas(1.4)]),
        (Formulation::Tet10, vec![gas(1.0)]),
    ] {
        for control in controls {
            let name = format!("{formulation}, {control:?}");
            let mut problem =
                actuator_problem(&actuator, [8.0, 9.0, 8.0], formulation, Invariant::Isochoric, ContactMethod::None);
            problem.cavities[0].control = control;
            problem.clock = Clock::Steps;
            let (_, states, _) = check(&name, &problem, &[0.5, 1.0], 0.25);
            assert!(states.iter().all(|state| state.cavity_pressure[0] > 1e-3), "{name}");
        }
    }
}

/// A cavity that ends in a plane of symmetry elsewhere than at y = 0.
#[test]
fn a_cavity_beside_the_origin() {
    let mut actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
    actuator.channel.half_width = 0.0;
    let formulation = Formulation::Hex8Q1p0;
    let mut problem =
        actuator_problem(&actuator, [8.0, 9.0, 8.0], formulation, Invariant::Isochoric, ContactMethod::None);
    problem.mesh = Arc::new(Arc::unwrap_or_clone(problem.mesh).map_nodes(|[x, y, z]| [x - 3.0, y + 7.0, z + 1.0]));
    problem.cavities[0].control = Control::Volume(Curve::Proportional(60.0));
    problem.clock = Clock::Steps;
    assert_eq!(problem.cavity_plane(&problem.cavities[0]), Ok(7.0));
    check("beside the origin", &problem, &[0.5, 1.0], 0.25);
}

/// A block on a table, pressed from above by an obstacle of every shape, which moves down and sideways. The steps are small: in large ones
/// the solver's path of tet10 under the cuboid stops on the way.
#[test]
fn obstacles() {
    let turned = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
    let shapes = [
        Shape::Plane { point: [0.0, 0.0, 1.02], normal: [0.2, 0.1, -1.0] },
        Shape::Sphere { centre: [0.7, 0.9, 3.02], radius: 2.0, is_hollow: false },
        Shape::Sphere { centre: [1.0, 1.0, -3.0], radius: 4.25, is_hollow: true },
        Shape::Cylinder { point: [0.0, 0.8, 2.02], axis: [1.0, 0.2, 0.0], radius: 1.0, is_hollow: false },
        Shape::Cuboid { centre: [1.3, 0.8, 1.52], size: [1.1, 2.7, 1.0], axes: turned, edge_radius: 0.2 },
    ];
    for formulation in [Formulation::Hex8Q1p0, Formulation::Hex20, Formulation::Hex27, Formulation::Tet15] {
        for shape in &shapes {
            let name = format!("{formulation}, {shape:?}");
            let mesh = Lattice::uniform([0.0; 3], [2.0, 2.0, 1.0], [2, 2, 1]).mesh_all(formulation.element_kind());
            let facets = mesh.select_facets(|x| (x[2] - 1.0).abs() < 1e-9);
            let nodes = mesh.select_nodes(|x| x[2] == 0.0);
            let mut problem = Problem::body(mesh, formulation, Material::default());
            problem.clock = Clock::Steps;
            problem.supports = vec![Support { name: "table".into(), nodes, axes: [true; 3], motion: None }];
            let motion = Some(Motion { displacement: [0.05, -0.03, -0.3], curve: ramp() });
            let (shape, name_of) = (shape.clone(), "press".to_owned());
            problem.obstacles = vec![Obstacle {
                name: name_of,
                shape,
                facets,
                stiffness: 6.0,
                motion,
                report_force: false,
                penetration_tolerance: None,
                interference_until: None,
            }];
            let (solver, expected, found) = check(&name, &problem, &[0.5, 1.0], 0.02);
            for (found, expected) in found.iter().zip(&expected) {
                let distances = solver.obstacles()[0].distances(&expected.displacement, expected.parameter);
                let active = distances.iter().filter(|distance| **distance < 0.0).count();
                assert!(active >= 4 && found.contact_points == active, "{name}: {active}, {}", found.contact_points);
            }
        }
    }
}

/// The pair has a stiffness, a method and passes of its own; the problem has none of them.
#[test]
fn pairs_with_a_law_of_their_own() {
    for (method, is_two_pass) in [(ContactMethod::SinglePoint, false), (ContactMethod::MultiPoint, true)] {
        let mut problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::None);
        let pair = &mut problem.contact_pairs[0];
        (pair.method, pair.stiffness, pair.is_two_pass) = (Some(method), Some(2.5), is_two_pass);
        let (reference, expected) = follow_reference(&problem, &[20.0, 35.0]);
        let found = follow(&problem, &[20.0, 35.0], &strict());
        let name = format!("own {method:?}, two passes: {is_two_pass}");
        for (found, expected) in found.iter().zip(&expected) {
            let active = touching(&reference, expected);
            assert!(active > 0 && found.contact_points == active, "{name}: {active}, {}", found.contact_points);
        }
        assert_same_states(&name, &found, &expected);
    }
}
