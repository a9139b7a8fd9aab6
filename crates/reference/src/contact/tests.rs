//! Tests of contact against differences, balances and closed forms.

use pneuflex_model::Formulation;

use super::*;
use crate::testing::{check_derivatives, displacement, noise, two_blocks};

const METHODS: [ContactMethod; 2] = [ContactMethod::SinglePoint, ContactMethod::MultiPoint];

/// Pushes the slave block 0.3 mm into the tilted master.
fn pushed(problem: &Problem) -> Vec<f64> {
    let pushed = displacement(&problem.mesh, |[x, y, z]| {
        if x < 1.05 { [x + 0.3 + 0.02 * y, y, z + 0.1 * x] } else { [x + 0.05 * z - 0.03 * y, y + 0.02 * z, z] }
    });
    // With 0.03 one of tet10's points changes its facet within the differences of the derivatives' check.
    pushed.iter().zip(noise(pushed.len(), 0.025)).map(|(a, b)| a + b).collect()
}

#[test]
fn derivatives_in_an_active_state() {
    for formulation in Formulation::ALL {
        for method in METHODS {
            let problem = two_blocks(formulation, method, true);
            let (model, u) = (ContactModel::new(&problem).unwrap(), pushed(&problem));
            let points = model.points(&u);
            let active = points.iter().filter(|p| p.gap < -0.05).count();
            assert!(active >= 4 && (method == ContactMethod::SinglePoint || active >= 40), "{active} active");
            check_derivatives(|u| model.energy(u), |u| model.gradient(u), |u| model.hessian(u), &u);
        }
    }
}

#[test]
fn forces_of_both_sides_balance_in_force_and_moment() {
    for method in METHODS {
        let problem = two_blocks(Formulation::Hex20, method, true);
        let (model, u) = (ContactModel::new(&problem).unwrap(), pushed(&problem));
        let force = model.gradient(&u);
        let mut moment = [0.0; 3];
        for (n, x) in problem.mesh.nodes.iter().enumerate() {
            let r = std::array::from_fn(|i| x[i] + u[3 * n + i]);
            let m = cross(r, vector(force.as_slice(), n));
            (0..3).for_each(|i| moment[i] += m[i]);
        }
        assert!(force.norm() > 0.1);
        for axis in 0..3 {
            assert!(force.iter().skip(axis).step_by(3).sum::<f64>().abs() < 1e-12);
            assert!(moment[axis].abs() < 1e-11, "{moment:?}");
        }
    }
}

/// A rigid plane pressed in by δ: energy ½ k δ² A, whichever way the facets are cut.
#[test]
fn flat_walls_pressed_into_each_other_store_half_k_delta_squared_per_area() {
    for formulation in Formulation::ALL {
        for method in METHODS {
            let problem = two_blocks(formulation, method, true);
            let model = ContactModel::new(&problem).unwrap();
            let push = |by: f64| displacement(&problem.mesh, |[x, y, z]| [if x < 1.05 { x + by } else { x }, y, z]);
            assert_eq!(model.energy(&push(0.09)), 0.0);
            let (u, exact) = (push(0.35), 0.5 * 4.0 * 0.25_f64.powi(2) * 4.0);
            assert!((model.energy(&u) - exact).abs() < 1e-12, "{}", model.energy(&u));
            assert!(model.points(&u).iter().all(|p| (p.gap + 0.25).abs() < 1e-12));
            let facets = problem.contact_pairs[0].slave.len();
            let expected = if method == ContactMethod::MultiPoint { 16 * facets } else { facets };
            assert_eq!(model.points(&u).len(), expected);
        }
    }
}

#[test]
fn a_point_beside_the_master_is_accepted_within_the_margin_only() {
    let problem = two_blocks(Formulation::Hex8Sri, ContactMethod::MultiPoint, true);
    let model = ContactModel::new(&problem).unwrap();
    // The outermost of the slave's points lie at y = 1.93; the master ends at 2.4, its margin of 5 % of 1.6 mm at 2.48.
    let found = |by: f64| {
        let u = displacement(&problem.mesh, |[x, y, z]| [x, if x < 1.05 { y + by } else { y }, z]);
        let points = model.points(&u);
        (points.len(), points.iter().filter(|p| p.xi[0].abs().max(p.xi[1].abs()) > 1.0).count())
    };
    assert_eq!([0.0, 0.46, 0.5, 0.56].map(found), [(64, 0), (64, 0), (64, 8), (56, 0)]);
}

#[test]
fn unequal_lists_are_an_error_in_single_point_contact() {
    let mut problem = two_blocks(Formulation::Hex8Sri, ContactMethod::SinglePoint, true);
    problem.contact_pairs[0].master.pop();
    assert!(matches!(ContactModel::new(&problem), Err(ReferenceError::UnpairedFacets { slave: 4, master: 3, .. })));
    problem.contact.method = ContactMethod::MultiPoint;
    assert!(ContactModel::new(&problem).is_ok());
}

/// The error of a problem whose contact is not modelled.
fn refused(change: impl Fn(&mut Problem)) -> (Unmodelled, String) {
    let mut problem = two_blocks(Formulation::Hex8Sri, ContactMethod::MultiPoint, true);
    change(&mut problem);
    match ContactModel::new(&problem) {
        Err(ReferenceError::NotModelled { part, name }) => (part, name),
        other => panic!("{other:?}"),
    }
}

#[test]
fn self_contact_is_refused() {
    let expected = (Unmodelled::SelfContact, "gap".to_owned());
    assert_eq!(refused(|problem| problem.contact_pairs[0].master = problem.contact_pairs[0].slave.clone()), expected);
    // Neighbouring faces of one body.
    assert_eq!(
        refused(|problem| {
            problem.contact_pairs[0].slave = problem.mesh.select_facets(|x| x[2] == 2.0 && x[0] <= 1.0);
            problem.contact_pairs[0].master = problem.mesh.select_facets(|x| x[0] == 1.0);
        }),
        expected
    );
    let mut switched_off = two_blocks(Formulation::Hex8Sri, ContactMethod::None, true);
    switched_off.contact_pairs[0].master = switched_off.contact_pairs[0].slave.clone();
    assert!(ContactModel::new(&switched_off).is_ok());
}

#[test]
fn averaged_gaps_are_refused() {
    let expected = (Unmodelled::Mortar, "gap".to_owned());
    assert_eq!(refused(|problem| problem.contact.method = ContactMethod::Mortar), expected);
    assert_eq!(refused(|problem| problem.contact_pairs[0].method = Some(ContactMethod::Mortar)), expected);
}

#[test]
fn contact_without_penetration_is_refused() {
    let expected = (Unmodelled::PenetrationTolerance, "contact.penetration_tolerance".to_owned());
    assert_eq!(refused(|problem| problem.contact.penetration_tolerance = Some(1e-3)), expected);
    let expected = (Unmodelled::PenetrationTolerance, "gap".to_owned());
    assert_eq!(refused(|problem| problem.contact_pairs[0].penetration_tolerance = Some(1e-3)), expected);
}
