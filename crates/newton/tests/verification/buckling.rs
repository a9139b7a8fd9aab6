//! A strut that buckles is led along its softest motion, and comes to the elastica.

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::load::Load;
use pneuflex_model::{Clock, Continuation, Curve, Formulation, Invariant, Law, Material, Problem, Solver, Support};
use pneuflex_newton::{ConvergedState, Event, follow_path};

pub(crate) const LENGTH: f64 = 20.0;
const MODULUS: f64 = 0.6;

/// A strut of 1 mm × 1 mm, half of its width, clamped at x = 0 and pushed by Euler's load times the load parameter.
pub(crate) fn strut() -> Problem {
    let kind = Formulation::Hex20.element_kind();
    let mesh = Lattice::uniform([0.0; 3], [LENGTH, 0.5, 1.0], [10, 1, 1]).mesh_all(kind);
    let [foot, middle] = [0, 1].map(|axis| mesh.select_nodes(|x: [f64; 3]| x[axis].abs() < 1e-9));
    let facets = mesh.select_facets(|x| (x[0] - LENGTH).abs() < 1e-9);
    let mut problem = Problem::body(mesh, Formulation::Hex20, Law::NeoHooke { c10: MODULUS / 6.0 }.into());
    problem.material = Material { bulk_modulus: 200.0, invariant: Invariant::Isochoric, ..problem.material };
    let hold = |name: &str, nodes, axes| Support { name: name.into(), nodes, axes, motion: None };
    problem.supports = vec![hold("foot", foot, [true; 3]), hold("middle", middle, [false, true, false])];
    let euler = std::f64::consts::PI.powi(2) * MODULUS / 12.0 / (4.0 * LENGTH * LENGTH);
    problem.loads = vec![Load::Traction { facets, traction: [-euler, 0.0, 0.0], curve: Curve::Proportional(1.0) }];
    problem.clock = Clock::Steps;
    problem
}

/// Deflection of the elastica's tip under a multiple of Euler's load, over its length: with P/P_E = (2 K(k)/π)² it is 2 k/K(k).
pub(crate) fn elastica(load: f64) -> f64 {
    let complete = |k: f64| {
        let (mut a, mut g) = (1.0, (1.0 - k * k).sqrt());
        for _ in 0..20 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        std::f64::consts::FRAC_PI_2 / a
    };
    let wanted = std::f64::consts::FRAC_PI_2 * load.sqrt();
    let (mut low, mut high) = (0.0, 0.999_999);
    for _ in 0..60 {
        let k = 0.5 * (low + high);
        if complete(k) < wanted { low = k } else { high = k }
    }
    2.0 * low / wanted
}

#[test]
fn a_strut_comes_to_the_elastica() {
    let problem = strut();
    let (tip, _) = problem.mesh.nearest_node([LENGTH, 0.0, 0.5]).unwrap();
    for continuation in [Continuation::Load, Continuation::ArcLength] {
        let settings = Solver {
            first_step: 0.2,
            max_step: 0.5,
            min_step: 1e-5,
            imperfection: Some(0.1),
            continuation,
            ..Solver::default()
        };
        let mut states: Vec<ConvergedState> = Vec::new();
        let report = follow_path(&problem, &[0.9, 1.1, 1.3], &settings, &mut |event| match event {
            Event::Converged(state) => states.push(state.clone()),
            Event::StepRejected { cause, parameter, .. } => println!("{parameter}: {cause}"),
            _ => {}
        });
        let report = report.unwrap_or_else(|ended| panic!("{}", ended.0));
        println!("{continuation:?}: {} iterations", report.iterations);
        for state in &states {
            let found = state.displacement[tip][2].abs() / LENGTH;
            // Near Euler's load a per cent of it is much of the deflection.
            let [least, most] = [0.98, 1.005].map(|share| elastica((share * state.parameter.0).max(1.0)));
            let left: Vec<_> =
                state.bifurcations.iter().map(|left| (left.parameter.0, left.size, left.motions)).collect();
            println!(
                "{:?} {}: {found:.4} from {least:.4} to {most:.4}, {} unstable, {left:?}",
                state.kind, state.parameter, state.negative_pivots
            );
            assert!((least..=most + 1e-9).contains(&found), "{}: {found}", state.parameter);
        }
        assert_eq!(states.len(), 3);
        let [before, at, after] = [0, 1, 2].map(|i| &states[i].bifurcations);
        assert!(before.is_empty() && at.len() == 1 && after.is_empty());
        assert!((at[0].parameter.0 - 1.0).abs() < 0.1, "{}", at[0].parameter);
        let largest = at[0].mode.iter().map(|u| u.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-12 && at[0].mode[tip][2].abs() > 0.9);
    }
}
