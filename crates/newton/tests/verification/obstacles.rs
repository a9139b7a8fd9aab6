//! Contact with obstacles, with a surface's own other side, and without penetration.

use pneuflex_contact::ContactModel;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::load::Load;
use pneuflex_model::{
    Clock, ContactMethod, Curve, Formulation, Invariant, Law, Material, Motion, Obstacle, Problem, Shape, Solver,
    Support,
};
use pneuflex_newton::{Augmentation, ConvergedState, Path};

use crate::fixtures::{coarse_chambers, difference, follow, sum};

const SIDES: [f64; 3] = [2.0, 2.0, 1.0];
const STIFFNESS: f64 = 20.0;
const WAY: f64 = 0.2;

fn settings() -> Solver {
    Solver { tolerance: 1e-9, first_step: 0.25, max_step: 0.25, min_step: 1e-3, ..Solver::default() }
}

/// A block on three planes of symmetry that a plane from above compresses.
fn pressed_block(formulation: Formulation) -> Problem {
    let mesh = Lattice::uniform([0.0; 3], SIDES, [2, 2, 1]).mesh_all(formulation.element_kind());
    let facets = mesh.select_facets(|x| (x[2] - SIDES[2]).abs() < 1e-9);
    let mut problem = Problem::body(mesh, formulation, Material { bulk_modulus: 1e4, ..Material::default() });
    for axis in 0..3 {
        let nodes = problem.mesh.select_nodes(|x| x[axis].abs() < 1e-9);
        let axes = std::array::from_fn(|k| k == axis);
        problem.supports.push(Support { name: format!("symmetry {axis}"), nodes, axes, motion: None });
    }
    let shape = Shape::Plane { point: [0.3, 0.4, SIDES[2]], normal: [0.0, 0.0, -3.0] };
    let motion = Motion { displacement: [0.0, 0.0, -WAY], curve: Curve::Proportional(1.0) };
    problem.obstacles = vec![Obstacle {
        name: "press".into(),
        shape,
        facets,
        stiffness: STIFFNESS,
        motion: Some(motion),
        report_force: true,
        penetration_tolerance: None,
        interference_until: None,
    }];
    problem.clock = Clock::Steps;
    problem
}

/// Nominal uniaxial stress of the incompressible material, MPa.
fn nominal(material: &Material, stretch: f64) -> f64 {
    let Law::Yeoh { c10, c20, c30 } = material.law else { panic!("the default law is Yeoh's") };
    let x = stretch * stretch + 2.0 / stretch - 3.0;
    2.0 * (stretch - stretch.powi(-2)) * (c10 + 2.0 * c20 * x + 3.0 * c30 * x * x)
}

/// Depths of all touching points at the end, mm, and the force that carries the block, N.
fn depths_and_force(problem: &Problem, state: &ConvergedState) -> (Vec<f64>, f64) {
    let mut model = ContactModel::of(problem);
    model.set_parameter(state.parameter);
    model.set_multipliers(state.contact_multipliers.clone());
    let positions = sum(&problem.mesh.nodes, &state.displacement);
    let depths = model.search(&positions).blocks.iter().flat_map(|b| &b.points).map(|p| -p.distance).collect();
    let force = problem.supports[2].nodes.iter().map(|&node| state.reaction[node as usize][2]).sum();
    (depths, force)
}

#[test]
fn a_block_under_a_plane_is_pressed_uniformly_to_the_depth_of_the_pressure() {
    for formulation in Formulation::ALL {
        let problem = pressed_block(formulation);
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let (depths, force) = depths_and_force(&problem, &state);
        let depth = depths[0];
        assert_eq!(depths.len(), 16 * problem.obstacles[0].facets.len());
        assert!(depths.iter().all(|d| (d - depth).abs() < 1e-9), "{formulation}");
        // Supports carry what the plane presses.
        let area = SIDES[0] * SIDES[1];
        assert!((force / (STIFFNESS * depth * area) - 1.0).abs() < 1e-8, "{formulation}: {force}");
        let expected = -nominal(&problem.material, 1.0 - (WAY - depth) / SIDES[2]) / STIFFNESS;
        assert!((depth / expected - 1.0).abs() < 2e-3, "{formulation}: {depth} for {expected}");
    }
}

#[test]
fn multipliers_take_the_depth_away() {
    for formulation in Formulation::ALL {
        let mut problem = pressed_block(formulation);
        problem.contact.penetration_tolerance = Some(1e-7);
        let state = follow(&problem, &[0.5, 1.0], &settings()).remove(1);
        let augmentation = state.augmentation.clone().unwrap();
        assert!(augmentation.failure.is_none() && (1..30).contains(&augmentation.count), "{augmentation:?}");
        let (depths, force) = depths_and_force(&problem, &state);
        assert!(depths.iter().all(|d| d.abs() <= 1e-7), "{formulation}");
        let expected = -nominal(&problem.material, 1.0 - WAY / SIDES[2]) * SIDES[0] * SIDES[1];
        assert!((force / expected - 1.0).abs() < 2e-3, "{formulation}: {force} for {expected}");
    }
}

