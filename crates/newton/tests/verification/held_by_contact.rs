//! Bodies that nothing but contact holds: springs help until it does, and carry nothing in any result.

use pneuflex_contact::ContactModel;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::load::Load;
use pneuflex_model::{
    Clock, Continuation, Curve, Formulation, Law, Material, Motion, Obstacle, Problem, Shape, Solver,
};
use pneuflex_newton::{Cause, ConvergedState, Path, springs_of};

use crate::fixtures::{follow, sum};

const C10: f64 = 0.2;

fn settings() -> Solver {
    Solver { tolerance: 1e-9, first_step: 0.25, max_step: 0.5, min_step: 1e-3, ..Solver::default() }
}

/// A cube of 2 mm, without any support; `round` of the way to a ball.
fn free_body(formulation: Formulation, cells: usize, round: f64) -> Problem {
    let mesh = Lattice::uniform([-1.0; 3], [1.0; 3], [cells; 3]).mesh_all(formulation.element_kind());
    let mesh = mesh.map_nodes(|x| {
        let square = x.map(|t| t * t);
        std::array::from_fn(|k| {
            let (a, b) = (square[(k + 1) % 3], square[(k + 2) % 3]);
            x[k] * (1.0 - round + round * (1.0 - 0.5 * (a + b) + a * b / 3.0).sqrt())
        })
    });
    let material = Material { law: Law::NeoHooke { c10: C10 }, bulk_modulus: 2e2, ..Material::default() };
    let mut problem = Problem::body(mesh, formulation, material);
    problem.clock = Clock::Steps;
    problem
}

/// Adds a plane through (0, 0, `height`) that all faces may touch, moved along z.
fn add_plane(problem: &mut Problem, name: &str, height: f64, normal: [f64; 3], way: f64) {
    let motion = Motion { displacement: [0.0, 0.0, way], curve: Curve::Proportional(1.0) };
    problem.obstacles.push(Obstacle {
        name: name.into(),
        shape: Shape::Plane { point: [0.0, 0.0, height], normal },
        facets: problem.mesh.boundary_facets(),
        stiffness: 40.0,
        motion: (way != 0.0).then_some(motion),
        report_force: true,
        penetration_tolerance: Some(1e-4),
        interference_until: None,
    });
}

/// A force on the lower half: on top a ball would roll away from under it.
fn push(problem: &mut Problem, total: [f64; 3]) {
    let nodes = problem.mesh.select_nodes(|x| x[0].abs() < 0.6 && x[1].abs() < 0.6 && x[2] < 0.0);
    let share = 1.0 / nodes.len() as f64;
    let nodes = nodes.into_iter().map(|node| (node, share)).collect();
    problem.loads.push(Load::Force { nodes, force: total, curve: Curve::Proportional(1.0) });
}

/// Force along the normal of every obstacle, N.
fn forces(problem: &Problem, state: &ConvergedState) -> Vec<f64> {
    let mut model = ContactModel::of(problem);
    model.set_parameter(state.parameter);
    model.set_multipliers(state.contact_multipliers.clone());
    let positions = sum(&problem.mesh.nodes, &state.displacement);
    let blocks = model.search(&positions).blocks;
    let on = |number: usize| {
        let own = blocks.iter().filter(|block| block.partner == pneuflex_contact::Partner::Obstacle(number));
        own.flat_map(|block| &block.points).map(|point| point.traction * point.area).sum()
    };
    (0..problem.obstacles.len()).map(on).collect()
}

fn centre(state: &ConvergedState) -> [f64; 3] {
    let count = state.displacement.len() as f64;
    std::array::from_fn(|k| state.displacement.iter().map(|u| u[k]).sum::<f64>() / count)
}

#[test]
fn a_block_between_two_plates_is_pressed_uniformly() {
    for formulation in [Formulation::Hex8Q1p0, Formulation::Tet10] {
        let mut problem = free_body(formulation, 2, 0.0);
        assert!(springs_of(&problem).is_empty());
        add_plane(&mut problem, "lower", -1.0, [0.0, 0.0, 1.0], 0.0);
        add_plane(&mut problem, "upper", 1.0, [0.0, 0.0, -1.0], -0.3);
        assert!(problem.supports.is_empty() && springs_of(&problem).len() == problem.mesh.num_nodes());
        let state = follow(&problem, &[1.0], &settings()).remove(0);
        let stretch = 1.0 - 0.3 / 2.0;
        let expected = 4.0 * 2.0 * C10 * (f64::powi(stretch, -2) - stretch);
        for force in forces(&problem, &state) {
            assert!((force / expected - 1.0).abs() < 5e-3, "{formulation}: {force} N instead of {expected}");
        }
        let [x, y, z] = centre(&state);
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6 && (z + 0.15).abs() < 1e-3, "{formulation}: {x} {y} {z}");
        assert!(state.iterations <= 20, "{formulation}: {} iterations", state.iterations);
    }
}

#[test]
fn a_ball_on_a_table_carries_its_force_to_it() {
    let mut problem = free_body(Formulation::Hex27, 3, 0.9);
    let lowest = problem.mesh.nodes.iter().fold(0.0_f64, |low, x| low.min(x[2]));
    add_plane(&mut problem, "table", lowest, [0.0, 0.0, 1.0], 0.0);
    push(&mut problem, [0.0, 0.0, -0.2]);
    let states = follow(&problem, &[1.0, 2.0], &settings());
    // A path that is followed by its arc length ends at the same state, without the springs, too.
    let by_arc = Solver { continuation: Continuation::ArcLength, ..settings() };
    let all = states.iter().cloned().chain(follow(&problem, &[1.0], &by_arc));
    for (state, expected) in all.zip([0.2, 0.4, 0.2]) {
        let state = &state;
        let [force] = forces(&problem, state)[..] else { panic!("one obstacle") };
        assert!((force - expected).abs() < 1e-6 * expected, "{force} N instead of {expected}");
        let [x, y, z] = centre(state);
        assert!(x.abs() < 1e-4 && y.abs() < 1e-4 && z < 0.0, "{x} {y} {z}");
    }
    let iterations: usize = states.iter().map(|state| state.iterations).sum();
    assert!(iterations <= 60, "{iterations} iterations");
}

/// On a slope without friction it slides for ever: that is no equilibrium.
#[test]
fn what_slips_off_is_not_held_by_the_springs() {
    let mut problem = free_body(Formulation::Hex8Q1p0, 2, 0.0);
    add_plane(&mut problem, "slope", -1.0, [0.0, 0.0, 1.0], 0.0);
    push(&mut problem, [0.02, 0.0, -0.2]);
    let mut path = Path::new(&problem, &settings()).unwrap();
    let failure = path.advance_to(1.0, &mut |_| {}).unwrap_err();
    assert!(matches!(failure.cause, Cause::HeldBySprings { .. }) && failure.reached.0 < 1.0, "{failure}");
}
