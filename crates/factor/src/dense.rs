//! Dense kernels of a front: partial factorisation and update, built from faer's sequential kernels.
//!
//! Everything is recursive halving down to tiles of fixed size, and every tile is one sequential call: with a thread
//! pool the tiles run side by side, yet each number is computed by the same operations in the same order, so results
//! do not depend on the number of threads.

use std::cell::RefCell;

use faer::dyn_stack::{MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::{self as ldlt, LdltError, LdltRegularization};
use faer::linalg::cholesky::llt::factor::{self as llt, LltError, LltRegularization};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, unzip, zip};

use crate::outcome::Method;

/// Columns eliminated by one call of the small kernels.
const PIVOT_BLOCK: usize = 24;
/// Largest extent of a tile of a matrix product.
const TILE: usize = 384;
/// Largest extent of a diagonal tile that is computed in full although only its lower half is wanted.
const DIAGONAL_TILE: usize = 64;
/// Row tiles of the triangular solve.
const SOLVE_TILE: usize = 384;

/// Who computes the tiles of one front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Workers {
    /// The calling thread.
    One,
    /// All threads of the current rayon pool.
    Pool,
}

impl Workers {
    /// Runs both closures, side by side if there are threads.
    pub(crate) fn join(self, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
        match self {
            Workers::One => {
                a();
                b();
            }
            Workers::Pool => {
                rayon::join(a, b);
            }
        }
    }
}

/// Scratch that [`factor_panel`] asks of its caller.
pub(crate) fn panel_scratch() -> StackReq {
    StackReq::any_of(&[
        llt::cholesky_in_place_scratch::<f64>(PIVOT_BLOCK, Par::Seq, Default::default()),
        ldlt::cholesky_in_place_scratch::<f64>(PIVOT_BLOCK, Par::Seq, Default::default()),
    ])
}

/// Eliminates all columns of a panel (at least as many rows as columns) whose top square holds the symmetric pivot
/// block in its lower half.
///
/// On return the panel holds `L`; for [`Method::Ldl`], `D` in place of the unit diagonal. What lies above the diagonal
/// is undefined before and after.
///
/// # Errors
/// The column whose pivot is not positive ([`Method::Cholesky`]), zero or not finite (both), and that pivot.
pub(crate) fn factor_panel(
    panel: MatMut<'_, f64>,
    method: Method,
    workers: Workers,
    stack: &mut MemStack,
) -> Result<(), (usize, f64)> {
    let columns = panel.ncols();
    if columns <= PIVOT_BLOCK {
        return factor_narrow_panel(panel, method, workers, stack);
    }
    let half = (columns / 2).next_multiple_of(PIVOT_BLOCK);
    let (mut left, right) = panel.split_at_col_mut(half);
    factor_panel(left.rb_mut(), method, workers, stack)?;
    let (_, mut right) = right.split_at_row_mut(half);
    {
        let (pivots, below) = left.rb().split_at_row(half);
        let (below_top, below_bottom) = below.split_at_row(columns - half);
        let (top, bottom) = right.rb_mut().split_at_row_mut(columns - half);
        let product = Product {
            left: below_top,
            right: below_top,
            pivots: (method == Method::Ldl).then_some(pivots),
            accumulate: Accum::Add,
            workers,
        };
        workers.join(|| product.subtract_lower(top), || product.of(below_bottom, below_top).subtract(bottom));
    }
    factor_panel(right, method, workers, stack).map_err(|(column, pivot)| (half + column, pivot))
}

fn factor_narrow_panel(
    panel: MatMut<'_, f64>,
    method: Method,
    workers: Workers,
    stack: &mut MemStack,
) -> Result<(), (usize, f64)> {
    let columns = panel.ncols();
    let (mut pivots, below) = panel.split_at_row_mut(columns);
    match method {
        Method::Cholesky => {
            llt::cholesky_in_place(pivots.rb_mut(), LltRegularization::default(), Par::Seq, stack, Default::default())
                .map(|_| ())
                .map_err(|LltError::NonPositivePivot { index }| index)
        }
        Method::Ldl => {
            ldlt::cholesky_in_place(pivots.rb_mut(), LdltRegularization::default(), Par::Seq, stack, Default::default())
                .map(|_| ())
                .map_err(|LdltError::ZeroPivot { index }| index)
        }
    }
    .map_err(|index| (index, pivots[(index, index)]))?;
    solve_rows(pivots.rb(), below, method, workers);
    Ok(())
}

