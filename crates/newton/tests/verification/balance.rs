//! What must hold whatever the numbers are.

use pneuflex_assembly::FollowerPressure;
use pneuflex_factor::Parallelism;
use pneuflex_mesh::quadrature::gauss_legendre;
use pneuflex_mesh::{Actuator, Part};
use pneuflex_model::{ContactMethod, Formulation, Invariant, MPA_PER_KPA, Problem, Solver};
use pneuflex_newton::{Event, State, System, follow_path};
use rayon::ThreadPoolBuilder;

use crate::fixtures::{METHODS, actuator_problem, coarse_chambers, difference, energies, follow, resultant, strict};

const PRESSURES: [f64; 5] = [5.0, 15.0, 25.0, 35.0, 50.0];

/// A closed cavity has no resultant, and neither has contact: nothing but the clamp acts along x and z.
#[test]
fn the_clamp_carries_nothing_along_x_and_z() {
    let full = Actuator { gap: 0.6.into(), ..Actuator::full() };
    let element = Formulation::Hex8Q1p0;
    for method in METHODS {
        let chambers = coarse_chambers(element, Invariant::Isochoric, method);
        let actuator = actuator_problem(&full, [6.0, 5.0, 4.5], element, Invariant::Isochoric, method);
        for problem in [chambers, actuator] {
            let states = follow(&problem, &PRESSURES, &Solver::default());
            assert_eq!(states[4].contact_points > 0, method != ContactMethod::None);
            for state in &states {
                let [x, y, z] = resultant(&state.reaction);
                assert!(x.abs() < 1e-6 && z.abs() < 1e-6, "{method:?}, {} kPa: {x:.1e}, {z:.1e}", state.parameter);
                // The plane of symmetry carries the air's and the walls' pull.
                assert!(y.abs() > 0.1);
            }
        }
    }
}

#[test]
fn contact_variants_are_the_same_until_something_touches() {
    let states = METHODS.map(|method| {
        let problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, method);
        follow(&problem, &[5.0, 20.0], &Solver::default())
    });
    for other in &states[1..] {
        assert_eq!((states[0][0].displacement.clone(), other[0].contact_points), (other[0].displacement.clone(), 0));
        assert_eq!(states[0][0].reaction, other[0].reaction);
        assert!(
            difference(states[0][1].displacement.as_flattened(), other[1].displacement.as_flattened()) > 1e-3,
            "20 kPa"
        );
    }
    assert!(
        difference(states[1][1].displacement.as_flattened(), states[2][1].displacement.as_flattened()) > 1e-3,
        "20 kPa"
    );
}

/// Energy stored up to `pressure_kpa` = ∫ p dV = p V − ∫ V dp, the latter by Gauss rules over `panels` equal parts.
fn energy_and_work(problem: &Problem, pressure_kpa: f64, panels: usize) -> (f64, f64) {
    let width = pressure_kpa / panels as f64;
    let mut points: Vec<(f64, f64)> = (0..panels)
        .flat_map(|panel| {
            gauss_legendre(5).into_iter().map(move |(x, w)| ((panel as f64 + 0.5 * (1.0 + x)) * width, 0.5 * w * width))
        })
        .collect();
    points.push((pressure_kpa, 0.0));
    let pressures: Vec<f64> = points.iter().map(|point| point.0).collect();
    let states = follow(problem, &pressures, &strict());
    let air = FollowerPressure::new(problem.mesh.clone(), &problem.cavity_facets());
    let volumes: Vec<f64> = states.iter().map(|state| air.volume(&state.displacement)).collect();
    let integral: f64 = points.iter().zip(&volumes).map(|((_, weight), volume)| weight * volume).sum();
    let last = states.len() - 1;
    let work = MPA_PER_KPA * (pressure_kpa * volumes[last] - integral);
    let [solid, contact] = energies(problem, &states[last].displacement);
    assert_eq!(contact > 0.0, problem.contact.method != ContactMethod::None);
    (solid + contact, work)
}

#[test]
fn work_of_the_pressure_is_stored_as_energy() {
    for (method, panels, tolerance) in [(ContactMethod::None, 2, 1e-8), (ContactMethod::MultiPoint, 7, 1e-5)] {
        let problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, method);
        let (energy, work) = energy_and_work(&problem, 35.0, panels);
        println!("{method:?}: {energy} {work} {:.1e}", work / energy - 1.0);
        assert!(energy > 1.0 && (work / energy - 1.0).abs() < tolerance, "{method:?}: {energy} {work}");
    }
}

