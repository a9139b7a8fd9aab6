//! Problems, paths and comparisons that the tests share.

use nalgebra::DMatrix;
use pneuflex_factor::{BlockPattern, Parallelism};
use pneuflex_mesh::{Actuator, Mesh, MeshSize};
use pneuflex_model::{Contact, ContactMethod, Formulation, Invariant, Material, Problem, Solver};
use pneuflex_newton::{ConvergedState, Event, State, System, follow_path};
use pneuflex_reference::{PathOptions, ReferenceSolver, ReferenceState};

pub const INVARIANTS: [Invariant; 2] = [Invariant::Full, Invariant::Isochoric];
pub const METHODS: [ContactMethod; 3] = [ContactMethod::None, ContactMethod::SinglePoint, ContactMethod::MultiPoint];

/// A body without loads, supports and contact.
pub fn body(mesh: Mesh, formulation: Formulation, material: Material) -> Problem {
    Problem::body(mesh, formulation, material)
}

/// An actuator with the paper's material.
pub fn actuator_problem(
    actuator: &Actuator,
    size: [f64; 3],
    formulation: Formulation,
    invariant: Invariant,
    method: ContactMethod,
) -> Problem {
    let material = Material { invariant, ..Material::default() };
    let contact = Contact { method, ..Contact::default() };
    Problem::from_actuator(actuator, &MeshSize::per_axis(size), formulation, material, contact).unwrap()
}

/// Two coarse chambers, 858 unknowns, whose gap is so narrow that their upper edges touch between 5 and 20 kPa.
pub fn coarse_chambers(formulation: Formulation, invariant: Invariant, method: ContactMethod) -> Problem {
    let actuator = Actuator { gap: 0.3.into(), ..Actuator::two_chambers() };
    actuator_problem(&actuator, [4.0, 5.0, 4.5], formulation, invariant, method)
}

/// Displacements X ↦ r(X) − X.
pub fn displacement(mesh: &Mesh, deformed: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    mesh.nodes
        .iter()
        .map(|&x| {
            let r = deformed(x);
            std::array::from_fn(|k| r[k] - x[k])
        })
        .collect()
}

/// Displacements between ± `amplitude` that look random and are always the same.
pub fn noise(nodes: usize, amplitude: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut state = seed;
    let mut next = || {
        // Knuth's linear congruential generator; the upper bits are good enough.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        amplitude * (2.0 * (state >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
    };
    (0..nodes).map(|_| std::array::from_fn(|_| next())).collect()
}

/// a + b.
pub fn sum(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter().zip(b).map(|(a, b)| std::array::from_fn(|k| a[k] + b[k])).collect()
}

/// Energies of the solid and of the contact's penalty at a displacement without loads, mJ.
pub fn energies(problem: &Problem, displacement: &[[f64; 3]]) -> [f64; 2] {
    let mut system = System::new(problem, Parallelism::Threads).unwrap();
    let state = State { displacement: displacement.to_vec(), ..State::at_rest(0, system.num_bordered()) };
    let all = system.energies(&state).unwrap();
    ["solid", "contact"].map(|name| all.iter().filter(|(of, _)| *of == name).map(|(_, energy)| energy).sum())
}

/// Sum over all nodes.
pub fn resultant(field: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|axis| field.iter().map(|value| value[axis]).sum())
}

/// Largest difference relative to the largest entry of `expected`.
#[track_caller]
pub fn difference<'a>(
    found: impl IntoIterator<Item = &'a f64>,
    expected: impl IntoIterator<Item = &'a f64> + Clone,
) -> f64 {
    let largest = expected.clone().into_iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(largest > 0.0, "nothing to compare with");
    let (mut found, mut expected) = (found.into_iter(), expected.into_iter());
    let mut difference = 0.0_f64;
    loop {
        match (found.next(), expected.next()) {
            // `max` would lose a NaN.
            (Some(a), Some(b)) => {
                assert!(a.is_finite() && b.is_finite());
                difference = difference.max((a - b).abs());
            }
            (None, None) => return difference / largest,
            _ => panic!("lists of different lengths"),
        }
    }
}

/// The whole of a matrix of which a lower triangle of 3 × 3 blocks is stored.
pub fn dense(pattern: &BlockPattern, values: &[f64]) -> DMatrix<f64> {
    let n = 3 * pattern.num_nodes();
    let mut matrix = DMatrix::zeros(n, n);
    let mut blocks = values.chunks_exact(9);
    for column in 0..pattern.num_nodes() {
        for &row in pattern.column(column) {
            let block = blocks.next().unwrap();
            for j in 0..3 {
                for i in 0..3 {
                    let (i_all, j_all) = (3 * row as usize + i, 3 * column + j);
                    matrix[(i_all, j_all)] = block[3 * j + i];
                    matrix[(j_all, i_all)] = block[3 * j + i];
                }
            }
        }
    }
    matrix
}

/// Solver settings under which only rounding errors are left.
pub fn strict() -> Solver {
    Solver { tolerance: 1e-9, ..Solver::default() }
}

/// The reached states of the production path.
#[track_caller]
pub fn follow(problem: &Problem, pressures_kpa: &[f64], settings: &Solver) -> Vec<ConvergedState> {
    let mut reached = Vec::new();
    let result = follow_path(problem, pressures_kpa, settings, &mut |event| {
        if let Event::Converged(state) = event {
            reached.push(state.clone());
        }
    });
    if let Err(ended) = result {
        panic!("{}", ended.0);
    }
    assert_eq!(reached.len(), pressures_kpa.len());
    reached
}

/// The reference solver of a problem, and its states.
#[track_caller]
pub fn follow_reference(problem: &Problem, pressures_kpa: &[f64]) -> (ReferenceSolver, Vec<ReferenceState>) {
    let solver = ReferenceSolver::new(problem).unwrap();
    let options = PathOptions { max_step: 20.0, ..PathOptions::default() };
    let states = solver.follow_path(pressures_kpa, &options).unwrap();
    (solver, states)
}

/// Requires displacements and the cavities' pressures to 1e-8 and reactions to 1e-6 relative.
#[track_caller]
pub fn assert_same_states(name: &str, found: &[ConvergedState], expected: &[ReferenceState]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.parameter, expected.parameter);
        let pressures: Vec<f64> = found.cavity_pressures.iter().map(|pressure| pressure.mpa()).collect();
        assert_eq!(pressures.len(), expected.cavity_pressure.len());
        if !pressures.is_empty() {
            let pressure = difference(&pressures, &expected.cavity_pressure);
            assert!(pressure < 1e-8, "{name}, {}: pressure {pressure:.1e}", found.parameter);
        }
        let u = difference(found.displacement.as_flattened(), &expected.displacement);
        let reaction = difference(found.reaction.as_flattened(), &expected.reaction());
        println!("{name}, {}: displacement {u:.1e}, reaction {reaction:.1e}", found.parameter);
        assert!(u < 1e-8 && reaction < 1e-6, "{name}, {}: {u:.1e}, {reaction:.1e}", found.parameter);
    }
}

/// Points that touch in a reference state.
pub fn touching(solver: &ReferenceSolver, state: &ReferenceState) -> usize {
    solver.contact().points(&state.displacement).iter().filter(|point| point.gap < 0.0).count()
}
