//! What the two standard cases come out at: snapshots with six significant digits.
//!
//! The two chambers are solved by both paths here. The reference's full actuators take minutes and are stored whole in
//! `actuators/`, written by `crates/reference/examples/actuator_snapshot.rs`.

use insta::Settings;
use insta::Snapshot;
use insta::comparator::Comparator;
use pneuflex_assembly::FollowerPressure;
use pneuflex_mesh::Actuator;
use pneuflex_model::{Case, ContactMethod, Formulation, Invariant, Problem};
use pneuflex_newton::ConvergedState;
use pneuflex_reference::{ReferenceSolver, ReferenceState};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::fixtures::{
    actuator_problem, coarse_chambers, difference, energies, follow, follow_reference, resultant, strict, touching,
};

/// Digits kept in snapshots, and the size below which a number (mm, N, mJ) counts as zero.
const DIGITS: i32 = 6;
const ZERO: f64 = 1e-6;

/// Compares JSON texts number by number; all else must be equal.
#[derive(Clone)]
struct Numerically;

impl Comparator for Numerically {
    fn matches(&self, reference: &Snapshot, test: &Snapshot) -> bool {
        let parsed = |snapshot: &Snapshot| {
            snapshot.as_text().and_then(|text| serde_json::from_str::<Value>(&text.to_string()).ok())
        };
        match (parsed(reference), parsed(test)) {
            (Some(reference), Some(test)) => is_close(&reference, &test),
            _ => false,
        }
    }

    fn dyn_clone(&self) -> Box<dyn Comparator> {
        Box::new(self.clone())
    }
}

/// Numbers may differ by one in the last digit kept: rounding can go either way.
fn is_close(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (Some(a), Some(b)) = (a.as_f64(), b.as_f64()) else { return false };
            let unit = |x: f64| 10.0_f64.powi(x.abs().log10().floor() as i32 + 1 - DIGITS);
            a == b || (a - b).abs() <= 1.01 * unit(a.abs().max(b.abs()))
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_close(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| is_close(a, b)))
        }
        _ => a == b,
    }
}

fn rounded(x: f64) -> Value {
    if x.abs() < ZERO {
        return json!(0.0);
    }
    let text = format!("{x:.*e}", DIGITS as usize - 1);
    json!(text.parse::<f64>().unwrap())
}

/// One state, as both paths describe it.
struct State<'a> {
    pressure_kpa: f64,
    displacement: &'a [[f64; 3]],
    reaction: &'a [[f64; 3]],
    contact_points: usize,
    /// Of the solid and of the contact's penalty, mJ.
    energies: [f64; 2],
    cavity_volume: f64,
}

impl State<'_> {
    fn to_json(&self, problem: &Problem) -> Value {
        let list = |values: [f64; 3]| values.map(rounded).to_vec();
        let length = problem.mesh.nodes.iter().fold(0.0_f64, |length, x| length.max(x[0]));
        let (tip, _) = problem.mesh.nearest_node([length, 0.0, 0.0]).unwrap();
        let clamp = &problem.supports[0].nodes;
        let clamp_reaction = std::array::from_fn(|k| clamp.iter().map(|&node| self.reaction[node as usize][k]).sum());
        json!({
            "pressure_kpa": self.pressure_kpa,
            "tip_displacement": list(self.displacement[tip]),
            "clamp_reaction": list(clamp_reaction),
            "total_reaction": list(resultant(self.reaction)),
            "contact_points": self.contact_points,
            "energy": { "solid": rounded(self.energies[0]), "contact": rounded(self.energies[1]) },
            "cavity_volume": rounded(self.cavity_volume),
        })
    }
}

fn production_json(problem: &Problem, states: &[ConvergedState]) -> Value {
    let pressure = FollowerPressure::new(problem.mesh.clone(), &problem.cavity_facets());
    let described = states.iter().map(|state| {
        let u = &state.displacement;
        State {
            pressure_kpa: state.parameter.0,
            displacement: &state.displacement,
            reaction: &state.reaction,
            contact_points: state.contact_points,
            energies: energies(problem, u),
            cavity_volume: pressure.volume(u),
        }
        .to_json(problem)
    });
    described.collect()
}

fn reference_json(problem: &Problem, solver: &ReferenceSolver, states: &[ReferenceState]) -> Value {
    let described = states.iter().map(|state| {
        let u = &state.displacement;
        State {
            pressure_kpa: state.parameter.0,
            displacement: u.as_chunks().0,
            reaction: state.reaction().as_chunks().0,
            contact_points: touching(solver, state),
            energies: [solver.solid().energy(u), solver.contact().energy(u)],
            cavity_volume: solver.cavities()[0].volume(u).unwrap(),
        }
        .to_json(problem)
    });
    described.collect()
}

