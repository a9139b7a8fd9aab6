//! One suite for every backend: residuals, held degrees of freedom, inertia, errors.

use std::sync::Arc;

use pneuflex_factor::faer_backend::{FaerFactor, FaerSymbolic};
use pneuflex_factor::testing::{BlockMatrix, Cell, Random, hollow_lattice, positive_definite_values, solid_lattice};
use pneuflex_factor::{BlockPattern, Factor, FactorError, Inertia, Method, Ordering, Parallelism, Symbolic, multiply};

type TestResult = Result<(), FactorError>;

/// All orderings; `positions` for the geometric one.
fn orderings(positions: &[[f64; 3]]) -> [Ordering<'_>; 4] {
    [Ordering::NestedDissection, Ordering::Geometric(positions), Ordering::Amd, Ordering::Natural]
}

/// What the suite needs of a factorisation.
trait Backend: Sized {
    fn prepare(pattern: &BlockPattern, ordering: Ordering<'_>) -> Result<Self, FactorError>;
    fn factorize(&mut self, values: &[f64], held: &[bool], parallelism: Parallelism) -> Result<Inertia, FactorError>;
    fn solve(&self, rhs: &mut [f64], nrhs: usize) -> TestResult;
}

impl<const B: usize> Backend for FaerFactor<B> {
    fn prepare(pattern: &BlockPattern, ordering: Ordering<'_>) -> Result<Self, FactorError> {
        Ok(Self::new(Arc::new(FaerSymbolic::analyze(pattern, ordering)?)))
    }
    fn factorize(&mut self, values: &[f64], held: &[bool], parallelism: Parallelism) -> Result<Inertia, FactorError> {
        FaerFactor::factorize(self, values, held, parallelism)
    }
    fn solve(&self, rhs: &mut [f64], nrhs: usize) -> TestResult {
        self.solve_in_place(rhs, nrhs)
    }
}

impl<const B: usize> Backend for Factor<B> {
    fn prepare(pattern: &BlockPattern, ordering: Ordering<'_>) -> Result<Self, FactorError> {
        Ok(Self::new(Arc::new(Symbolic::analyze(pattern, ordering)?)))
    }
    fn factorize(&mut self, values: &[f64], held: &[bool], parallelism: Parallelism) -> Result<Inertia, FactorError> {
        Factor::factorize(self, values, held, parallelism)
    }
    fn solve(&self, rhs: &mut [f64], nrhs: usize) -> TestResult {
        self.solve_in_place(rhs, nrhs)
    }
}

fn random_vector(len: usize, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..len).map(|_| random.symmetric()).collect()
}

/// The matrix with held rows and columns replaced by the identity, times `x`.
fn constrained_product<const B: usize>(
    pattern: &BlockPattern,
    values: &[f64],
    held: &[bool],
    x: &[f64],
) -> Result<Vec<f64>, FactorError> {
    let free: Vec<f64> = (x.iter().zip(held)).map(|(&x, &held)| if held { 0.0 } else { x }).collect();
    let mut y = vec![0.0; x.len()];
    multiply::<B>(pattern, values, &free, &mut y)?;
    for dof in 0..x.len() {
        if held[dof] {
            y[dof] = x[dof];
        }
    }
    Ok(y)
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    let scale = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    assert!(scale > 0.0, "the comparison would be vacuous");
    for (index, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= tolerance * scale, "entry {index}: {f} against {e} (scale {scale})");
    }
}

/// Factorises and solves for three right-hand sides at once; checks the residual.
fn check_residual<const B: usize, F: Backend>(
    matrix: &BlockMatrix,
    held: &[bool],
    ordering: Ordering<'_>,
    parallelism: Parallelism,
) -> Result<Inertia, FactorError> {
    let n = B * matrix.pattern.num_nodes();
    let mut factor = F::prepare(&matrix.pattern, ordering)?;
    let inertia = factor.factorize(&matrix.values, held, parallelism)?;
    let rhs = random_vector(3 * n, 7);
    let mut solution = rhs.clone();
    factor.solve(&mut solution, 3)?;
    for k in 0..3 {
        let part = k * n..(k + 1) * n;
        let product = constrained_product::<B>(&matrix.pattern, &matrix.values, held, &solution[part.clone()])?;
        assert_close(&product, &rhs[part.clone()], 1e-10);
        for dof in 0..n {
            if held[dof] {
                assert_eq!(solution[k * n + dof], rhs[k * n + dof]);
            }
        }
    }
    Ok(inertia)
}

