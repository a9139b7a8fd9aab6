//! Bodies that snap under given loads (`Continuation::Damped`): they come to the states beyond the snap, which the arc length finds along the whole path.

use pneuflex_factor::Parallelism;
use pneuflex_model::{Continuation, Solver, StateKind};
use pneuflex_newton::{Checkpoint, ConvergedState, Event, Path, State, System, follow_path};

use crate::arc_length::{FORCE, TIMES, loaded};
use crate::buckling::{LENGTH, elastica, strut};
use crate::fixtures::difference;

fn states(problem: &pneuflex_model::Problem, times: &[f64], settings: &Solver) -> Vec<ConvergedState> {
    let mut states = Vec::new();
    let report = follow_path(problem, times, settings, &mut |event| {
        if let Event::Converged(state) = event {
            states.push(state.clone());
        }
    });
    println!(
        "{:?}: {} iterations",
        settings.continuation,
        report.unwrap_or_else(|ended| panic!("{}", ended.0)).iterations
    );
    states
}

#[test]
fn an_arch_snaps_to_the_branch_beyond() {
    let (problem, node) = loaded(FORCE);
    let by =
        |continuation| Solver { first_step: 0.1, max_step: 0.3, min_step: 1e-5, continuation, ..Solver::default() };
    let along = states(&problem, &TIMES, &by(Continuation::ArcLength));
    let limit = along.iter().find(|state| state.kind == StateKind::GreatestLoad).unwrap().parameter.0;
    let snapped = states(&problem, &TIMES, &by(Continuation::Damped));
    assert_eq!(snapped.iter().map(|state| state.parameter.0).collect::<Vec<_>>(), TIMES);
    let requested: Vec<_> = along.iter().filter(|state| state.kind == StateKind::Requested).collect();
    for (found, expected) in snapped.iter().zip(requested) {
        let apart = difference(found.displacement.as_flattened(), expected.displacement.as_flattened());
        println!("{}: {apart:.1e}, {:?}", found.parameter, found.snaps);
        assert!(apart < 1e-6 && found.negative_pivots == 0, "{}: {apart:.1e}", found.parameter);
    }
    let jumps: Vec<_> = snapped.iter().flat_map(|state| &state.snaps).collect();
    assert_eq!(jumps.len(), 1, "{jumps:?}");
    let snap = jumps[0];
    assert!(
        (snap.from.0 / limit - 1.0).abs() < 1e-3 && snap.from <= limit.into() && snap.to >= limit.into(),
        "{snap:?}"
    );
    assert!(problem.mesh.nodes[snap.node][0] < 5.0 && snap.moved > 1.0, "{snap:?}");
    // The energy given up is what the force does between the two states less what the arch stores.
    let mut system = System::new(&problem, Parallelism::Threads).unwrap();
    let mut at = |parameter: f64| {
        let mut found = None;
        let settings = Solver { min_step: 1e-7, ..by(Continuation::Damped) };
        states(&problem, &[parameter], &settings).iter().for_each(|state| found = Some(state.clone()));
        let state = found.unwrap();
        let energies = system.energies(&State::new(state.parameter, state.displacement.clone(), Vec::new())).unwrap();
        let stored: f64 = energies.iter().map(|(_, energy)| energy).sum();
        (stored, -state.displacement[node as usize][2])
    };
    let [(stored, down), (stored_after, down_after)] = [at(snap.from.0), at(snap.to.0)];
    let expected = FORCE * snap.to.0 * (down_after - down) - (stored_after - stored);
    let released = snap.released.unwrap();
    println!("released {released} mJ of {expected}");
    assert!((released / expected - 1.0).abs() < 2e-3, "{released} {expected}");
}

