//! Equilibria of coarse full actuators by the reference solver, as the production path's tests read them.
//!
//! Takes minutes, so the result is part of the repository:
//!
//! ```text
//! cargo run --release -p pneuflex-reference --example actuator_snapshot contact > contact.json
//! ```
//!
//! in `crates/newton/tests/verification/actuators/`, and the same for `paper`.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::error::Error;

use pneuflex_mesh::Actuator;
use pneuflex_model::{
    Case, Contact, ContactMethod, Formulation, Invariant, Load, Material, MeshOptions, Output, Problem, Size, Solver,
};
use pneuflex_reference::{PathOptions, ReferenceSolver, ReferenceState};
use serde_json::{Value, json};

/// The cases by name.
fn case(name: &str) -> Option<Case> {
    let (title, gap, element, invariant, pressure_kpa) = match name {
        "contact" => {
            let title = "Coarse full actuator with a narrow gap, in contact from 15 kPa";
            (title, 0.6, Formulation::Hex8Q1p0, Invariant::Isochoric, vec![5.0, 15.0, 35.0])
        }
        "paper" => {
            let title = "Coarse full actuator of the default geometry, the paper's element and invariant";
            (title, 2.0, Formulation::Hex8Sri, Invariant::Full, vec![5.0, 25.0])
        }
        _ => return None,
    };
    Some(Case {
        title: title.into(),
        actuator: Actuator { gap: gap.into(), ..Actuator::full() },
        mesh: MeshOptions {
            size: Some(Size::PerAxis([6.0, 5.0, 4.5])),
            element: Some(element),
            ..MeshOptions::default()
        },
        material: Material { invariant, ..Material::default() },
        contact: Contact { method: ContactMethod::MultiPoint, ..Contact::default() },
        load: Load { pressure_kpa, chamber_factor: None },
        obstacles: Vec::new(),
        probes: Vec::new(),
        solver: Solver::default(),
        output: Output::default(),
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_default();
    let case = case(&name).ok_or("say which case: contact or paper")?;
    let problem = Problem::from_case(&case)?;
    let solver = ReferenceSolver::new(&problem)?;
    let options = PathOptions { max_step: 5.0, ..PathOptions::default() };
    let start = std::time::Instant::now();
    let states = solver.follow_path(&case.load.pressure_kpa, &options)?;
    let states: Vec<Value> = states.iter().map(|state| described(&solver, state)).collect();
    eprintln!("{} unknowns, {:.0} s", problem.num_unknowns(), start.elapsed().as_secs_f64());
    println!("{}", json!({ "case": case, "states": states }));
    Ok(())
}

/// Displacements of all nodes, forces of the supports on held degrees of freedom, and what goes with them.
fn described(solver: &ReferenceSolver, state: &ReferenceState) -> Value {
    let u = &state.displacement;
    let reaction = state.reaction();
    json!({
        "pressure_kpa": state.parameter,
        "iterations": state.iterations(),
        "contact_points": solver.contact().points(u).iter().filter(|point| point.gap < 0.0).count(),
        "energy": { "solid": solver.solid().energy(u), "contact": solver.contact().energy(u) },
        "cavity_volume": solver.cavities()[0].volume(u),
        "displacement": u.iter().map(|&x| rounded(x)).collect::<Vec<_>>(),
        "held_reaction": solver.held().iter().map(|&dof| rounded(reaction[dof])).collect::<Vec<_>>(),
    })
}

/// Nine decimals, mm or N: the cross-check asks for 1e-8 of displacements of 30 mm.
fn rounded(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}