fn positive_definite_matrices<const B: usize, F: Backend>() -> TestResult {
    let matrices = [
        solid_lattice::<B>([1, 1, 1], Cell::Hex8),
        solid_lattice::<B>([4, 3, 5], Cell::Hex8),
        solid_lattice::<B>([2, 2, 3], Cell::Hex27),
        hollow_lattice::<B>([19, 6, 7], 1, Cell::Hex8),
    ];
    for matrix in &matrices {
        let n = B * matrix.pattern.num_nodes();
        let free = vec![false; n];
        let some_held: Vec<bool> = random_vector(n, 3).iter().map(|&v| v > 0.6).collect();
        let all_held = vec![true; n];
        for ordering in orderings(&matrix.positions) {
            for parallelism in [Parallelism::Serial, Parallelism::Threads] {
                for held in [&free, &some_held, &all_held] {
                    let inertia = check_residual::<B, F>(matrix, held, ordering, parallelism)?;
                    assert_eq!(inertia, Inertia { negative: 0, method: Method::Cholesky });
                }
            }
        }
    }
    Ok(())
}

/// Negates the dominant diagonal of every tenth unknown: as many negative eigenvalues, by diagonal dominance
/// (Gershgorin).
fn indefinite_matrices<const B: usize, F: Backend>() -> TestResult {
    let mut matrix = hollow_lattice::<B>([19, 6, 7], 1, Cell::Hex8);
    let n = B * matrix.pattern.num_nodes();
    let mut negated = 0;
    for dof in (0..n).step_by(10) {
        let (node, c) = (dof / B, dof % B);
        let block = matrix.pattern.column_offsets()[node] * B * B;
        matrix.values[block + c * B + c] *= -1.0;
        negated += 1;
    }
    for ordering in orderings(&matrix.positions) {
        for parallelism in [Parallelism::Serial, Parallelism::Threads] {
            let inertia = check_residual::<B, F>(&matrix, &vec![false; n], ordering, parallelism)?;
            assert_eq!(inertia, Inertia { negative: negated, method: Method::Ldl });
        }
    }
    Ok(())
}

/// A factor is reused: positive definite, indefinite, singular, positive definite again.
fn refactorization<const B: usize, F: Backend>() -> TestResult {
    let matrix = solid_lattice::<B>([4, 4, 4], Cell::Hex8);
    let n = B * matrix.pattern.num_nodes();
    let free = vec![false; n];
    let negated: Vec<f64> = matrix.values.iter().map(|v| -v).collect();
    let mut factor = F::prepare(&matrix.pattern, Ordering::NestedDissection)?;
    let rhs = random_vector(n, 11);

    assert_eq!(factor.solve(&mut rhs.clone(), 1), Err(FactorError::NotFactorized));
    factor.factorize(&matrix.values, &free, Parallelism::Serial)?;
    let mut first = rhs.clone();
    factor.solve(&mut first, 1)?;

    let inertia = factor.factorize(&negated, &free, Parallelism::Serial)?;
    assert_eq!((inertia.negative, inertia.method), (n, Method::Ldl));
    let mut opposite = rhs.clone();
    factor.solve(&mut opposite, 1)?;
    let opposite: Vec<f64> = opposite.iter().map(|v| -v).collect();
    assert_close(&opposite, &first, 1e-12);

    let zero = vec![0.0; matrix.values.len()];
    assert!(matches!(factor.factorize(&zero, &free, Parallelism::Serial), Err(FactorError::Pivot { .. })));
    assert_eq!(factor.solve(&mut rhs.clone(), 1), Err(FactorError::NotFactorized));
    let mut poisoned = matrix.values.clone();
    let middle = poisoned.len() / 2;
    poisoned[middle] = f64::NAN;
    assert!(matches!(factor.factorize(&poisoned, &free, Parallelism::Serial), Err(FactorError::Pivot { .. })));

    factor.factorize(&matrix.values, &free, Parallelism::Serial)?;
    let mut again = rhs.clone();
    factor.solve(&mut again, 1)?;
    assert_eq!(again, first);
    Ok(())
}

