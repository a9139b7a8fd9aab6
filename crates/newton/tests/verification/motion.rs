//! Obstacles that move, and problems in other units: what must not depend on how a problem is put.

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::load::{Control, Gas, Load};
use pneuflex_model::{
    Clock, ContactMethod, Curve, Formulation, Invariant, Law, Material, Motion, Obstacle, Problem, Shape, Solver,
    Support,
};
use pneuflex_newton::{ConvergedState, Event, PathReport, follow_path};

use crate::fixtures::{coarse_chambers, difference, sum};

const RADIUS: f64 = 10.0;
const GAP: f64 = 0.5;
const WAY: f64 = 3.0;

/// Who goes to whom.
#[derive(Clone, Copy)]
enum Mover {
    Obstacle,
    Feet,
}

/// A rubber arch on two feet under an obstacle, one of which goes to the other.
fn arch(formulation: Formulation, shape: Shape, stiffness: f64, mover: Mover) -> Problem {
    let turn = std::f64::consts::PI;
    let mesh = Lattice::uniform([0.0; 3], [1.0, 4.0, 2.0], [12, 2, 2]).mesh_all(formulation.element_kind());
    let top = mesh.select_facets(|x| (x[2] - 2.0).abs() < 1e-9);
    let feet = mesh.select_nodes(|x| x[0] < 1e-9 || x[0] > 1.0 - 1e-9);
    let mesh = mesh.map_nodes(|[x, y, z]| {
        let (sine, cosine) = (turn * (1.0 - x)).sin_cos();
        let r = RADIUS - 2.0 + z;
        [r * cosine, y - 2.0, r * sine]
    });
    let mut problem = Problem::body(mesh, formulation, Law::NeoHooke { c10: 0.2 }.into());
    problem.material = Material { bulk_modulus: 200.0, invariant: Invariant::Isochoric, ..problem.material };
    let motion = |z: f64| Some(Motion { displacement: [0.0, 0.0, z], curve: Curve::Proportional(1.0) });
    let (of_obstacle, of_feet) = match mover {
        Mover::Obstacle => (motion(-WAY), None),
        Mover::Feet => (None, motion(WAY)),
    };
    problem.supports = vec![Support { name: "feet".into(), nodes: feet, axes: [true; 3], motion: of_feet }];
    let press = "press".into();
    problem.obstacles = vec![Obstacle {
        name: press,
        shape,
        facets: top,
        stiffness,
        motion: of_obstacle,
        report_force: true,
        penetration_tolerance: None,
        interference_until: None,
    }];
    problem.clock = Clock::Steps;
    problem
}

fn settings() -> Solver {
    Solver { first_step: 0.25, max_step: 0.25, min_step: 1e-4, ..Solver::default() }
}

/// The last state and what the path cost.
#[track_caller]
fn end_of(problem: &Problem) -> (ConvergedState, PathReport) {
    let mut last = None;
    let report = follow_path(problem, &[1.0], &settings(), &mut |event| {
        if let Event::Converged(state) = event {
            last = Some(state.clone());
        }
    });
    let report = report.unwrap_or_else(|ended| panic!("{}", ended.0));
    (last.unwrap(), report)
}

