//! Paths that are followed by their arc length, past limit points: a shallow arch that snaps through under a force, against the same arch
//! whose loaded node is moved, which passes the limit points by itself.

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::load::Load;
use pneuflex_model::{
    Clock, Continuation, Curve, Formulation, Invariant, Law, Material, Motion, Obstacle, Problem, Shape, Solver,
    StateKind, Support,
};
use pneuflex_newton::{Checkpoint, ConvergedState, Event, Path, follow_path};

use crate::fixtures::difference;

const SPAN: f64 = 20.0;
const RISE: f64 = 2.5;
pub(crate) const FORCE: f64 = 0.002;
pub(crate) const TIMES: [f64; 3] = [0.3, 0.6, 1.0];

/// A quarter of a clamped arch, 4 mm wide and 1 mm thick.
fn arch() -> (Problem, u32) {
    let mesh = Lattice::uniform([0.0; 3], [SPAN, 2.0, 1.0], [6, 1, 1]).mesh_all(Formulation::Hex20.element_kind());
    let [feet, crown] = [SPAN, 0.0].map(|at| mesh.select_nodes(|x| (x[0] - at).abs() < 1e-9));
    let (node, _) = mesh.nearest_node([0.0, 0.0, 1.0]).unwrap();
    let middle = mesh.select_nodes(|x| x[1].abs() < 1e-9);
    let mesh = mesh.map_nodes(|[x, y, z]| [x, y, z + RISE * (1.0 - (x / SPAN).powi(2))]);
    let mut problem = Problem::body(mesh, Formulation::Hex20, Law::NeoHooke { c10: 0.2 }.into());
    problem.material = Material { bulk_modulus: 200.0, invariant: Invariant::Isochoric, ..problem.material };
    let hold = |name: &str, nodes, axes| Support { name: name.into(), nodes, axes, motion: None };
    problem.supports = vec![
        hold("feet", feet, [true; 3]),
        hold("crown", crown, [true, false, false]),
        hold("middle", middle, [false, true, false]),
    ];
    problem.clock = Clock::Steps;
    (problem, node as u32)
}

/// The same under a force on the middle of the crown.
pub(crate) fn loaded(force: f64) -> (Problem, u32) {
    let (mut problem, node) = arch();
    let curve = Curve::Proportional(1.0);
    problem.loads = vec![Load::Force { nodes: vec![(node, 1.0)], force: [0.0, 0.0, -force], curve }];
    (problem, node)
}

fn settings() -> Solver {
    Solver {
        first_step: 0.1,
        max_step: 0.3,
        min_step: 1e-5,
        continuation: Continuation::ArcLength,
        ..Solver::default()
    }
}

fn follow(problem: &Problem, checkpoint: Option<Checkpoint>) -> (Vec<ConvergedState>, Vec<Checkpoint>) {
    let (mut states, mut checkpoints) = (Vec::new(), Vec::new());
    let mut path = Path::new(problem, &settings()).unwrap();
    let left: Vec<_> = match checkpoint {
        Some(checkpoint) => {
            let greatest = checkpoint.arc.greatest;
            path.resume(checkpoint).unwrap();
            TIMES.iter().filter(|at| **at >= greatest).map(|at| (*at).into()).collect()
        }
        None => TIMES.map(Into::into).to_vec(),
    };
    let mut observer = |event: Event<'_>| match event {
        Event::StepAccepted(checkpoint) => checkpoints.push(checkpoint.clone()),
        Event::Converged(state) => states.push(state.clone()),
        Event::StepRejected { cause, .. } => println!("{cause}"),
        _ => (),
    };
    let end = path.follow(&left, &mut observer);
    end.unwrap_or_else(|failure| panic!("{failure}"));
    println!("{} iterations", path.iterations());
    (states, checkpoints)
}