/// The walls of two chambers: depths of some hundredths of a millimetre without multipliers.
#[test]
fn chambers_touch_without_depth_and_their_path_goes_on_from_every_checkpoint() {
    let plain = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
    let mut problem = plain.clone();
    problem.contact.penetration_tolerance = Some(1e-3);
    let deepest = |problem: &Problem, state: &ConvergedState| {
        let positions = sum(&problem.mesh.nodes, &state.displacement);
        let blocks = ContactModel::of(problem).search(&positions).blocks;
        blocks.iter().flat_map(|b| &b.points).fold(0.0, |d: f64, p| d.max(-p.distance))
    };
    let settings = Solver { max_step: 8.0, ..Solver::default() };
    let pressures = [15.0, 25.0, 35.0];
    let with_penalty = follow(&plain, &pressures, &settings);
    assert!(deepest(&plain, &with_penalty[2]) > 3e-3);

    let mut checkpoints = Vec::new();
    let mut observer = |event: pneuflex_newton::Event<'_>| {
        if let pneuflex_newton::Event::StepAccepted(checkpoint) = event {
            checkpoints.push(checkpoint.clone());
        }
    };
    let mut path = Path::new(&problem, &settings).unwrap();
    let expected = pressures.map(|pressure| path.advance_to(pressure, &mut observer).unwrap());
    for state in &expected[1..] {
        let augmentation = state.augmentation.as_ref().unwrap();
        println!("{} kPa: {augmentation:?}", state.parameter);
        assert!(augmentation.failure.is_none() && augmentation.count > 0);
        assert!(deepest(&problem, state) <= 1e-3);
    }
    assert!(checkpoints.iter().any(|c| !pressures.contains(&c.parameter.0) && !c.contact_multipliers.is_empty()));
    for checkpoint in checkpoints {
        let from = checkpoint.parameter.0;
        let mut observer = |_: pneuflex_newton::Event<'_>| ();
        let mut path = Path::new(&problem, &settings).unwrap();
        path.resume(checkpoint).unwrap();
        for (pressure, expected) in pressures.iter().zip(&expected).filter(|(pressure, _)| **pressure >= from) {
            let found = path.advance_to(*pressure, &mut observer).unwrap();
            let u = difference(found.displacement.as_flattened(), expected.displacement.as_flattened());
            assert!(u < 1e-10, "from {from} to {pressure} kPa: {u:.1e}");
            let [found, expected] = [&found, expected].map(|state| state.augmentation.as_ref().unwrap());
            assert_eq!((found.count, &found.failure), (expected.count, &expected.failure));
            assert!((found.distance - expected.distance).abs() < 1e-10);
        }
    }
}

/// What cannot be reached is said, and the state is the last equilibrium.
/// Clamped edges inside of an obstacle stay there whatever the traction on their faces: that is said, and everything else is solved.
#[test]
fn where_supports_hold_the_body_in_an_obstacle_no_multiplier_grows() {
    let sides = [4.0, 1.0, 1.0];
    let mesh = Lattice::uniform([0.0; 3], sides, [8, 2, 2]).mesh_all(Formulation::Hex8Sri.element_kind());
    let facets = mesh.select_facets(|x| x[2].abs() < 1e-9);
    let top = mesh.select_facets(|x| (x[2] - sides[2]).abs() < 1e-9);
    let is_end = |x: [f64; 3]| x[0].abs() < 1e-9 || (x[0] - sides[0]).abs() < 1e-9;
    let clamped = mesh.select_nodes(is_end);
    let mut problem = Problem::body(mesh, Formulation::Hex8Sri, Material::default());
    problem.supports = vec![Support { name: "clamp".into(), nodes: clamped, axes: [true; 3], motion: None }];
    problem.loads.push(Load::Pressure { facets: top, curve: Curve::Proportional(0.3) });
    problem.obstacles = vec![Obstacle {
        name: "table".into(),
        shape: Shape::Plane { point: [0.0, 0.0, -0.15], normal: [0.0, 0.0, 1.0] },
        facets,
        stiffness: STIFFNESS,
        motion: Some(Motion { displacement: [0.0, 0.0, 0.25], curve: Curve::Proportional(1.0) }),
        report_force: true,
        penetration_tolerance: Some(5e-3),
        interference_until: None,
    }];
    problem.clock = Clock::Steps;
    let mut path = Path::new(&problem, &settings()).unwrap();
    let state = path.advance_to(1.0, &mut |_| {}).unwrap();
    let Augmentation { count, distance, failure } = state.augmentation.clone().unwrap();
    assert!(failure.as_ref().is_some_and(|why| why.contains("table is 1.00e-1 mm deep where supports")), "{failure:?}");
    assert!((1..8).contains(&count) && distance < 5e-3, "{count} {distance}");
    // Points of the clamped edges' faces keep the penalty alone.
    let at_clamp = |facet: usize| {
        let nodes = problem.mesh.facet_nodes(problem.obstacles[0].facets[facet]);
        nodes.iter().any(|&node| is_end(problem.mesh.nodes[node as usize]))
    };
    let mut others = 0;
    for (number, lambda) in state.contact_multipliers.iter().enumerate() {
        if at_clamp(number / 16) {
            assert_eq!(*lambda, 0.0);
        } else {
            others += usize::from(*lambda > 0.0);
        }
    }
    assert!(others > 0);
}

#[test]
fn a_tolerance_out_of_reach_is_reported() {
    let mut problem = pressed_block(Formulation::Hex8Q1p0);
    problem.contact.penetration_tolerance = Some(1e-30);
    let state = follow(&problem, &[1.0], &settings()).remove(0);
    let augmentation = state.augmentation.clone().unwrap();
    assert!(augmentation.failure.is_some() && augmentation.distance > 0.0, "{augmentation:?}");
    let (depths, _) = depths_and_force(&problem, &state);
    assert!(depths.iter().all(|d| d.abs() < 1e-6));
}
