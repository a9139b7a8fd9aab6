//! Problems in other units: what must not depend on how a problem is put.

use pneuflex_model::load::{Control, Gas, Load};
use pneuflex_model::{Clock, ContactMethod, Curve, Formulation, Invariant, Law, Solver};
use pneuflex_newton::{Event, follow_path};

use crate::fixtures::{coarse_chambers, difference};

/// Two chambers that touch, pumped up with gas under their own weight.
#[test]
fn gas_weight_and_touching_walls_do_not_depend_on_units() {
    let in_units = |length: f64, modulus: f64| {
        let mut problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
        problem.mesh = problem.mesh.as_ref().clone().map_nodes(|x| x.map(|x| length * x)).into();
        let Law::Yeoh { c10, c20, c30 } = problem.material.law else { panic!("the default law is Yeoh's") };
        problem.material.law = Law::Yeoh { c10: modulus * c10, c20: modulus * c20, c30: modulus * c30 };
        problem.material.bulk_modulus *= modulus;
        problem.material.density = 1e-9;
        problem.contact.stiffness *= modulus / length;
        let amount = Curve::Table(vec![[0.0, 1.0], [1.0, 1.5]]);
        problem.cavities[0].control = Control::Gas(Gas { atmosphere: 0.1 * modulus, exponent: 1.0, amount });
        let acceleration = [0.0, 0.0, -9.81e4 * modulus / length];
        problem.loads = vec![Load::Gravity { elements: None, acceleration, curve: Curve::Proportional(1.0) }];
        problem.clock = Clock::Steps;
        let settings = Solver { first_step: 0.25, max_step: 0.25, min_step: 1e-4, ..Solver::default() };
        let mut last = None;
        let report = follow_path(&problem, &[1.0], &settings, &mut |event| {
            if let Event::Converged(state) = event {
                last = Some(state.clone());
            }
        });
        let (state, report) = (last.unwrap(), report.unwrap_or_else(|ended| panic!("{}", ended.0)));
        assert!(state.contact_points > 0);
        let u: Vec<f64> = state.displacement.as_flattened().iter().map(|u| u / length).collect();
        (u, report.iterations)
    };
    let (expected, iterations) = in_units(1.0, 1.0);
    for (length, modulus) in [(1e-3, 1.0), (1e3, 1e-3)] {
        let (found, other) = in_units(length, modulus);
        let u = difference(&found, &expected);
        assert!(u < 1e-9 && other == iterations, "length {length}, modulus {modulus}: {u:.1e}, {other} iterations");
    }
}
