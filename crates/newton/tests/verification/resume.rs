//! A path that goes on from a checkpoint is the path that never ended.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pneuflex_model::{Clock, ContactMethod, Control, Curve, Formulation, Invariant, Problem, Solver};
use pneuflex_newton::{Cause, Checkpoint, ConvergedState, Event, Path, ResumeError};

use crate::fixtures::{coarse_chambers, difference};

const PRESSURES_KPA: [f64; 3] = [5.0, 25.0, 35.0];

/// Small steps, so that most checkpoints are between requested pressures.
fn settings() -> Solver {
    Solver { max_step: 6.0, ..Solver::default() }
}

fn problem() -> Problem {
    coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint)
}

fn follow_from(problem: &Problem, checkpoint: Option<Checkpoint>) -> (Vec<Checkpoint>, Vec<ConvergedState>) {
    let (mut checkpoints, mut reached) = (Vec::new(), Vec::new());
    let from = checkpoint.as_ref().map_or(0.0, |checkpoint| checkpoint.parameter.0);
    let settings = settings();
    let mut observer = |event: Event<'_>| {
        if let Event::StepAccepted(checkpoint) = event {
            checkpoints.push(checkpoint.clone());
        }
    };
    let mut path = Path::new(problem, &settings).unwrap();
    if let Some(checkpoint) = checkpoint {
        path.resume(checkpoint).unwrap();
    }
    for pressure in PRESSURES_KPA.into_iter().filter(|pressure| *pressure >= from) {
        reached.push(path.advance_to(pressure, &mut observer).unwrap());
    }
    (checkpoints, reached)
}

#[test]
fn every_checkpoint_leads_to_the_same_end() {
    check_every_checkpoint(&problem());
}

/// Where surfaces are cut along each other's edges is found again, too, and so are the multipliers of their averaged gaps.
#[test]
fn every_checkpoint_of_mortar_contact_leads_to_the_same_end() {
    let mut problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::Mortar);
    problem.contact.penetration_tolerance = Some(5e-3);
    check_every_checkpoint(&problem);
}

#[track_caller]
fn check_every_checkpoint(problem: &Problem) {
    let (checkpoints, expected) = follow_from(problem, None);
    let between = checkpoints.iter().filter(|c| !PRESSURES_KPA.contains(&c.parameter.0)).count();
    assert!(between > 3 && expected.last().unwrap().contact_points > 0);
    assert!(checkpoints.iter().any(|c| c.linearisation.is_some()));
    for checkpoint in checkpoints {
        let at = checkpoint.parameter.0;
        let (_, reached) = follow_from(problem, Some(checkpoint));
        let expected = &expected[expected.len() - reached.len()..];
        for (found, expected) in reached.iter().zip(expected) {
            let u = difference(found.displacement.as_flattened(), expected.displacement.as_flattened());
            let reaction = difference(found.reaction.as_flattened(), expected.reaction.as_flattened());
            println!("from {at} kPa to {} kPa: {u:.1e}, {reaction:.1e}", found.parameter);
            assert!(u < 1e-10 && reaction < 1e-10, "from {at} kPa: {u:.1e}, {reaction:.1e}");
            assert_eq!((found.iterations, found.load_steps), (expected.iterations, expected.load_steps));
        }
    }
}

/// The pressures that a pumped volume needs are among what a checkpoint holds.
#[test]
fn checkpoints_hold_the_unknowns_beside_the_displacements() {
    let mut problem = problem();
    problem.cavities[0].control = Control::Volume(Curve::Proportional(100.0));
    problem.clock = Clock::Steps;
    let settings = Solver { first_step: 0.1, max_step: 0.2, min_step: 1e-3, ..Solver::default() };
    let follow = |checkpoint: Option<Checkpoint>| {
        let mut checkpoints = Vec::new();
        let mut observer = |event: Event<'_>| {
            if let Event::StepAccepted(checkpoint) = event {
                checkpoints.push(checkpoint.clone());
            }
        };
        let mut path = Path::new(&problem, &settings).unwrap();
        if let Some(checkpoint) = checkpoint {
            path.resume(checkpoint).unwrap();
        }
        let reached = path.advance_to(1.0, &mut observer).unwrap();
        (reached, checkpoints)
    };
    let (expected, checkpoints) = follow(None);
    assert!(
        expected.cavity_pressures[0].mpa() > 0.005 && expected.contact_points > 0,
        "{:?}",
        expected.cavity_pressures
    );
    assert!(checkpoints.len() > 3 && checkpoints.iter().all(|checkpoint| checkpoint.bordered.len() == 1));
    for checkpoint in checkpoints {
        let (reached, _) = follow(Some(checkpoint));
        let u = difference(reached.displacement.as_flattened(), expected.displacement.as_flattened());
        let pressure = reached.cavity_pressures[0].mpa() / expected.cavity_pressures[0].mpa() - 1.0;
        assert!(u < 1e-10 && pressure.abs() < 1e-10, "{u:.1e}, {pressure:.1e}");
    }
}

#[test]
fn a_stopped_path_ends_before_the_next_iteration_and_goes_on_later() {
    let problem = problem();
    let settings = settings();
    let (_, expected) = follow_from(&problem, None);
    let stop = Arc::new(AtomicBool::new(false));
    let (mut iterations, mut last) = (0, None);
    let mut observer = |event: Event<'_>| match event {
        Event::StepAccepted(checkpoint) => last = Some(checkpoint.clone()),
        Event::Iteration(record) => {
            iterations += 1;
            // In the middle of a step on the way to the second pressure.
            stop.store(record.parameter.0 > 12.0, Ordering::Relaxed);
        }
        Event::StepRejected { cause, .. } => panic!("{cause}"),
        _ => (),
    };
    let mut path = Path::new(&problem, &settings).unwrap();
    path.stop_when(Arc::clone(&stop));
    path.advance_to(5.0, &mut observer).unwrap();
    let failure = path.advance_to(25.0, &mut observer).unwrap_err();
    assert_eq!(failure.cause, Cause::Interrupted);
    let (_, reached) = follow_from(&problem, last);
    assert!(difference(reached[0].displacement.as_flattened(), expected[1].displacement.as_flattened()) < 1e-10);
}

#[test]
fn a_checkpoint_of_another_problem_is_refused() {
    let problem = problem();
    let (checkpoints, _) = follow_from(&problem, None);
    let settings = settings();
    let mut path = Path::new(&problem, &settings).unwrap();
    let mut short = checkpoints[0].clone();
    short.displacement.pop();
    assert!(matches!(path.resume(short).unwrap_err(), ResumeError::Misfit(_)));
    let mut undefined = checkpoints[0].clone();
    undefined.multipliers[0] = f64::NAN;
    assert!(matches!(path.resume(undefined).unwrap_err(), ResumeError::Misfit(_)));
}
