//! Scalar supernodal factorisation by faer: simple, complete, and the oracle of the faster backend.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::error::{FactorError, check_length};
use crate::ordering::{Ordering, order_nodes};
use crate::outcome::{Inertia, Method, Parallelism};
use crate::pattern::BlockPattern;

/// Symbolic analysis of a matrix of `B × B` node blocks: the node graph is ordered, then expanded to unknowns.
pub struct FaerSymbolic<const B: usize> {
    num_nodes: usize,
    num_blocks: usize,
    /// Lower triangle of the scalar matrix.
    column_offsets: Vec<usize>,
    rows: Vec<usize>,
    /// Where each scalar entry lives in the caller's block values.
    source: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    flops: f64,
}

impl<const B: usize> FaerSymbolic<B> {
    /// Orders the node graph and computes the pattern of the factor.
    ///
    /// # Errors
    /// [`FactorError::TooLarge`], [`FactorError::Analysis`], or [`FactorError::Length`] if positions are given for the
    /// wrong number of nodes.
    pub fn analyze(pattern: &BlockPattern, ordering: Ordering<'_>) -> Result<Self, FactorError> {
        let order = order_nodes(pattern, &pattern.adjacency()?, ordering)?;
        let num_nodes = pattern.num_nodes();
        let n = num_nodes * B;

        let mut column_offsets = Vec::with_capacity(n + 1);
        column_offsets.push(0);
        let mut rows = Vec::with_capacity(pattern.num_blocks() * B * B);
        let mut source = Vec::with_capacity(pattern.num_blocks() * B * B);
        for j in 0..num_nodes {
            for c in 0..B {
                for (k, &i) in pattern.column(j).iter().enumerate() {
                    let i = i as usize;
                    let first = if i == j { c } else { 0 };
                    for r in first..B {
                        rows.push(i * B + r);
                        source.push((pattern.column_offsets()[j] + k) * B * B + c * B + r);
                    }
                }
                column_offsets.push(rows.len());
            }
        }

        let forward: Vec<usize> = order.iter().flat_map(|&node| (0..B).map(move |c| node as usize * B + c)).collect();
        let mut inverse = vec![0; n];
        for (new, &old) in forward.iter().enumerate() {
            inverse[old] = new;
        }
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(n, n, &column_offsets, None, &rows),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n)),
            CholeskySymbolicParams::default(),
        )
        .map_err(|error| FactorError::Analysis(error.to_string()))?;
        let flops = count_flops(&symbolic);
        Ok(Self { num_nodes, num_blocks: pattern.num_blocks(), column_offsets, rows, source, symbolic, flops })
    }

    /// Number of stored entries of the factor.
    pub fn factor_nonzeros(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Floating-point operations (multiplications and additions) of one factorisation.
    pub fn flops(&self) -> f64 {
        self.flops
    }

    /// Estimated peak of the numeric phase: factor, permuted copy of the matrix and scratch, in bytes.
    pub fn memory_bytes(&self) -> usize {
        let values = self.symbolic.len_val() + 2 * self.rows.len();
        values * size_of::<f64>() + self.scratch(Par::Seq).size_bytes()
    }

    fn num_unknowns(&self) -> usize {
        self.num_nodes * B
    }

    fn scratch(&self, par: Par) -> StackReq {
        StackReq::any_of(&[
            self.symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default()),
            self.symbolic.factorize_numeric_ldlt_scratch::<f64>(par, Default::default()),
        ])
    }
}

/// Multiplications and additions of `L Lᵀ` on the (relaxed) pattern: the sum of squared column counts.
fn count_flops(symbolic: &SymbolicCholesky<usize>) -> f64 {
    let square = |count: usize| (count as f64).powi(2);
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(simplicial) => {
            simplicial.col_ptr().windows(2).map(|pair| square(pair[1] - pair[0])).sum()
        }
        SymbolicCholeskyRaw::Supernodal(supernodal) => (0..supernodal.n_supernodes())
            .map(|s| {
                let columns = supernodal.supernode_end()[s] - supernodal.supernode_begin()[s];
                let below = supernodal.supernode(s).pattern().len();
                (1..=columns).map(|k| square(below + k)).sum::<f64>()
            })
            .sum(),
    }
}

/// Numeric factorisation on a [`FaerSymbolic`] pattern; owns all its buffers.
pub struct FaerFactor<const B: usize> {
    symbolic: Arc<FaerSymbolic<B>>,
    matrix: Vec<f64>,
    values: Vec<f64>,
    scratch: MemBuffer,
    scratch_bytes: usize,
    method: Option<Method>,
}

impl<const B: usize> FaerFactor<B> {
    /// Allocates the factor and the scratch.
    pub fn new(symbolic: Arc<FaerSymbolic<B>>) -> Self {
        let scratch = symbolic.scratch(Par::Seq);
        Self {
            matrix: vec![0.0; symbolic.rows.len()],
            values: vec![0.0; symbolic.symbolic.len_val()],
            scratch: MemBuffer::new(scratch),
            scratch_bytes: scratch.size_bytes(),
            method: None,
            symbolic,
        }
    }

