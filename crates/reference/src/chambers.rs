//! Two coarse chambers: equilibrium of the whole with contact, multipliers, convergence.

use pneuflex_mesh::{Actuator, MeshSize};
use pneuflex_model::{Contact, ContactMethod, Formulation, LoadParameter, Material, Problem};

use crate::testing::{check_derivatives, displacement, noise, two_chambers};
use crate::{PathOptions, ReferenceSolver, ReferenceState};

#[track_caller]
fn check_equilibrium(solver: &ReferenceSolver, state: &ReferenceState) {
    // The primal residual, not the mixed one that was solved.
    let residual = solver.gradient(&state.displacement, state.parameter);
    for (dof, (r, lambda)) in residual.iter().zip(&state.multiplier).enumerate() {
        assert!((r + lambda).abs() < 1e-8, "R + Φᵀλ = {:.1e} at {dof}", r + lambda);
    }
    // The last corrections fall quadratically.
    let tail = &state.corrections[state.corrections.len() - 3..];
    assert!(tail[1] < 1e-2 * tail[0].max(1e-7), "{:?}", state.corrections);
    // A closed cavity has no resultant. Across the symmetry plane the half model carries force.
    let [x, y, z] = state.reaction_resultant();
    assert!(x.abs() < 1e-8 && z.abs() < 1e-8 && y.abs() > 0.1, "{x:.1e} {y:.1e} {z:.1e}");
}

/// A narrow gap, so that the upper edges touch at 35 kPa.
#[test]
fn two_chambers_in_contact() {
    let problem = two_chambers([4.0, 5.0, 4.5], 0.5, Formulation::Hex8Q1p0, ContactMethod::MultiPoint);
    assert_eq!(problem.num_unknowns(), 858);
    let solver = ReferenceSolver::new(&problem).unwrap();
    let states = solver.follow_path(&[5.0, 35.0], &PathOptions::default()).unwrap();
    let gaps = |state: &ReferenceState| solver.contact().points(&state.displacement).into_iter().map(|point| point.gap);
    let touching = states.iter().map(|state| gaps(state).filter(|&gap| gap < 0.0).count());
    assert_eq!(touching.collect::<Vec<_>>(), [0, 6]);
    let deepest = gaps(&states[1]).fold(f64::INFINITY, f64::min);
    assert!((-0.1..-0.01).contains(&deepest), "{deepest}");
    for state in &states {
        check_equilibrium(&solver, state);
    }
}

/// Quadratic elements are too many unknowns for two chambers: one, as coarse as the geometry allows.
#[test]
fn one_chamber_of_quadratic_elements() {
    let mut actuator = Actuator { chambers: 1, ..Actuator::two_chambers() };
    actuator.channel.half_width = 0.0;
    for formulation in [Formulation::Hex20, Formulation::Hex27, Formulation::Tet10] {
        let size = MeshSize::per_axis([8.0, 9.0, 8.0]);
        let problem =
            Problem::from_actuator(&actuator, &size, formulation, Material::default(), Contact::default()).unwrap();
        let solver = ReferenceSolver::new(&problem).unwrap();
        println!(
            "{} unknowns, {} held, {} pressures",
            problem.num_unknowns(),
            solver.held().len(),
            solver.solid().num_pressures()
        );
        let states = solver.follow_path(&[10.0, 20.0], &PathOptions::default()).unwrap();
        for state in &states {
            check_equilibrium(&solver, state);
        }
    }
}

#[test]
fn derivatives_of_the_whole_potential_in_contact() {
    for formulation in [Formulation::Hex8Sri, Formulation::Hex20] {
        let problem = two_chambers([8.0, 9.0, 8.0], 0.5, formulation, ContactMethod::MultiPoint);
        let solver = ReferenceSolver::new(&problem).unwrap();
        // The upper part of the left chamber leans into the right one.
        let leaning = displacement(&problem.mesh, |[x, y, z]| [if x < 8.1 { x + 0.005 * z * z } else { x }, y, z]);
        let u: Vec<f64> = leaning.iter().zip(noise(leaning.len(), 0.02)).map(|(a, b)| a + b).collect();
        assert!(solver.contact().points(&u).iter().filter(|p| p.gap < -0.02).count() > 10);
        let t = LoadParameter(35.0);
        check_derivatives(|u| solver.energy(u, t), |u| solver.gradient(u, t), |u| solver.hessian(u, t), &u);
    }
}
