//! One front: assemble its panel, eliminate, pass the update on.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::{MatMut, MatRef};

use crate::dense::{Workers, factor_panel, panel_scratch, update_matrix};
use crate::outcome::Method;
use crate::symbolic::{Run, Symbolic};

/// Columns (in nodes) that one task assembles when several threads share a front.
const ASSEMBLY_TILE: usize = 64;

/// The matrix to factorise, as the caller gave it.
#[derive(Clone, Copy)]
pub(crate) struct Input<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) held: &'a [bool],
    pub(crate) method: Method,
}

/// A pivot that stopped the elimination.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BadPivot {
    pub(crate) front: usize,
    /// Column within the front, in unknowns.
    pub(crate) column: usize,
    pub(crate) pivot: f64,
}

/// Computes panel and update matrix of a front from the original entries and the update matrices of its children.
///
/// `update` may be longer than needed; its old content does not matter. Returns the number of negative pivots.
pub(crate) fn compute_front<'a, const B: usize>(
    symbolic: &Symbolic<B>,
    front: usize,
    input: Input<'_>,
    panel: &mut [f64],
    update: &mut [f64],
    child_update: impl Fn(usize) -> &'a [f64] + Sync,
    workers: Workers,
) -> Result<usize, BadPivot> {
    let shape = &symbolic.fronts[front];
    let (columns, rows) = (shape.columns * B, shape.rows * B);
    let assembly = Assembly { symbolic, front, input, child_update: &child_update };
    assembly.run(Part::Panel, 0..shape.columns, &mut panel[..shape.panel_len::<B>()], workers);

    let mut scratch = MemBuffer::new(panel_scratch());
    let scratch = MemStack::new(&mut scratch);
    let mut matrix =
        MatMut::from_column_major_slice_with_stride_mut(panel, columns + rows, columns, shape.panel_stride);
    factor_panel(matrix.as_mut(), input.method, workers, scratch).map_err(|(column, pivot)| BadPivot {
        front,
        column,
        pivot,
    })?;
    let matrix = matrix.as_ref();
    let negative = match input.method {
        Method::Cholesky => 0,
        Method::Ldl => (0..columns).filter(|&k| matrix[(k, k)] < 0.0).count(),
    };

    if rows > 0 {
        let update = &mut update[..shape.update_len::<B>()];
        update_matrix(
            MatMut::from_column_major_slice_with_stride_mut(update, rows, rows, shape.update_stride),
            matrix,
            input.method,
            workers,
        );
        assembly.run(Part::Update, shape.columns..shape.columns + shape.rows, update, workers);
    }
    Ok(negative)
}

/// The two storages of a front.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    /// Columns to be eliminated, all rows: starts from the original entries.
    Panel,
    /// The rest: starts from what elimination left there.
    Update,
}

struct Assembly<'a, const B: usize, F> {
    symbolic: &'a Symbolic<B>,
    front: usize,
    input: Input<'a>,
    child_update: &'a F,
}

