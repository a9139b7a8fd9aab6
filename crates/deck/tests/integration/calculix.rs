//! The sample decks solved here, against the displacements that CalculiX found for them.

use std::fs;
use std::path::PathBuf;

use pneuflex_deck::{Deck, read};
use pneuflex_model::Solver;
use pneuflex_newton::{ConvergedState, Event, follow_path};
use serde_json::Value;

fn solve(name: &str) -> (Deck, Vec<ConvergedState>, Value) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/decks");
    let text = fs::read(folder.join(format!("{name}.inp"))).unwrap();
    let deck = read(name, text, &mut |_| Err(String::new())).unwrap();
    let settings =
        Solver { first_step: deck.schedule.first_increment, max_step: 1.0, min_step: 1e-4, ..Solver::default() };
    let mut states: Vec<ConvergedState> = Vec::new();
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            states.push(state.clone());
        }
    };
    let end = follow_path(&deck.problem, &deck.schedule.times, &settings, &mut observer);
    assert!(end.is_ok(), "{}", end.unwrap_err().0);
    let reference = fs::read_to_string(folder.join(format!("{name}.calculix.json"))).unwrap();
    (deck, states, serde_json::from_str(&reference).unwrap())
}

/// Largest difference over the watched nodes, relative to the largest displacement among them.
fn differences(name: &str) -> Vec<f64> {
    let (deck, states, reference) = solve(name);
    let landings = reference["landings"].as_array().unwrap();
    assert_eq!(landings.len(), states.len());
    let difference = |(state, landing): (&ConvergedState, &Value)| {
        assert!((state.parameter.0 - landing["time"].as_f64().unwrap()).abs() < 1e-12);
        let (mut largest, mut scale) = (0.0_f64, 0.0_f64);
        for (number, expected) in landing["displacement_mm"].as_object().unwrap() {
            let number: i32 = number.parse().unwrap();
            let node = deck.node_labels.iter().position(|label| label.as_ref().unwrap().number == number).unwrap();
            for axis in 0..3 {
                let (found, expected) = (state.displacement[node][axis], expected[axis].as_f64().unwrap());
                largest = largest.max((found - expected).abs());
                scale = scale.max(expected.abs());
            }
        }
        largest / scale
    };
    states.iter().zip(landings).map(difference).collect()
}

#[test]
fn blocks_in_contact_move_as_in_calculix() {
    let found = differences("blocks");
    assert!(found.iter().all(|difference| *difference < 0.01), "{found:?}");
}

#[test]
fn a_beam_of_two_materials_bends_as_in_calculix() {
    let found = differences("cantilever");
    assert!(found.len() == 2 && found.iter().all(|difference| *difference < 0.01), "{found:?}");
}

#[test]
fn a_tube_swells_and_stretches_as_in_calculix() {
    let found = differences("tube");
    assert!(found.len() == 2 && found.iter().all(|difference| *difference < 0.01), "{found:?}");
}
