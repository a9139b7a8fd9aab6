//! Paths that take their guesses from the path of a similar problem come to the states that they come to from rest, or leave it: on both sides
//! of an instability.

use pneuflex_model::load::Load;
use pneuflex_model::{Continuation, Problem, Solver};
use pneuflex_newton::{Cause, ConvergedState, EquilibriumPath, Event, Failure, Path};

use crate::arc_length::{FORCE, loaded};
use crate::buckling::strut;
use crate::fixtures::difference;

/// What a path comes to.
struct Followed {
    states: Vec<ConvergedState>,
    failure: Option<Failure>,
    kept: Option<EquilibriumPath>,
    /// Attempts along the neighbour's path that were accepted before the first one that was not.
    accepted: usize,
}

fn settings(continuation: Continuation) -> Solver {
    Solver { first_step: 0.05, max_step: 0.1, min_step: 1e-4, continuation, ..Solver::default() }
}

fn follow(problem: &Problem, times: &[f64], settings: &Solver, neighbour: Option<&EquilibriumPath>) -> Followed {
    let mut path = Path::new(problem, settings).unwrap();
    path.keep_equilibria();
    if let Some(neighbour) = neighbour {
        assert!(path.start_from(neighbour.clone()));
    }
    let (mut states, mut accepted, mut is_rejected) = (Vec::new(), 0, false);
    let times: Vec<_> = times.iter().map(|&at| at.into()).collect();
    let ended = path.follow(&times, &mut |event| match event {
        Event::Converged(state) => states.push(state.clone()),
        Event::StepAccepted(_) if !is_rejected => accepted += 1,
        Event::StepRejected { .. } => is_rejected = true,
        _ => {}
    });
    println!(
        "{} states, {} accepted, {} iterations, {}",
        states.len(),
        accepted,
        path.iterations(),
        ended.as_ref().err().map_or(String::new(), ToString::to_string)
    );
    Followed { states, failure: ended.err(), kept: path.take_equilibria(), accepted }
}

/// How a path along another one ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Along {
    /// The other one is none to follow.
    NotKept,
    /// It was left where the two differ: whoever asks begins again at rest.
    Left,
    /// To the end, which is that of the path from rest.
    ToTheEnd,
}

#[track_caller]
fn check_end(problem: &Problem, other: &Problem, times: &[f64]) -> (Along, Followed) {
    let settings = settings(Continuation::Load);
    let other = follow(other, times, &settings, None);
    let alone = follow(problem, times, &settings, None);
    let Some(neighbour) = other.kept else { return (Along::NotKept, alone) };
    let along = follow(problem, times, &settings, Some(&neighbour));
    for (along, alone) in along.states.iter().zip(&alone.states) {
        let apart = difference(along.displacement.as_flattened(), alone.displacement.as_flattened());
        assert!(apart < 1e-7 && along.negative_pivots == 0, "{}: {apart:.1e}", along.parameter);
    }
    let how = match &along.failure {
        Some(failure) if failure.cause == Cause::OtherBranch => Along::Left,
        failure => {
            assert_eq!(failure.is_some(), alone.failure.is_some());
            assert_eq!(along.states.len(), alone.states.len());
            Along::ToTheEnd
        }
    };
    assert!(along.accepted > 2, "{}", along.accepted);
    println!("{how:?}");
    (how, alone)
}

/// Below its limit point, and beyond, where there is no equilibrium near by: by the load alone the arch may snap without a word.
#[test]
fn an_arch_does_not_follow_a_neighbour_that_snaps_or_does_not() {
    let snapped = follow(&loaded(FORCE).0, &[0.3, 1.0], &settings(Continuation::Damped), None);
    let limit = snapped.states.iter().flat_map(|state| &state.snaps).next().unwrap().from.0;
    assert!(snapped.failure.is_none() && snapped.kept.is_none());
    let check = |share: f64, forces: [f64; 2]| {
        println!("{share}: {forces:?}");
        let [problem, other] = forces.map(|force| loaded(force * FORCE).0);
        check_end(&problem, &other, &[0.1, share * limit]).0
    };
    // Both before their limit points.
    for forces in [[1.0, 0.95], [0.95, 1.0], [0.95, 0.9]] {
        assert_eq!(check(0.7, forces), Along::ToTheEnd);
    }
    // One of them snaps, or both do.
    for (share, forces) in [(1.02, [1.0, 0.95]), (1.02, [0.95, 1.0]), (1.08, [1.0, 0.95]), (1.08, [0.9, 1.0])] {
        assert_ne!(check(share, forces), Along::ToTheEnd);
    }
}

#[test]
fn a_strut_does_not_follow_one_that_does_not_buckle() {
    let pushed = |share: f64| {
        let mut problem = strut();
        let Load::Traction { traction, .. } = &mut problem.loads[0] else { panic!("{:?}", problem.loads) };
        traction[0] *= share;
        problem
    };
    let [weak, full] = [0.85, 1.0].map(pushed);
    // Its tangent is positive definite with the stresses of the other one.
    let (how, alone) = check_end(&full, &weak, &[0.9, 1.1]);
    assert_eq!(how, Along::Left);
    assert!(matches!(alone.failure.unwrap().cause, Cause::IndefiniteTangent { .. }));
    assert_eq!(check_end(&full, &weak, &[0.9, 0.98]).0, Along::ToTheEnd);
}

#[test]
fn what_a_path_cannot_use_is_not_used() {
    let (problem, _) = loaded(FORCE);
    let kept = follow(&problem, &[0.2], &settings(Continuation::Load), None).kept.unwrap();
    let mut path = Path::new(&problem, &settings(Continuation::ArcLength)).unwrap();
    assert!(!path.start_from(kept.clone()) && !path.start_from(EquilibriumPath::default()));
    // A mesh of other size.
    let mut path = Path::new(&strut(), &settings(Continuation::Load)).unwrap();
    assert!(!path.start_from(kept));
}