impl<'c, const B: usize, F: Fn(usize) -> &'c [f64] + Sync> Assembly<'_, B, F> {
    /// Assembles the given columns (positions in the front) into `target`, which holds exactly these columns.
    fn run(&self, part: Part, columns: Range<usize>, target: &mut [f64], workers: Workers) {
        let shape = &self.symbolic.fronts[self.front];
        let (stride, first_row) = match part {
            Part::Panel => (shape.panel_stride, 0),
            Part::Update => (shape.update_stride, shape.columns),
        };
        if workers == Workers::Pool && columns.len() > ASSEMBLY_TILE {
            let middle = columns.start + columns.len() / 2;
            let (left, right) = target.split_at_mut(stride * B * (middle - columns.start));
            rayon::join(
                || self.run(part, columns.start..middle, left, workers),
                || self.run(part, middle..columns.end, right, workers),
            );
            return;
        }
        if part == Part::Panel {
            target.fill(0.0);
            self.add_entries(columns.clone(), target, stride);
        }
        for &child in self.symbolic.children(self.front) {
            let child = child as usize;
            add_update::<B>(
                (self.child_update)(child),
                self.symbolic.fronts[child].update_stride,
                self.symbolic.runs(child),
                columns.clone(),
                first_row,
                target,
                stride,
            );
        }
    }

    /// Copies the original blocks of the given columns, held rows and columns as identity.
    fn add_entries(&self, columns: Range<usize>, target: &mut [f64], stride: usize) {
        let entries = self.symbolic.entries(self.front);
        let start = entries.partition_point(|entry| (entry.column as usize) < columns.start);
        let mut column_node = 0;
        let mut column_position = usize::MAX;
        for entry in &entries[start..] {
            let (row, column) = (entry.row as usize, entry.column as usize);
            if column >= columns.end {
                break;
            }
            if column != column_position {
                column_position = column;
                column_node = self.symbolic.node_at(self.front, column);
            }
            let row_node = self.symbolic.node_at(self.front, row);
            let row_held = &self.input.held[row_node * B..(row_node + 1) * B];
            let column_held = &self.input.held[column_node * B..(column_node + 1) * B];
            let any_held = row_held.iter().chain(column_held).any(|&held| held);
            let block = &self.input.values[entry.source() * B * B..(entry.source() + 1) * B * B];
            for c in 0..B {
                let offset = ((column - columns.start) * B + c) * stride + row * B;
                let target = &mut target[offset..offset + B];
                for r in 0..B {
                    target[r] = if entry.transposed() { block[r * B + c] } else { block[c * B + r] };
                    if any_held && (row_held[r] || column_held[c]) {
                        let same = row == column && r == c;
                        target[r] = if same { 1.0 } else { 0.0 };
                    }
                }
            }
        }
    }
}

/// Adds the part of a child's update matrix that falls into the given columns of its parent ("extend-add").
fn add_update<const B: usize>(
    update: &[f64],
    update_stride: usize,
    runs: &[Run],
    columns: Range<usize>,
    first_row: usize,
    target: &mut [f64],
    target_stride: usize,
) {
    for (index, run) in runs.iter().enumerate() {
        let run_target = run.target as usize;
        let first = run_target.max(columns.start);
        let end = (run_target + run.length as usize).min(columns.end);
        if run_target >= columns.end {
            break;
        }
        for column in first..end {
            let source_node = run.source as usize + column - run_target;
            let source = &update[source_node * B * update_stride..];
            let into = &mut target[(column - columns.start) * B * target_stride..];
            // Rows of the same run, from the diagonal on: what is above it is not defined.
            let below = end_of(run) - column;
            for c in 0..B {
                add(
                    &mut into[c * target_stride + (column - first_row) * B..][..below * B],
                    &source[c * update_stride + source_node * B..][..below * B],
                );
            }
            for lower in &runs[index + 1..] {
                let rows = lower.length as usize * B;
                let to = (lower.target as usize - first_row) * B;
                let from = lower.source as usize * B;
                for c in 0..B {
                    add(&mut into[c * target_stride + to..][..rows], &source[c * update_stride + from..][..rows]);
                }
            }
        }
    }
}

fn end_of(run: &Run) -> usize {
    (run.target + run.length) as usize
}

#[inline(always)]
fn add(target: &mut [f64], source: &[f64]) {
    for (t, s) in target.iter_mut().zip(source) {
        *t += s;
    }
}

/// The panel of a front as a matrix.
pub(crate) fn panel_matrix<'a, const B: usize>(
    symbolic: &Symbolic<B>,
    front: usize,
    panel: &'a [f64],
) -> MatRef<'a, f64> {
    let shape = &symbolic.fronts[front];
    MatRef::from_column_major_slice_with_stride(
        panel,
        (shape.columns + shape.rows) * B,
        shape.columns * B,
        shape.panel_stride,
    )
}
