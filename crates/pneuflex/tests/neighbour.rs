//! Designs that take their guesses from a similar one have the states that they have from rest.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

use pneuflex::post::summary::StepSummary;
use pneuflex::{Change, Error, Neighbour, Solution, Study, template};

fn solve(study: &Study, neighbour: Option<Neighbour>) -> Result<Solution, Error> {
    study.build().unwrap().run().threads(1).start_from(neighbour).keep_equilibria(true).solve()
}

fn chambers(changes: &[(&str, &str)]) -> Study {
    let mut study = Study::from_text("case.toml", &template::actuator(2)).unwrap();
    let common = [("mesh.resolution", "\"draft\""), ("load.pressure_kpa", "[10, 30]")];
    study.set_all(common.iter().chain(changes).map(|(key, value)| Change::new(*key, *value))).unwrap();
    study
}

/// Largest difference of what is found, relative to its size.
fn difference(a: &Solution, b: &Solution) -> f64 {
    assert_eq!(a.states.len(), b.states.len());
    let numbers = |state: &StepSummary| {
        let StepSummary { end_face_angle_deg, cavity_volume_mm3, strain_energy_mj, von_mises_p99_mpa, .. } = state;
        [end_face_angle_deg.unwrap(), *cavity_volume_mm3, *strain_energy_mj, *von_mises_p99_mpa]
    };
    let mut worst: f64 = 0.0;
    for (a, b) in a.states.iter().zip(&b.states) {
        assert_eq!(a.contact.gaps_in_contact, b.contact.gaps_in_contact);
        for (a, b) in numbers(a).iter().zip(numbers(b)) {
            worst = worst.max((a - b).abs() / b.abs());
        }
    }
    worst
}

#[test]
fn neighbours_have_their_own_states_with_fewer_iterations() {
    let neighbour = solve(&chambers(&[]), None).unwrap().neighbour.unwrap();
    // Through a file.
    let neighbour = Neighbour::from_bytes(&neighbour.to_bytes().unwrap()).unwrap();
    let [mut by_themselves, mut along] = [0, 0];
    for design in [
        [("actuator.gap", "2.05"), ("actuator.side_wall", "1.0")],
        [("actuator.gap", "1.95"), ("actuator.side_wall", "1.03")],
        [("actuator.gap", "1.9"), ("actuator.side_wall", "0.97")],
    ] {
        let rest = solve(&chambers(&design), None).unwrap();
        let near = solve(&chambers(&design), Some(neighbour.clone())).unwrap();
        assert!(near.has_started_from && !rest.has_started_from);
        assert_eq!(near.states[1].contact.gaps_in_contact, 1);
        println!(
            "{design:?}: {} iterations for {}, {:.1e}",
            near.iterations,
            rest.iterations,
            difference(&near, &rest)
        );
        assert!(difference(&near, &rest) < 1e-7, "{design:?}: {:e}", difference(&near, &rest));
        (by_themselves, along) = (by_themselves + rest.iterations, along + near.iterations);
    }
    assert!(along < by_themselves, "{along} {by_themselves}");
}

#[test]
fn a_neighbour_that_moves_otherwise_is_left() {
    let neighbour = solve(&chambers(&[]), None).unwrap().neighbour.unwrap();
    // Three times as stiff: its steps are others.
    let stiff = chambers(&[("material.c10", "0.8136"), ("material.c20", "0.09")]);
    let ended = solve(&stiff, Some(neighbour.clone())).unwrap_err();
    assert!(ended.has_left_neighbour(), "{ended}");
    // Bodies that meet obstacles, and other meshes, have no use for it.
    let plate = "[{ name = \"plate\", shape = \"plane\", point = [0, 0, -1], normal = [0, 0, 1] }]";
    assert!(!solve(&chambers(&[("obstacle", plate)]), Some(neighbour.clone())).unwrap().has_started_from);
    assert!(!solve(&chambers(&[("mesh.wall_elements", "2")]), Some(neighbour)).unwrap().has_started_from);
}
