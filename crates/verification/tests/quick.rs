//! Every row of the coarsest two meshes is within its bound.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use pneuflex::{Event, Study};
use pneuflex_verification::{Effort, advice, known_cases, run, table};

#[test]
fn the_coarsest_meshes_are_within_their_bounds() {
    let sections = run(Effort::Quick, &|row| print!("{}", table::line(row)));
    let missed: Vec<String> =
        sections.iter().flat_map(|s| &s.rows).filter(|row| row.is_fault()).map(table::line).collect();
    assert!(sections.iter().all(|s| !s.rows.is_empty()));
    assert!(missed.is_empty(), "rows that miss their bounds:\n{}", missed.concat());
}

/// What was once answered wrongly is right, as far as it is solved in a second or two; `cargo xtask cases` has the others.
#[test]
fn known_cases_are_right() {
    let wrong: Vec<_> =
        known_cases::run(Effort::Quick, &|_| {}).into_iter().filter(|case| case.verdict.is_err()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Whatever is advised was tried on an input, and helps; `cargo xtask cases` tries what takes minutes, too.
#[test]
fn advice_helps() {
    let tried =
        advice::run(Effort::Quick, &|tried| println!("{:5.1} s {}: {:?}", tried.seconds, tried.name, tried.verdict));
    let useless: Vec<_> = tried.into_iter().filter(|tried| tried.verdict.is_err()).collect();
    assert!(useless.is_empty(), "{useless:#?}");
}

/// The guess of a step knows what a moving obstacle has just reached, from the equilibrium alone: a run that goes on from a checkpoint makes the
/// same one.
#[test]
fn a_run_with_a_moving_obstacle_goes_on_as_if_it_had_not_been_stopped() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/cases/obstacle_comes_up.toml");
    let analysis = Study::load(file).and_then(|study| study.build()).unwrap();
    let mut checkpoints = Vec::new();
    let run = analysis.run().observer(|event| {
        if let Event::StepAccepted(checkpoint) = event {
            checkpoints.push((*checkpoint).clone());
        }
    });
    let expected = run.solve().unwrap();
    assert!(checkpoints.len() > 3, "{}", checkpoints.len());
    for (step, checkpoint) in checkpoints.into_iter().enumerate() {
        let found = analysis.run().resume_from(checkpoint).solve().unwrap();
        let energies = [&found, &expected].map(|solution| solution.states[0].strain_energy_mj);
        assert!((energies[0] / energies[1] - 1.0).abs() < 1e-9, "gone on with after step {}: {energies:?}", step + 1);
    }
}