#[test]
fn the_whole_body_moves_as_its_half() {
    let half = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
    let actuator = Actuator { gap: 0.3.into(), part: Part::Whole, ..Actuator::two_chambers() };
    let whole = actuator_problem(
        &actuator,
        [4.0, 5.0, 4.5],
        Formulation::Hex8Q1p0,
        Invariant::Isochoric,
        ContactMethod::MultiPoint,
    );
    let [of_half, of_whole] = [&half, &whole].map(|problem| follow(problem, &[5.0, 20.0, 35.0], &strict()));
    for (of_half, of_whole) in of_half.iter().zip(&of_whole) {
        assert_eq!(of_whole.contact_points, 2 * of_half.contact_points);
        for side in [1.0, -1.0] {
            let (mut expected, mut found) = (Vec::new(), Vec::new());
            for (node, &[x, y, z]) in half.mesh.nodes.iter().enumerate() {
                let (image, distance) = whole.mesh.nearest_node([x, side * y, z]).unwrap();
                assert!(distance < 1e-9);
                for axis in 0..3 {
                    let sign = if axis == 1 { side } else { 1.0 };
                    expected.push(of_half.displacement[node][axis]);
                    found.push(sign * of_whole.displacement[image][axis]);
                }
            }
            let error = difference(&found, &expected);
            assert!(error < 1e-8, "{} kPa: {error:.1e}", of_half.parameter);
        }
    }
    assert!(of_half[2].contact_points > 0);
}

/// The default case at 1 mm: the assembled system to the last bit, the path to 1e-10.
#[test]
fn one_thread_and_two_agree() {
    let problem = actuator_problem(
        &Actuator::two_chambers(),
        [1.0; 3],
        Formulation::Hex8Q1p0,
        Invariant::Isochoric,
        ContactMethod::MultiPoint,
    );
    let runs = [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let states = follow(&problem, &[15.0, 35.0], &Solver::default());
            // Some displacements in contact, the same in both runs.
            let u: Vec<[f64; 3]> = states[1]
                .displacement
                .iter()
                .map(|u| u.map(|x| (x * f64::from(1 << 20)).round() / f64::from(1 << 20)))
                .collect();
            let mut system = System::new(&problem, Parallelism::Threads).unwrap();
            system.predict(&u, None);
            let (assembled, tangent) = system.tangent(&State::new(35.0, u, Vec::new())).unwrap();
            assert!(assembled.contact_points > 0);
            (states, (assembled.residual, tangent.values().to_vec()))
        })
    });
    let [(one, system_of_one), (two, system_of_two)] = runs;
    assert!(system_of_one == system_of_two);
    for (one, two) in one.iter().zip(&two) {
        let (u, reaction) = (
            difference(two.displacement.as_flattened(), one.displacement.as_flattened()),
            difference(two.reaction.as_flattened(), one.reaction.as_flattened()),
        );
        println!("{} kPa: {u:.1e}, {reaction:.1e}", one.parameter);
        assert!(u < 1e-10 && reaction < 1e-10, "{} kPa: {u:.1e}, {reaction:.1e}", one.parameter);
    }
}

/// Far beyond what the material bears: the run ends with a failure that says where, and what it had reached stays.
#[test]
fn a_path_without_an_end_fails_and_keeps_what_it_reached() {
    let problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::MultiPoint);
    let settings = Solver { max_step: 100.0, min_step: 10.0, ..Solver::default() };
    let mut reached = Vec::new();
    let mut rejected = 0;
    let result = follow_path(&problem, &[5.0, 35.0, 5000.0], &settings, &mut |event| match event {
        Event::Converged(state) => reached.push(state.clone()),
        Event::StepRejected { .. } => rejected += 1,
        _ => (),
    });
    let (failure, report) = *result.unwrap_err();
    println!("{failure} {rejected} {report:?}");
    assert_eq!(reached.iter().map(|state| state.parameter.0).collect::<Vec<_>>(), [5.0, 35.0]);
    assert!(rejected > 0 && report.iterations > 0);
    assert!(failure.reached.0 >= 35.0 && failure.attempted > failure.reached, "{failure}");
    let expected = follow(&problem, &[5.0, 35.0], &settings);
    assert_eq!(reached, expected);
}

/// Rounding keeps the residual of a nearly rigid bulk above the tolerance asked for: a failure, not an endless iteration.
#[test]
fn a_residual_out_of_reach_is_a_failure() {
    let mut problem = coarse_chambers(Formulation::Hex8Q1p0, Invariant::Isochoric, ContactMethod::None);
    problem.material.bulk_modulus = 1e8;
    let settings = Solver { residual_tolerance: 1e-30, min_step: 1.0, ..Solver::default() };
    let mut iterations = 0;
    let result = follow_path(&problem, &[5.0], &settings, &mut |event| {
        if let Event::Iteration(_) = event {
            iterations += 1;
            assert!(iterations < 2000, "the iteration has no end");
        }
    });
    let (failure, _) = *result.unwrap_err();
    assert!(failure.reached.0 < 5.0 && iterations > 25, "{failure}, {iterations} iterations");
}