/// `below ← below L⁻ᵀ` (and `D⁻¹`), by tiles of rows.
fn solve_rows(pivots: MatRef<'_, f64>, mut below: MatMut<'_, f64>, method: Method, workers: Workers) {
    let rows = below.nrows();
    if rows > SOLVE_TILE {
        let (top, bottom) = below.split_at_row_mut(halve(rows));
        workers.join(|| solve_rows(pivots, top, method, workers), || solve_rows(pivots, bottom, method, workers));
        return;
    }
    match method {
        Method::Cholesky => {
            solve_lower_triangular_in_place(pivots, below.transpose_mut(), Par::Seq);
        }
        Method::Ldl => {
            solve_unit_lower_triangular_in_place(pivots, below.rb_mut().transpose_mut(), Par::Seq);
            for k in 0..pivots.ncols() {
                let inverse = pivots[(k, k)].recip();
                zip!(below.rb_mut().col_mut(k)).for_each(|unzip!(entry)| *entry *= inverse);
            }
        }
    }
}

/// `update ← -L Lᵀ` (or `-L D Lᵀ`) from the rows of a factored panel below its pivot block; lower half only, what lies
/// above the diagonal is undefined.
pub(crate) fn update_matrix(update: MatMut<'_, f64>, panel: MatRef<'_, f64>, method: Method, workers: Workers) {
    let (pivots, below) = panel.split_at_row(panel.ncols());
    let product = Product {
        left: below,
        right: below,
        pivots: (method == Method::Ldl).then_some(pivots),
        accumulate: Accum::Replace,
        workers,
    };
    product.subtract_lower(update);
}

/// `left rightᵀ`, or `left D rightᵀ` with `D` on the diagonal of `pivots`, to be subtracted from a target (or from
/// nothing, to replace it).
#[derive(Clone, Copy)]
struct Product<'a> {
    left: MatRef<'a, f64>,
    right: MatRef<'a, f64>,
    pivots: Option<MatRef<'a, f64>>,
    accumulate: Accum,
    workers: Workers,
}

impl<'a> Product<'a> {
    /// The same for other factors.
    fn of(self, left: MatRef<'a, f64>, right: MatRef<'a, f64>) -> Self {
        Self { left, right, ..self }
    }

    /// Lower half of a square target.
    fn subtract_lower(self, target: MatMut<'_, f64>) {
        let n = target.nrows();
        if n <= DIAGONAL_TILE {
            return self.subtract(target);
        }
        let half = halve(n);
        let (top_left, _, bottom_left, bottom_right) = target.split_at_mut(half, half);
        let (left_top, left_bottom) = self.left.split_at_row(half);
        let (right_top, right_bottom) = self.right.split_at_row(half);
        self.workers.join(
            || self.of(left_bottom, right_top).subtract(bottom_left),
            || {
                self.workers.join(
                    || self.of(left_top, right_top).subtract_lower(top_left),
                    || self.of(left_bottom, right_bottom).subtract_lower(bottom_right),
                );
            },
        );
    }

    /// All of the target, by tiles.
    fn subtract(self, target: MatMut<'_, f64>) {
        let (rows, columns) = (target.nrows(), target.ncols());
        if rows == 0 || columns == 0 {
        } else if rows.max(columns) <= TILE {
            self.subtract_tile(target);
        } else if rows >= columns {
            let half = halve(rows);
            let (top, bottom) = target.split_at_row_mut(half);
            let (left_top, left_bottom) = self.left.split_at_row(half);
            self.workers.join(
                || self.of(left_top, self.right).subtract(top),
                || self.of(left_bottom, self.right).subtract(bottom),
            );
        } else {
            let half = halve(columns);
            let (left, right) = target.split_at_col_mut(half);
            let (right_top, right_bottom) = self.right.split_at_row(half);
            self.workers.join(
                || self.of(self.left, right_top).subtract(left),
                || self.of(self.left, right_bottom).subtract(right),
            );
        }
    }

    fn subtract_tile(self, target: MatMut<'_, f64>) {
        let Some(pivots) = self.pivots else {
            matmul(target, self.accumulate, self.left, self.right.transpose(), -1.0, Par::Seq);
            return;
        };
        // A buffer per thread: allocating one per tile would have the threads queue for the allocator.
        SCALED.with_borrow_mut(|scaled| {
            let (rows, columns) = (self.right.nrows(), self.right.ncols());
            let len = rows * columns;
            if scaled.len() < len {
                scaled.resize(len, 0.0);
            }
            let mut scaled = MatMut::from_column_major_slice_mut(&mut scaled[..len], rows, columns);
            for k in 0..columns {
                let pivot = pivots[(k, k)];
                zip!(scaled.rb_mut().col_mut(k), self.right.col(k)).for_each(|unzip!(s, r)| *s = r * pivot);
            }
            matmul(target, self.accumulate, self.left, scaled.transpose(), -1.0, Par::Seq);
        });
    }
}

thread_local! {
    /// `right D` of the tile at hand.
    static SCALED: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// About half, rounded so that tiles fill whole registers.
fn halve(n: usize) -> usize {
    (n / 2).next_multiple_of(16)
}
