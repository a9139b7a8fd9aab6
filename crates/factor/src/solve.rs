//! Forward and backward substitution on the fronts.
//!
//! Each front works on a vector of its own: its columns, then its rows. Going up, a child's rows are added into its
//! parent's vector; coming down, they are read from it. No front touches entries of another, so subtrees run side by
//! side and the sums keep their order.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place,
    solve_upper_triangular_in_place,
};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use crate::dense::Workers;
use crate::error::{FactorError, check_length};
use crate::front::panel_matrix;
use crate::numeric::Factor;
use crate::outcome::{Method, Parallelism};
use crate::symbolic::Run;

/// Rows (or columns) of a panel multiplied by one call.
const PRODUCT_TILE: usize = 1024;

impl<const B: usize> Factor<B> {
    /// Solves `K x = rhs` for `nrhs` right-hand sides of `B·num_nodes` entries each, one after another.
    ///
    /// Entries at held degrees of freedom pass through unchanged. Uses threads if the last factorisation did.
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
        let solve = Solve { factor: self, method, nrhs };
        let mut blocks = vec![0.0; n * nrhs];
        solve.gather(rhs, &mut blocks);
        let num_fronts = self.symbolic.fronts.len();
        let mut passed = vec![None; num_fronts];
        if self.parallelism == Parallelism::Threads && self.plan.tasks.len() > 1 {
            solve.with_threads(&mut blocks, &mut passed);
        } else {
            let mut all = Part { fronts: 0..num_fronts, blocks: &mut blocks, passed: &mut passed };
            solve.forward_subtree(&mut all);
            solve.backward_subtree(&mut all, None);
        }
        solve.scatter(&blocks, rhs);
        Ok(())
    }
}

/// Consecutive fronts with what belongs to them.
struct Part<'a> {
    fronts: Range<usize>,
    /// Their columns of the right-hand sides, front by front.
    blocks: &'a mut [f64],
    /// Vectors that other fronts still have to read.
    passed: &'a mut [Option<Vec<f64>>],
}

struct Solve<'a, const B: usize> {
    factor: &'a Factor<B>,
    method: Method,
    nrhs: usize,
}