    /// `L Lᵀ`, or `L D Lᵀ` when a pivot is not positive.
    ///
    /// `values` holds `B·B` numbers per block of the pattern (layout: [`BlockPattern`]); the row and the column of
    /// every degree of freedom with `held[dof]` are replaced by those of the identity.
    ///
    /// # Errors
    /// [`FactorError::Length`] on arguments that do not fit, [`FactorError::Pivot`] on a singular matrix.
    pub fn factorize(
        &mut self,
        values: &[f64],
        held: &[bool],
        parallelism: Parallelism,
    ) -> Result<Inertia, FactorError> {
        self.method = None;
        let n = self.symbolic.num_unknowns();
        check_length("values", self.symbolic.num_blocks * B * B, values.len())?;
        check_length("held", n, held.len())?;
        if n == 0 {
            return Ok(self.succeed(Method::Cholesky, 0));
        }
        self.load(values, held);

        let par = match parallelism {
            Parallelism::Serial => Par::Seq,
            Parallelism::Threads => Par::rayon(0),
        };
        let scratch = self.symbolic.scratch(par);
        if scratch.size_bytes() > self.scratch_bytes {
            self.scratch = MemBuffer::new(scratch);
            self.scratch_bytes = scratch.size_bytes();
        }
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &self.symbolic.column_offsets, None, &self.symbolic.rows);
        let matrix = SparseColMatRef::new(pattern, &self.matrix);
        let symbolic = &self.symbolic.symbolic;
        let positive = symbolic
            .factorize_numeric_llt(
                &mut self.values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                par,
                MemStack::new(&mut self.scratch),
                Default::default(),
            )
            .is_ok()
            && self.pivots().all(|(_, pivot)| pivot.is_finite());
        if positive {
            return Ok(self.succeed(Method::Cholesky, 0));
        }
        let ldlt = symbolic.factorize_numeric_ldlt(
            &mut self.values,
            matrix,
            Side::Lower,
            LdltRegularization::default(),
            par,
            MemStack::new(&mut self.scratch),
            Default::default(),
        );
        if let Err(LdltError::ZeroPivot { index }) = ldlt {
            // faer counts from one in its simplicial variant, from zero in the supernodal one.
            let index = match symbolic.raw() {
                SymbolicCholeskyRaw::Simplicial(_) => index.saturating_sub(1),
                SymbolicCholeskyRaw::Supernodal(_) => index,
            };
            return Err(self.singular(index, 0.0));
        }
        let unusable = self.pivots().find(|&(_, pivot)| pivot == 0.0 || !pivot.is_finite());
        if let Some((index, pivot)) = unusable {
            return Err(self.singular(index, pivot));
        }
        let negative = self.pivots().filter(|&(_, pivot)| pivot < 0.0).count();
        Ok(self.succeed(Method::Ldl, negative))
    }

    /// Solves `K x = rhs` for `nrhs` right-hand sides of `B·num_nodes` entries each, one after another.
    ///
    /// Entries at held degrees of freedom pass through unchanged.
    ///
    /// # Errors
    /// [`FactorError::NotFactorized`] before a successful factorisation, [`FactorError::Length`].
    pub fn solve_in_place(&self, rhs: &mut [f64], nrhs: usize) -> Result<(), FactorError> {
        let method = self.method.ok_or(FactorError::NotFactorized)?;
        let n = self.symbolic.num_unknowns();
        check_length("rhs", n * nrhs, rhs.len())?;
        if n == 0 || nrhs == 0 {
            return Ok(());
        }
        let symbolic = &self.symbolic.symbolic;
        let mut memory = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(nrhs, Par::Seq));
        let stack = MemStack::new(&mut memory);
        let rhs = MatMut::from_column_major_slice_mut(rhs, n, nrhs);
        match method {
            Method::Cholesky => {
                LltRef::new(symbolic, &self.values).solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack)
            }
            Method::Ldl => {
                LdltRef::new(symbolic, &self.values).solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack)
            }
        }
        Ok(())
    }

    fn succeed(&mut self, method: Method, negative: usize) -> Inertia {
        self.method = Some(method);
        Inertia { negative, method }
    }

    /// Scatters the block values into the scalar lower triangle, held rows and columns as identity.
    fn load(&mut self, values: &[f64], held: &[bool]) {
        let symbolic = &self.symbolic;
        for j in 0..held.len() {
            for k in symbolic.column_offsets[j]..symbolic.column_offsets[j + 1] {
                let i = symbolic.rows[k];
                self.matrix[k] = match held[i] || held[j] {
                    false => values[symbolic.source[k]],
                    true if i == j => 1.0,
                    true => 0.0,
                };
            }
        }
    }

    /// The diagonal of the factor (of `L` or of `D`) with its position in elimination order.
    fn pivots(&self) -> Box<dyn Iterator<Item = (usize, f64)> + '_> {
        match self.symbolic.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => Box::new(
                simplicial.col_ptr()[..simplicial.ncols()]
                    .iter()
                    .enumerate()
                    .map(|(j, &first)| (j, self.values[first])),
            ),
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = supernodal::SupernodalLdltRef::new(symbolic, &self.values);
                Box::new((0..symbolic.n_supernodes()).flat_map(move |s| {
                    let supernode = factor.supernode(s);
                    (0..supernode.val().ncols()).map(move |k| (supernode.start() + k, supernode.val()[(k, k)]))
                }))
            }
        }
    }

    fn singular(&self, index: usize, pivot: f64) -> FactorError {
        let dof = match self.symbolic.symbolic.perm() {
            Some(permutation) => permutation.arrays().0.get(index).copied().unwrap_or(index),
            None => index,
        };
        FactorError::Pivot { node: dof / B, component: dof % B, pivot }
    }
}