fn shapes() -> [(&'static str, Shape); 4] {
    let above = RADIUS + GAP;
    [
        ("plane", Shape::Plane { point: [0.0, 0.0, above], normal: [0.0, 0.0, -1.0] }),
        ("sphere", Shape::Sphere { centre: [0.0, 0.0, above + 6.0], radius: 6.0, is_hollow: false }),
        (
            "cylinder",
            Shape::Cylinder { point: [0.0, 0.0, above + 5.0], axis: [0.0, 1.0, 0.0], radius: 5.0, is_hollow: false },
        ),
        (
            "cuboid",
            Shape::Cuboid {
                centre: [0.0, 0.0, above + 3.0],
                size: [9.0, 12.0, 6.0],
                axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                edge_radius: 1.0,
            },
        ),
    ]
}

/// Seen from the obstacle, both problems are one.
#[test]
fn a_moved_obstacle_costs_what_moved_supports_cost() {
    for (name, shape) in shapes() {
        for (formulation, stiffness) in [
            (Formulation::Hex8Q1p0, 0.4),
            (Formulation::Hex8Q1p0, 4.0),
            (Formulation::Hex8Q1p0, 400.0),
            (Formulation::Tet10, 4.0),
        ] {
            let [(moved, cost), (of_feet, cost_of_feet)] =
                [Mover::Obstacle, Mover::Feet].map(|mover| end_of(&arch(formulation, shape.clone(), stiffness, mover)));
            println!("{name} {formulation} {stiffness}: {} {}", cost.iterations, cost_of_feet.iterations);
            let from_obstacle = sum(&moved.displacement, &vec![[0.0, 0.0, WAY]; moved.displacement.len()]);
            let u = difference(from_obstacle.as_flattened(), of_feet.displacement.as_flattened());
            assert!(u < 1e-6, "{name} {formulation} {stiffness}: {u:.1e}");
            assert!(
                2 * cost.iterations <= 3 * cost_of_feet.iterations,
                "{name} {formulation} {stiffness}: {} against {} iterations",
                cost.iterations,
                cost_of_feet.iterations
            );
        }
    }
}

/// The same problem with lengths and moduli in other units.
fn in_units(problem: &Problem, length: f64, modulus: f64) -> Problem {
    let mut other = problem.clone();
    other.mesh = problem.mesh.as_ref().clone().map_nodes(|x| x.map(|x| length * x)).into();
    let Law::NeoHooke { c10 } = problem.material.law else { panic!("the arch is of neo-Hookean rubber") };
    other.material.law = Law::NeoHooke { c10: modulus * c10 };
    other.material.bulk_modulus *= modulus;
    let scaled = |motion: &Motion| Motion { displacement: motion.displacement.map(|x| length * x), ..motion.clone() };
    for support in &mut other.supports {
        support.motion = support.motion.as_ref().map(scaled);
    }
    for obstacle in &mut other.obstacles {
        obstacle.motion = obstacle.motion.as_ref().map(scaled);
        obstacle.stiffness *= modulus / length;
        match &mut obstacle.shape {
            Shape::Plane { point, .. } => *point = point.map(|x| length * x),
            Shape::Sphere { centre, radius, .. } => {
                (*centre, *radius) = (centre.map(|x| length * x), length * *radius);
            }
            Shape::Cylinder { .. } | Shape::Cuboid { .. } => panic!("not used here"),
        }
    }
    other
}

#[test]
fn nothing_depends_on_the_units_of_length_and_force() {
    for (name, shape) in shapes().into_iter().take(2) {
        let problem = arch(Formulation::Hex8Q1p0, shape, 4.0, Mover::Obstacle);
        let (expected, cost) = end_of(&problem);
        for (length, modulus) in [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-3), (1e-3, 1e6), (1e3, 1e3)] {
            let (found, other) = end_of(&in_units(&problem, length, modulus));
            let found: Vec<f64> = found.displacement.as_flattened().iter().map(|u| u / length).collect();
            let u = difference(&found, expected.displacement.as_flattened());
            println!("{name}, length {length}, modulus {modulus}: {u:.1e}, {} iterations", other.iterations);
            assert!(u < 1e-9, "{name}, length {length}, modulus {modulus}: {u:.1e}");
            assert_eq!(other.iterations, cost.iterations, "{name}, length {length}, modulus {modulus}");
        }
    }
}

/// Two chambers that touch, pumped up with gas under their own weight.
#[test]
fn gas_weight_and_touching_walls_do_not_depend_on_units() {
    let in_units = |length: f64, modulus: f64| {
        let mut problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
        problem.mesh = problem.mesh.as_ref().clone().map_nodes(|x| x.map(|x| length * x)).into();
        let Law::Yeoh { c10, c20, c30 } = problem.material.law else { panic!("the default law is Yeoh's") };
        problem.material.law = Law::Yeoh { c10: modulus * c10, c20: modulus * c20, c30: modulus * c30 };
        problem.material.bulk_modulus *= modulus;
        problem.material.density = 1e-9;
        problem.contact.stiffness *= modulus / length;
        let amount = Curve::Table(vec![[0.0, 1.0], [1.0, 1.5]]);
        problem.cavities[0].control = Control::Gas(Gas { atmosphere: 0.1 * modulus, exponent: 1.0, amount });
        let acceleration = [0.0, 0.0, -9.81e4 * modulus / length];
        problem.loads = vec![Load::Gravity { elements: None, acceleration, curve: Curve::Proportional(1.0) }];
        problem.clock = Clock::Steps;
        let (state, report) = end_of(&problem);
        assert!(state.contact_points > 0);
        let u: Vec<f64> = state.displacement.as_flattened().iter().map(|u| u / length).collect();
        (u, report.iterations)
    };
    let (expected, iterations) = in_units(1.0, 1.0);
    for (length, modulus) in [(1e-3, 1.0), (1e3, 1e-3)] {
        let (found, other) = in_units(length, modulus);
        let u = difference(&found, &expected);
        assert!(u < 1e-9 && other == iterations, "length {length}, modulus {modulus}: {u:.1e}, {other} iterations");
    }
}