/// By the load alone a step may lead over the limit point to the branch beyond: it is told of. Below the limit point there is nothing to tell.
#[test]
fn a_load_step_over_a_limit_point_is_told_of() {
    let (problem, _) = loaded(FORCE);
    for max_step in [0.05, 0.1, 0.2, 0.4] {
        let settings = Solver { first_step: 0.05, max_step, min_step: 1e-5, ..Solver::default() };
        // The limit point is at 0.3693.
        let [below, beyond, far] = [0.33, 0.44, 1.0].map(|end| {
            let found = states(&problem, &[end], &settings);
            found.into_iter().flat_map(|state| state.snaps).collect::<Vec<_>>()
        });
        assert!(below.is_empty(), "{max_step}: {below:?}");
        for snaps in [beyond, far] {
            println!("{max_step}: {snaps:?}");
            let is_there = |snap: &pneuflex_newton::Snap| snap.to.0 > 0.3693 && snap.steps == 0 && snap.moved > 0.5;
            assert!(snaps.iter().any(is_there), "{max_step}: {snaps:?}");
        }
    }
}

#[test]
fn a_strut_buckles_to_the_elastica() {
    let problem = strut();
    let (tip, _) = problem.mesh.nearest_node([LENGTH, 0.0, 0.5]).unwrap();
    let settings = Solver {
        first_step: 0.2,
        max_step: 0.5,
        min_step: 1e-5,
        continuation: Continuation::Damped,
        ..Solver::default()
    };
    let found = states(&problem, &[0.9, 1.1, 1.3], &settings);
    for state in &found {
        let deflection = state.displacement[tip][2].abs() / LENGTH;
        let [least, most] = [0.98, 1.005].map(|share| elastica((share * state.parameter.0).max(1.0)));
        println!("{}: {deflection:.4} from {least:.4} to {most:.4}, {:?}", state.parameter, state.snaps);
        assert!((least..=most + 1e-9).contains(&deflection), "{}: {deflection}", state.parameter);
    }
    assert!(found[0].snaps.is_empty() && found[2].snaps.is_empty());
    assert!(!found[1].snaps.is_empty());
}

/// A path that was interrupted just before a snap, in the states behind it, or anywhere else goes on as if nothing had been.
#[test]
fn every_checkpoint_of_a_path_that_snaps_leads_to_the_same_end() {
    let problem = strut();
    let settings = Solver {
        first_step: 0.2,
        max_step: 0.5,
        min_step: 1e-2,
        continuation: Continuation::Damped,
        ..Solver::default()
    };
    let times = [0.9, 1.1, 1.3];
    let follow = |checkpoint: Option<Checkpoint>| {
        let (mut checkpoints, mut reached) = (Vec::new(), Vec::new());
        let mut observer = |event: Event<'_>| {
            if let Event::StepAccepted(checkpoint) = event {
                checkpoints.push(checkpoint.clone());
            }
        };
        let mut path = Path::new(&problem, &settings).unwrap();
        let from = checkpoint.as_ref().map_or(0.0, |checkpoint| checkpoint.parameter.0);
        if let Some(checkpoint) = checkpoint {
            path.resume(checkpoint).unwrap();
        }
        for time in times.into_iter().filter(|time| *time >= from) {
            reached.push(path.advance_to(time, &mut observer).unwrap());
        }
        (checkpoints, reached)
    };
    let (checkpoints, expected) = follow(None);
    let behind = checkpoints.iter().filter(|checkpoint| !checkpoint.snaps.is_empty()).count();
    assert!(behind > 0 && behind < checkpoints.len(), "{behind} of {}", checkpoints.len());
    for checkpoint in checkpoints {
        let at = checkpoint.parameter.0;
        let (_, reached) = follow(Some(checkpoint));
        for (found, expected) in reached.iter().zip(&expected[expected.len() - reached.len()..]) {
            let apart = difference(found.displacement.as_flattened(), expected.displacement.as_flattened());
            assert!(apart < 1e-9, "from {at} to {}: {apart:.1e}", found.parameter);
            assert_eq!(found.snaps.len(), expected.snaps.len(), "from {at} to {}", found.parameter);
        }
    }
}