#[test]
fn an_arch_snaps_through_as_when_it_is_moved() {
    let force = FORCE;
    let (problem, node) = loaded(force);
    let (states, checkpoints) = follow(&problem, None);
    let down = |state: &ConvergedState| -state.displacement[node as usize][2];
    for state in &states {
        println!("{:?} {} at {}, {} unstable", state.kind, down(state), state.parameter, state.negative_pivots);
    }
    let of = |kind| states.iter().filter(move |state| state.kind == kind);
    assert_eq!((of(StateKind::GreatestLoad).count(), of(StateKind::LeastLoad).count()), (1, 1));
    assert_eq!(of(StateKind::Requested).map(|state| state.parameter.0).collect::<Vec<_>>(), TIMES);
    assert!(states.iter().map(down).is_sorted() && states.len() > 6);

    // Moved down to where each state is.
    let (mut moved, _) = arch();
    let mut table = vec![[0.0, 0.0]];
    table.extend(states.iter().enumerate().map(|(i, state)| [i as f64 + 1.0, down(state)]));
    let motion = Some(Motion { displacement: [0.0, 0.0, -1.0], curve: Curve::Table(table) });
    moved.supports.push(Support { name: "push".into(), nodes: vec![node], axes: [false, false, true], motion });
    let times: Vec<f64> = (1..=states.len()).map(|i| i as f64).collect();
    let mut found = Vec::new();
    let by_load = Solver { first_step: 1.0, max_step: 1.0, min_step: 1e-4, ..Solver::default() };
    let report = follow_path(&moved, &times, &by_load, &mut |event| {
        if let Event::Converged(state) = event {
            found.push(state.clone());
        }
    });
    report.unwrap_or_else(|ended| panic!("{}", ended.0));
    for (state, moved) in states.iter().zip(&found) {
        let u = difference(state.displacement.as_flattened(), moved.displacement.as_flattened());
        let push = -moved.reaction[node as usize][2] / force;
        println!("{:.6} {push:.6} {u:.1e}", state.parameter.0);
        assert!((push - state.parameter.0).abs() < 1e-5 && u < 1e-4, "{} {push} {u:.1e}", state.parameter);
    }

    for checkpoint in checkpoints.into_iter().step_by(3) {
        let at = checkpoint.parameter.0;
        let (again, _) = follow(&problem, Some(checkpoint));
        for (found, expected) in again.iter().zip(&states[states.len() - again.len()..]) {
            let u = difference(found.displacement.as_flattened(), expected.displacement.as_flattened());
            assert!(u < 1e-10 && found.kind == expected.kind, "from {at}: {u:.1e} {:?}", found.kind);
            assert_eq!((found.iterations, found.load_steps), (expected.iterations, expected.load_steps), "from {at}");
        }
    }
}

/// The crown comes down on a table: contact begins on the falling branch, and ends it.
#[test]
fn a_table_ends_the_snap() {
    let (mut problem, node) = loaded(FORCE);
    problem.obstacles = vec![Obstacle {
        name: "table".into(),
        shape: Shape::Sphere { centre: [0.0, 0.0, RISE - 2.0 - 3.0], radius: 3.0, is_hollow: false },
        facets: problem.mesh.select_facets(|x| (x[2] - RISE * (1.0 - (x[0] / SPAN).powi(2))).abs() < 1e-9),
        stiffness: 2.0,
        motion: None,
        report_force: true,
        penetration_tolerance: None,
        interference_until: None,
    }];
    let (states, _) = follow(&problem, None);
    for state in &states {
        println!(
            "{:?} {:.4} at {}, {} unstable, {} points",
            state.kind,
            -state.displacement[node as usize][2],
            state.parameter,
            state.negative_pivots,
            state.contact_points
        );
    }
    let last = states.last().unwrap();
    assert!(last.kind == StateKind::Requested && last.parameter.0 == 1.0 && last.contact_points > 0);
    assert!(states.iter().any(|state| state.kind == StateKind::GreatestLoad && state.contact_points == 0));
}

/// With the full invariant the undeformed body has a pressure, and no path begins at it.
#[test]
fn a_path_begins_at_the_equilibrium_without_loads() {
    let (mut problem, _) = loaded(0.1 * FORCE);
    problem.material.invariant = Invariant::Full;
    problem.material.bulk_modulus = 20.0;
    let (states, _) = follow(&problem, None);
    let mut expected = Vec::new();
    let by_load = Solver { continuation: Continuation::Load, ..settings() };
    follow_path(&problem, &TIMES, &by_load, &mut |event| {
        if let Event::Converged(state) = event {
            expected.push(state.displacement.clone());
        }
    })
    .unwrap();
    assert_eq!((states.len(), expected.len()), (TIMES.len(), TIMES.len()));
    for (found, expected) in states.iter().zip(&expected) {
        let apart = difference(found.displacement.as_flattened(), expected.as_flattened());
        assert!(found.kind == StateKind::Requested && apart < 1e-7, "{}: {apart:.1e}", found.parameter);
    }
}

/// An overlap that is gone does not come back on the falling branch: the path ends before.
#[test]
fn an_overlap_that_was_pressed_out_stays_gone() {
    let (mut problem, _) = loaded(FORCE);
    let top = RISE + 1.0;
    problem.obstacles = vec![Obstacle {
        name: "lid".into(),
        shape: Shape::Plane { point: [0.0, 0.0, top - 0.02], normal: [0.0, 0.0, -1.0] },
        facets: problem.mesh.select_facets(|x| (x[2] - 1.0 - RISE * (1.0 - (x[0] / SPAN).powi(2))).abs() < 1e-9),
        stiffness: 2.0,
        motion: None,
        report_force: true,
        penetration_tolerance: None,
        interference_until: Some(TIMES[0].into()),
    }];
    let (states, _) = follow(&problem, None);
    let past: Vec<f64> =
        states.iter().filter(|state| state.kind == StateKind::PastLimit).map(|state| state.parameter.0).collect();
    assert!(!past.is_empty() && past.iter().all(|at| *at > TIMES[0]), "{past:?}");
}