#[track_caller]
fn assert_snapshot(name: &str, value: &Value) {
    let mut settings = Settings::clone_current();
    settings.set_comparator(Box::new(Numerically));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_json_snapshot!(name, value));
}

#[test]
fn numbers_are_compared_as_numbers() {
    let close = |a: f64, b: f64| is_close(&json!({ "a": [a, "x"] }), &json!({ "a": [b, "x"] }));
    assert!(close(1.23456, 1.23457) && close(-20.0001, -20.0) && close(0.0, 0.0) && close(9.99999e-3, 1e-2));
    assert!(!close(1.23456, 1.23458) && !close(1.0, -1.0) && !close(0.0, 1e-6) && !close(100.0, 100.002));
    assert!(!is_close(&json!([1.0]), &json!([1.0, 2.0])) && !is_close(&json!({ "a": 1 }), &json!({ "b": 1 })));
    assert_eq!([rounded(-1.234_564_9), rounded(3e-7)], [json!(-1.23456), json!(0.0)]);
}

#[test]
fn two_chambers_both_ways() {
    let problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
    let pressures = [5.0, 15.0, 25.0, 35.0, 50.0];
    assert_snapshot("two_chambers_coarse", &production_json(&problem, &follow(&problem, &pressures, &strict())));
    let (solver, states) = follow_reference(&problem, &pressures);
    assert_snapshot("two_chambers_coarse", &reference_json(&problem, &solver, &states));
}

/// The default case: 1 mm elements, 2 mm gap.
#[test]
fn two_chambers_of_the_default_case() {
    let problem = actuator_problem(
        &Actuator::two_chambers(),
        [1.0; 3],
        Formulation::Hex8Q1p0,
        Invariant::Isochoric,
        ContactMethod::MultiPoint,
    );
    let states = follow(&problem, &[5.0, 15.0, 25.0, 35.0, 50.0], &strict());
    assert_snapshot("two_chambers", &production_json(&problem, &states));
}

/// What the reference's example has written.
#[derive(Deserialize)]
struct StoredRun {
    case: Case,
    states: Vec<StoredState>,
}

#[derive(Deserialize)]
struct StoredState {
    pressure_kpa: f64,
    contact_points: usize,
    energy: StoredEnergy,
    cavity_volume: f64,
    displacement: Vec<f64>,
    /// At held degrees of freedom only, in ascending order.
    held_reaction: Vec<f64>,
}

#[derive(Deserialize)]
struct StoredEnergy {
    solid: f64,
    contact: f64,
}

/// Production against the stored reference run: displacements to 1e-8, reactions to 1e-6.
fn check_stored(name: &str, text: &str, touches: bool) {
    let run: StoredRun = serde_json::from_str(text).unwrap();
    let problem = Problem::from_case(&run.case).unwrap();
    assert!((3000..4000).contains(&problem.num_unknowns()));
    let held = problem.held_dofs();
    let found = follow(&problem, &run.case.load.pressure_kpa, &strict());
    let pressure = FollowerPressure::new(problem.mesh.clone(), &problem.cavity_facets());
    assert_eq!(found.len(), run.states.len());
    for (found, stored) in found.iter().zip(&run.states) {
        let kpa = stored.pressure_kpa;
        assert_eq!((found.parameter.0, found.contact_points), (kpa, stored.contact_points));
        let u = difference(found.displacement.as_flattened(), &stored.displacement);
        let at_held: Vec<f64> =
            found.reaction.as_flattened().iter().zip(&held).filter(|(_, held)| **held).map(|(r, _)| *r).collect();
        let reaction = difference(&at_held, &stored.held_reaction);
        println!("{name}, {kpa} kPa: displacement {u:.1e}, reaction {reaction:.1e}");
        assert!(u < 1e-8 && reaction < 1e-6, "{name}, {kpa} kPa: {u:.1e}, {reaction:.1e}");
        let u = &found.displacement;
        let energies = energies(&problem, u);
        let of_energies = difference(&energies, &[stored.energy.solid, stored.energy.contact]);
        let volume = pressure.volume(u) / stored.cavity_volume - 1.0;
        assert!(of_energies < 1e-8 && volume.abs() < 1e-8, "{name}, {kpa} kPa: {of_energies:.1e}, {volume:.1e}");
    }
    assert_eq!(found.last().unwrap().contact_points > 0, touches);
    assert_snapshot(&format!("actuator_{name}"), &production_json(&problem, &found));
}

#[test]
fn actuator_in_contact_is_the_stored_reference() {
    check_stored("contact", include_str!("actuators/contact.json"), true);
}

/// On so coarse a mesh the default gap of 2 mm does not close.
#[test]
fn actuator_as_in_the_paper_is_the_stored_reference() {
    check_stored("paper", include_str!("actuators/paper.json"), false);
}
