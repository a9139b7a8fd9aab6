//! Meshes on which results are far off say so, in every kind of file; those on which they are as exact as it is written do not.

#![allow(clippy::unwrap_used)]

use pneuflex::accuracy::Parameter;
use pneuflex::diagnosis::WarningKind;
use pneuflex::{Change, Solution, Study, template};

const WRONG_SIGN: &str = include_str!("../../../fixtures/accuracy/draft_wrong_sign.toml");

/// The solution, and what of the design is outside the table.
fn solved(text: &str, changes: &[(&str, &str)]) -> (Solution, Vec<Parameter>) {
    let mut study = Study::from_text("finger.toml", text).unwrap();
    study.set_all(changes.iter().map(|&(key, value)| Change::new(key, value))).unwrap();
    let analysis = study.build().unwrap();
    let solution = analysis.solve().unwrap();
    let outside = analysis.expected(&solution.states).unwrap().outside;
    (solution, outside.into_iter().map(|outside| outside.parameter).collect())
}

fn kinds(solution: &Solution) -> Vec<WarningKind> {
    solution.warnings.iter().map(|warning| warning.kind).collect()
}

#[test]
fn a_wrong_sign_is_warned_of_in_a_case_and_in_a_model() {
    let pressure = ("load.pressure_kpa", "[5.7082]");
    let (case, outside) = solved(WRONG_SIGN, &[pressure]);
    // The draft mesh has the wrong sign: if it has not any more, another example must be found.
    assert!(case.states[0].end_face_angle_deg.unwrap() < 0.0);
    assert_eq!(kinds(&case), [WarningKind::CoarseMesh, WarningKind::Accuracy]);
    assert_eq!(outside, [Parameter::Base, Parameter::Channel, Parameter::WeakBending]);
    let air = "[load]\ntimes = [1.0]\n[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 5.7082\n";
    let model = WRONG_SIGN.replace("[load]\npressure_kpa = [2.8541, 5.7082, 8.5623, 11.416]\n", air);
    let (model, of_model) = solved(&model, &[]);
    assert_eq!((kinds(&model), of_model), (kinds(&case), outside));
    let [of_case, of_model] = [&case, &model].map(|solution| &solution.warnings[1]);
    assert!(of_case.message.contains("at 5.7082 kPa it bends little"), "{of_case}");
    assert!(of_model.message.contains("at time 1 it bends little"), "{of_model}");
    for warning in [of_case, of_model] {
        assert!(warning.advice.contains("pneuflex converge"), "{warning}");
    }
}

#[test]
fn bending_that_nearly_cancels_is_warned_of_where_the_lengths_are_usual() {
    // With the flanges it is as long as two chambers, so that the probe is at its tip.
    let one = [
        ("actuator.chambers", "1"),
        ("actuator.flange", "5.0"),
        ("mesh.resolution", "draft"),
        ("load.pressure_kpa", "[20]"),
    ];
    let (right, outside) = solved(&template::two_chambers(), &one);
    assert_eq!((kinds(&right), outside), (vec![WarningKind::CoarseMesh], vec![]));
    assert!(right.warnings[0].message.contains("10 % in angle"), "{}", right.warnings[0]);
    let low = [&one[..], &[("actuator.height", "8.0")]].concat();
    let (weak, outside) = solved(&template::two_chambers(), &low);
    assert_eq!(outside, [Parameter::WeakBending]);
    assert_eq!(weak.warnings.last().unwrap().pressure_kpa, Some(20.0));
}