/// The zero pivot is named in the caller's numbering.
fn singular_node_is_named<F: Backend>() -> TestResult {
    let pattern = solid_lattice::<3>([3, 3, 3], Cell::Hex8).pattern;
    let mut values = positive_definite_values::<3>(&pattern, 1e-2, 5);
    let (lonely, component) = (17usize, 2);
    for j in 0..pattern.num_nodes() {
        for (k, &i) in pattern.column(j).iter().enumerate() {
            let block = (pattern.column_offsets()[j] + k) * 9;
            for c in 0..3 {
                for r in 0..3 {
                    let row_hit = i as usize == lonely && r == component;
                    let column_hit = j == lonely && c == component;
                    if row_hit || column_hit {
                        values[block + c * 3 + r] = 0.0;
                    }
                }
            }
        }
    }
    let mut factor = F::prepare(&pattern, Ordering::NestedDissection)?;
    let mut held = vec![false; 3 * pattern.num_nodes()];
    assert_eq!(
        factor.factorize(&values, &held, Parallelism::Serial),
        Err(FactorError::Pivot { node: lonely, component, pivot: 0.0 })
    );
    held[3 * lonely + component] = true;
    factor.factorize(&values, &held, Parallelism::Serial)?;
    Ok(())
}

fn wrong_lengths_are_errors<F: Backend>() -> TestResult {
    let matrix = solid_lattice::<3>([2, 2, 2], Cell::Hex8);
    let n = 3 * matrix.pattern.num_nodes();
    let positions = &matrix.positions[1..];
    assert!(matches!(F::prepare(&matrix.pattern, Ordering::Geometric(positions)), Err(FactorError::Length { .. })));
    let mut factor = F::prepare(&matrix.pattern, Ordering::Amd)?;
    let held = vec![false; n];
    for (values, held) in [(&matrix.values[1..], &held[..]), (&matrix.values[..], &held[1..])] {
        assert!(matches!(factor.factorize(values, held, Parallelism::Serial), Err(FactorError::Length { .. })));
    }
    factor.factorize(&matrix.values, &held, Parallelism::Serial)?;
    assert!(matches!(factor.solve(&mut vec![0.0; n], 2), Err(FactorError::Length { .. })));
    Ok(())
}

fn empty_and_disconnected_graphs<F: Backend>() -> TestResult {
    let empty = BlockPattern::new(vec![0], vec![])?;
    let mut factor = F::prepare(&empty, Ordering::NestedDissection)?;
    factor.factorize(&[], &[], Parallelism::Serial)?;
    factor.solve(&mut [], 1)?;

    let pattern = BlockPattern::from_cliques(9, [[1u32, 4], [7, 4]].iter().map(|c| c.as_slice()));
    let matrix =
        BlockMatrix { values: positive_definite_values::<3>(&pattern, 0.1, 2), positions: vec![[0.0; 3]; 9], pattern };
    for ordering in orderings(&matrix.positions) {
        check_residual::<3, F>(&matrix, &[false; 27], ordering, Parallelism::Threads)?;
    }
    Ok(())
}

macro_rules! battery {
    ($backend:ident, $scalar:ty, $vector:ty) => {
        mod $backend {
            use super::*;
            #[test]
            fn positive_definite() -> TestResult {
                positive_definite_matrices::<1, $scalar>()?;
                positive_definite_matrices::<3, $vector>()
            }
            #[test]
            fn indefinite() -> TestResult {
                indefinite_matrices::<1, $scalar>()?;
                indefinite_matrices::<3, $vector>()
            }
            #[test]
            fn refactorize() -> TestResult {
                refactorization::<1, $scalar>()?;
                refactorization::<3, $vector>()
            }
            #[test]
            fn singular() -> TestResult {
                singular_node_is_named::<$vector>()
            }
            #[test]
            fn lengths() -> TestResult {
                wrong_lengths_are_errors::<$vector>()
            }
            #[test]
            fn degenerate_graphs() -> TestResult {
                empty_and_disconnected_graphs::<$vector>()
            }
        }
    };
}

battery!(faer, FaerFactor<1>, FaerFactor<3>);
battery!(multifrontal, Factor<1>, Factor<3>);