impl<const B: usize> Solve<'_, B> {
    /// Copies right-hand sides into blocks: front by front, its columns for the first side, the second, …
    fn gather(&self, rhs: &[f64], blocks: &mut [f64]) {
        self.for_each_node(|node, block, stride| {
            for (k, side) in rhs.chunks_exact(rhs.len() / self.nrhs).enumerate() {
                let to = block + k * stride;
                blocks[to..to + B].copy_from_slice(&side[node * B..(node + 1) * B]);
            }
        });
    }

    /// The inverse of [`Solve::gather`].
    fn scatter(&self, blocks: &[f64], rhs: &mut [f64]) {
        let n = rhs.len() / self.nrhs;
        self.for_each_node(|node, block, stride| {
            for (k, side) in rhs.chunks_exact_mut(n).enumerate() {
                let from = block + k * stride;
                side[node * B..(node + 1) * B].copy_from_slice(&blocks[from..from + B]);
            }
        });
    }

    /// Visits the caller's nodes with their position in the blocks and the distance between right-hand sides there.
    fn for_each_node(&self, mut visit: impl FnMut(usize, usize, usize)) {
        let symbolic = &self.factor.symbolic;
        for front in &symbolic.fronts {
            let steps = front.first_step..front.first_step + front.columns;
            for (k, &node) in symbolic.tree.order[steps].iter().enumerate() {
                let block = front.first_step * B * self.nrhs + k * B;
                visit(node as usize, block, front.columns * B);
            }
        }
    }

    fn panel(&self, front: usize) -> MatRef<'_, f64> {
        let symbolic = &self.factor.symbolic;
        panel_matrix(symbolic, front, &self.factor.panels[symbolic.fronts[front].panel_offset..])
    }

    /// Entries of a front's columns, all right-hand sides together.
    fn block_len(&self, front: usize) -> usize {
        self.factor.symbolic.fronts[front].columns * B * self.nrhs
    }

    /// Where the columns of a front are in the blocks of a part.
    fn block(&self, front: usize, part: &Part<'_>) -> Range<usize> {
        let fronts = &self.factor.symbolic.fronts;
        let steps = fronts[front].first_step - fronts[part.fronts.start].first_step;
        let start = steps * B * self.nrhs;
        start..start + self.block_len(front)
    }

    fn forward_subtree(&self, part: &mut Part<'_>) {
        for front in part.fronts.clone() {
            self.forward(front, part, Workers::One);
        }
    }

    /// `root_vector` is that of the part's last front, if its parent is not in the part.
    fn backward_subtree(&self, part: &mut Part<'_>, mut root_vector: Option<Vec<f64>>) {
        let symbolic = &self.factor.symbolic;
        let origin = part.fronts.start;
        for front in part.fronts.clone().rev() {
            let vector = root_vector.take().unwrap_or_else(|| {
                let parent = symbolic.fronts[front].parent as usize;
                let parent_vector = match parent.checked_sub(origin) {
                    Some(parent) => part.passed.get_mut(parent),
                    None => None,
                };
                let vector = self.vector(front, parent_vector.as_ref().and_then(|v| v.as_deref()));
                if let Some(parent_vector) = parent_vector
                    && symbolic.children(parent).first() == Some(&(front as u32))
                {
                    *parent_vector = None;
                }
                vector
            });
            self.backward(front, part, vector, Workers::One);
        }
    }

    /// Subtrees side by side, the top of the tree one front after another with all threads.
    fn with_threads(&self, blocks: &mut [f64], passed: &mut [Option<Vec<f64>>]) {
        let tasks = &self.factor.plan.tasks;
        let all = 0..passed.len();

        let mut subtrees = self.subtrees(blocks, passed);
        subtrees.par_iter_mut().with_max_len(1).for_each(|part| self.forward_subtree(part));
        drop(subtrees);

        let mut whole = Part { fronts: all, blocks, passed };
        let shared = || tasks.iter().filter(|task| task.shared).map(|task| task.fronts.start);
        for front in shared() {
            self.forward(front, &mut whole, Workers::Pool);
        }
        for front in shared().rev() {
            let vector = self.vector_below_shared(front, whole.passed);
            self.backward(front, &mut whole, vector, Workers::Pool);
        }

        let roots: Vec<Vec<f64>> = (tasks.iter().filter(|task| !task.shared))
            .map(|task| self.vector_below_shared(task.fronts.end - 1, whole.passed))
            .collect();
        self.subtrees(whole.blocks, whole.passed)
            .par_iter_mut()
            .with_max_len(1)
            .zip(roots)
            .for_each(|(part, root)| self.backward_subtree(part, Some(root)));
    }

    /// The parts of the subtrees of the plan.
    fn subtrees<'b>(&self, mut blocks: &'b mut [f64], mut passed: &'b mut [Option<Vec<f64>>]) -> Vec<Part<'b>> {
        let mut parts = Vec::new();
        for task in &self.factor.plan.tasks {
            let len = task.fronts.clone().map(|front| self.block_len(front)).sum();
            let own_blocks;
            let own_passed;
            (own_blocks, blocks) = std::mem::take(&mut blocks).split_at_mut(len);
            (own_passed, passed) = std::mem::take(&mut passed).split_at_mut(task.fronts.len());
            if !task.shared {
                parts.push(Part { fronts: task.fronts.clone(), blocks: own_blocks, passed: own_passed });
            }
        }
        parts
    }

    /// `y ← L₁₁⁻¹ y`, rows ← rows − `L₂₁ y` for one front, rows starting from those its children pass up.
    fn forward(&self, front: usize, part: &mut Part<'_>, workers: Workers) {
        let symbolic = &self.factor.symbolic;
        let shape = &symbolic.fronts[front];
        let (columns, rows) = (shape.columns * B, shape.rows * B);
        let block = self.block(front, part);
        let block = &mut part.blocks[block];
        let mut below = vec![0.0; rows * self.nrhs];
        for &child in symbolic.children(front) {
            let child = child as usize;
            let Some(update) = part.passed[child - part.fronts.start].take() else {
                continue;
            };
            let child_rows = symbolic.fronts[child].rows * B;
            for (k, update) in update.chunks_exact(child_rows).enumerate() {
                for run in symbolic.runs(child) {
                    let target = run.target as usize * B;
                    let into = match target.checked_sub(columns) {
                        None => &mut block[k * columns + target..],
                        Some(row) => &mut below[k * rows + row..],
                    };
                    for (t, s) in into.iter_mut().zip(&update[source::<B>(run)]) {
                        *t += s;
                    }
                }
            }
        }
        let mut y = MatMut::from_column_major_slice_mut(block, columns, self.nrhs);
        let (pivots, lower) = self.panel(front).split_at_row(columns);
        match self.method {
            Method::Cholesky => solve_lower_triangular_in_place(pivots, y.rb_mut(), Par::Seq),
            Method::Ldl => solve_unit_lower_triangular_in_place(pivots, y.rb_mut(), Par::Seq),
        }
        if rows > 0 {
            let below_matrix = MatMut::from_column_major_slice_mut(&mut below, rows, self.nrhs);
            subtract_product(below_matrix, lower, y.rb(), workers);
            part.passed[front - part.fronts.start] = Some(below);
        }
    }

    /// `y ← L₁₁⁻ᵀ (D⁻¹ y − L₂₁ᵀ rows)` for one front whose `vector` holds the rows already.
    ///
    /// Leaves the completed vector in `passed` for the front's children.
    fn backward(&self, front: usize, part: &mut Part<'_>, mut vector: Vec<f64>, workers: Workers) {
        let symbolic = &self.factor.symbolic;
        let shape = &symbolic.fronts[front];
        let columns = shape.columns * B;
        let (pivots, lower) = self.panel(front).split_at_row(columns);
        let block = self.block(front, part);
        let mut y = MatMut::from_column_major_slice_mut(&mut part.blocks[block], columns, self.nrhs);
        if self.method == Method::Ldl {
            for k in 0..columns {
                let pivot = pivots[(k, k)];
                for side in 0..self.nrhs {
                    y[(k, side)] /= pivot;
                }
            }
        }
        let all = columns + shape.rows * B;
        let matrix = MatMut::from_column_major_slice_mut(&mut vector, all, self.nrhs);
        let (mut top, below) = matrix.split_at_row_mut(columns);
        if shape.rows > 0 {
            subtract_product(y.rb_mut(), lower.transpose(), below.rb(), workers);
        }
        let transposed = pivots.transpose();
        match self.method {
            Method::Cholesky => {
                solve_upper_triangular_in_place(transposed, y.rb_mut(), Par::Seq);
            }
            Method::Ldl => {
                solve_unit_upper_triangular_in_place(transposed, y.rb_mut(), Par::Seq);
            }
        }
        if !symbolic.children(front).is_empty() {
            top.copy_from(y.rb());
            part.passed[front - part.fronts.start] = Some(vector);
        }
    }

    /// A vector for a front, its rows read from the vector of its parent.
    fn vector(&self, front: usize, parent_vector: Option<&[f64]>) -> Vec<f64> {
        let symbolic = &self.factor.symbolic;
        let shape = &symbolic.fronts[front];
        let columns = shape.columns * B;
        let mut vector = vec![0.0; (columns + shape.rows * B) * self.nrhs];
        if let Some(parent_vector) = parent_vector {
            let parent_len = parent_vector.len() / self.nrhs;
            let sides = vector.chunks_exact_mut(columns + shape.rows * B);
            for (side, parent_side) in sides.zip(parent_vector.chunks_exact(parent_len)) {
                for run in symbolic.runs(front) {
                    let from = run.target as usize * B;
                    let rows = &mut side[columns..][source::<B>(run)];
                    rows.copy_from_slice(&parent_side[from..from + rows.len()]);
                }
            }
        }
        vector
    }

    /// The same for a front whose parent, if any, is shared.
    fn vector_below_shared(&self, front: usize, passed: &[Option<Vec<f64>>]) -> Vec<f64> {
        let parent = self.factor.symbolic.fronts[front].parent as usize;
        self.vector(front, passed.get(parent).and_then(|vector| vector.as_deref()))
    }
}

/// The rows of a run in the child's update.
fn source<const B: usize>(run: &Run) -> Range<usize> {
    run.source as usize * B..(run.source + run.length) as usize * B
}

/// `target ← target − a b`, by tiles of rows.
fn subtract_product(target: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, workers: Workers) {
    let rows = target.nrows();
    if rows <= PRODUCT_TILE {
        matmul(target, Accum::Add, a, b, -1.0, Par::Seq);
        return;
    }
    let half = rows / 2;
    let (top, bottom) = target.split_at_row_mut(half);
    let (a_top, a_bottom) = a.split_at_row(half);
    workers.join(|| subtract_product(top, a_top, b, workers), || subtract_product(bottom, a_bottom, b, workers));
}
