//! The number of threads changes nothing, and the fast backend agrees with the oracle where fronts are large.

use std::sync::Arc;

use pneuflex_factor::faer_backend::{FaerFactor, FaerSymbolic};
use pneuflex_factor::testing::{BlockMatrix, Cell, Random, hollow_lattice, solid_lattice};
use pneuflex_factor::{Factor, FactorError, Inertia, Method, Ordering, Parallelism, Symbolic};

const NRHS: usize = 2;

/// One compact block, whose top fronts are larger than a tile, and one long body with many subtrees.
fn matrices() -> [BlockMatrix; 2] {
    [solid_lattice::<3>([11, 11, 12], Cell::Hex8), hollow_lattice::<3>([58, 6, 7], 1, Cell::Hex8)]
}

/// Makes every fiftieth diagonal entry negative.
fn spoil(matrix: &mut BlockMatrix) {
    for node in (0..matrix.pattern.num_nodes()).step_by(50) {
        matrix.values[matrix.pattern.column_offsets()[node] * 9] *= -1.0;
    }
}

fn right_hand_sides(matrix: &BlockMatrix) -> Vec<f64> {
    let mut random = Random::new(9);
    (0..3 * NRHS * matrix.pattern.num_nodes()).map(|_| random.symmetric()).collect()
}

fn held(matrix: &BlockMatrix) -> Vec<bool> {
    (0..3 * matrix.pattern.num_nodes()).map(|dof| dof < 60).collect()
}

fn solve(
    symbolic: &Arc<Symbolic<3>>,
    matrix: &BlockMatrix,
    parallelism: Parallelism,
) -> Result<(Inertia, Vec<f64>), FactorError> {
    let mut factor = Factor::new(symbolic.clone());
    let inertia = factor.factorize(&matrix.values, &held(matrix), parallelism)?;
    let mut solution = right_hand_sides(matrix);
    factor.solve_in_place(&mut solution, NRHS)?;
    Ok((inertia, solution))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() -> Result<(), Box<dyn std::error::Error>> {
    for mut matrix in matrices() {
        let ordering = Ordering::Geometric(&matrix.positions);
        let symbolic = Arc::new(Symbolic::analyze(&matrix.pattern, ordering)?);
        for method in [Method::Cholesky, Method::Ldl] {
            if method == Method::Ldl {
                spoil(&mut matrix);
            }
            let serial = solve(&symbolic, &matrix, Parallelism::Serial)?;
            assert_eq!(serial.0.method, method);
            for threads in [1, 2, 3, 8] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
                let parallel = pool.install(|| solve(&symbolic, &matrix, Parallelism::Threads))?;
                assert_eq!(parallel.0, serial.0);
                assert!(parallel.1 == serial.1, "{threads} threads differ from one");
            }
        }
    }
    Ok(())
}

#[test]
fn both_backends_agree() -> Result<(), FactorError> {
    for mut matrix in matrices() {
        for spoiled in [false, true] {
            if spoiled {
                spoil(&mut matrix);
            }
            let oracle = FaerSymbolic::<3>::analyze(&matrix.pattern, Ordering::Amd)?;
            let mut oracle = FaerFactor::new(Arc::new(oracle));
            let inertia = oracle.factorize(&matrix.values, &held(&matrix), Parallelism::Serial)?;
            let mut expected = right_hand_sides(&matrix);
            oracle.solve_in_place(&mut expected, NRHS)?;

            let symbolic = Arc::new(Symbolic::analyze(&matrix.pattern, Ordering::default())?);
            let found = solve(&symbolic, &matrix, Parallelism::Serial)?;
            assert_eq!(found.0, inertia);
            assert_eq!(inertia.negative > 0, spoiled);
            let scale = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (f, e) in found.1.iter().zip(&expected) {
                assert!((f - e).abs() < 1e-9 * scale, "{f} against {e}");
            }
        }
    }
    Ok(())
}

/// The pattern's fill, counted by two unrelated codes (the oracle's on the scalar graph, without amalgamation of ours).
#[test]
fn fill_is_plausible() -> Result<(), FactorError> {
    for matrix in matrices() {
        let ordering = Ordering::NestedDissection;
        let ours = Symbolic::<3>::analyze(&matrix.pattern, ordering)?;
        let oracle = FaerSymbolic::<3>::analyze(&matrix.pattern, ordering)?;
        let ratio = ours.flops() / oracle.flops();
        assert!((0.8..1.25).contains(&ratio), "operations: {ratio} times the oracle's");
        let entries = ours.factor_nonzeros() as f64 / oracle.factor_nonzeros() as f64;
        assert!((0.7..1.25).contains(&entries), "entries: {entries} times the oracle's");
        assert!(ours.memory_bytes() > 8 * ours.factor_nonzeros());
    }
    Ok(())
}

/// A factor that moves to another pattern behaves like a fresh one.
#[test]
fn memory_is_reused_for_another_pattern() -> Result<(), FactorError> {
    let [compact, long] = matrices();
    let mut factor = Factor::new(Arc::new(Symbolic::<3>::analyze(&long.pattern, Ordering::default())?));
    factor.factorize(&long.values, &held(&long), Parallelism::Threads)?;
    for (matrix, parallelism) in [(&compact, Parallelism::Threads), (&long, Parallelism::Serial)] {
        let symbolic = Arc::new(Symbolic::analyze(&matrix.pattern, Ordering::default())?);
        factor.set_symbolic(symbolic.clone());
        let mut solution = right_hand_sides(matrix);
        assert_eq!(factor.solve_in_place(&mut solution, NRHS), Err(FactorError::NotFactorized));
        factor.factorize(&matrix.values, &held(matrix), parallelism)?;
        factor.solve_in_place(&mut solution, NRHS)?;
        assert_eq!(solution, solve(&symbolic, matrix, Parallelism::Serial)?.1);
    }
    Ok(())
}
