//! Symbolic analysis: everything about a factorisation that does not depend on the values.

use crate::assembly_tree::AssemblyTree;
use crate::elimination::{EliminationTree, NONE};
use crate::error::FactorError;
use crate::ordering::{Ordering, order_nodes};
use crate::pattern::BlockPattern;

/// Structure of the factor of a matrix of `B × B` node blocks, and the plan of computing it.
///
/// The node graph is ordered, its columns are grouped into fronts (dense lower trapezoids, amalgamated where that
/// saves time), and every front is told where its original entries and the updates of its children go.
pub struct Symbolic<const B: usize> {
    pub(crate) num_blocks: usize,
    pub(crate) tree: AssemblyTree,
    pub(crate) fronts: Vec<Front>,
    /// Children of front `f`: `children[child_offsets[f]..child_offsets[f + 1]]`, ascending.
    child_offsets: Vec<usize>,
    children: Vec<u32>,
    entry_offsets: Vec<usize>,
    entries: Vec<Entry>,
    run_offsets: Vec<usize>,
    runs: Vec<Run>,
    factor_nonzeros: usize,
    panel_len: usize,
}

/// Shape and storage of one front; nodes are counted in nodes, storage in `f64`.
pub(crate) struct Front {
    /// Nodes eliminated.
    pub(crate) columns: usize,
    /// Nodes updated.
    pub(crate) rows: usize,
    /// First step of the front's columns.
    pub(crate) first_step: usize,
    /// Parent front or [`NONE`].
    pub(crate) parent: u32,
    /// First front of the subtree below (and with) this one.
    pub(crate) first_descendant: u32,
    /// Which of the two stacks receives this front's update matrix: parents and children take turns.
    pub(crate) stack: usize,
    /// Where on that stack, and how much of the other stack is taken by older siblings of ancestors.
    pub(crate) stack_offset: [usize; 2],
    /// How much of each stack the subtree uses beyond `stack_offset`, its own update matrix included.
    pub(crate) stack_needed: [usize; 2],
    /// Position of the panel in the factor's storage.
    pub(crate) panel_offset: usize,
    /// Leading dimension of the panel.
    pub(crate) panel_stride: usize,
    /// Leading dimension of the update matrix.
    pub(crate) update_stride: usize,
    /// Operations of this front alone.
    pub(crate) flops: f64,
}

impl Front {
    /// Entries of the panel's storage.
    pub(crate) fn panel_len<const B: usize>(&self) -> usize {
        self.panel_stride * self.columns * B
    }

    /// Entries of the update matrix's storage.
    pub(crate) fn update_len<const B: usize>(&self) -> usize {
        self.update_stride * self.rows * B
    }
}

/// An original block and its place in a front.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    /// Twice the position in the caller's values, plus one if the block is to be transposed.
    source: u32,
    /// Row within the front, in nodes.
    pub(crate) row: u32,
    /// Column within the front, in nodes.
    pub(crate) column: u32,
}

impl Entry {
    /// Position of the block in the caller's values.
    pub(crate) fn source(self) -> usize {
        (self.source >> 1) as usize
    }

    /// Whether the caller stores the transposed block.
    pub(crate) fn transposed(self) -> bool {
        self.source & 1 == 1
    }
}

/// Consecutive rows of an update matrix that are consecutive in the parent's front too.
#[derive(Clone, Copy)]
pub(crate) struct Run {
    /// First row in the child's update matrix, in nodes.
    pub(crate) source: u32,
    /// First row in the parent's front, in nodes.
    pub(crate) target: u32,
    /// Number of rows.
    pub(crate) length: u32,
}

impl<const B: usize> Symbolic<B> {
    /// Orders the node graph and plans the factorisation.
    ///
    /// # Errors
    /// [`FactorError::TooLarge`], [`FactorError::Analysis`], or [`FactorError::Length`] if positions are given for the
    /// wrong number of nodes.
    pub fn analyze(pattern: &BlockPattern, ordering: Ordering<'_>) -> Result<Self, FactorError> {
        let graph = pattern.adjacency()?;
        let order = order_nodes(pattern, &graph, ordering)?;
        let elimination = EliminationTree::new(&graph, &order);
        let tree = AssemblyTree::new(&graph, &elimination, B);
        let (child_offsets, children) = children(&tree);
        let (entry_offsets, entries) = place_entries(pattern, &tree);
        let (run_offsets, runs) = place_updates(&tree);
        let (fronts, panel_len) = lay_out::<B>(&tree, &child_offsets, &children);
        let factor_nonzeros = fronts
            .iter()
            .map(|front| {
                let (c, u) = (front.columns * B, front.rows * B);
                c * (c + 1) / 2 + c * u
            })
            .sum();
        Ok(Self {
            num_blocks: pattern.num_blocks(),
            tree,
            fronts,
            child_offsets,
            children,
            entry_offsets,
            entries,
            run_offsets,
            runs,
            factor_nonzeros,
            panel_len,
        })
    }

    /// Number of entries of the factor, explicit zeros of amalgamated fronts included.
    pub fn factor_nonzeros(&self) -> usize {
        self.factor_nonzeros
    }

    /// Floating-point operations (multiplications and additions) of one factorisation.
    pub fn flops(&self) -> f64 {
        self.fronts.iter().map(|front| front.flops).sum()
    }

    /// Estimated peak of the numeric phase on one thread, in bytes: factor, waiting update matrices and index lists.
    pub fn memory_bytes(&self) -> usize {
        let stacks: usize = self.stack_sizes().iter().sum();
        let index_lists = self.entries.len() * size_of::<Entry>()
            + self.runs.len() * size_of::<Run>()
            + self.tree.rows.len() * size_of::<u32>();
        (self.panel_len + stacks) * size_of::<f64>() + index_lists
    }

    /// Number of unknowns.
    pub(crate) fn num_unknowns(&self) -> usize {
        self.tree.order.len() * B
    }

    /// Entries of the storage of all panels.
    pub(crate) fn panel_len(&self) -> usize {
        self.panel_len
    }

    /// Sizes of the two stacks of update matrices when all fronts are computed one after another.
    pub(crate) fn stack_sizes(&self) -> [usize; 2] {
        let mut sizes = [0; 2];
        for front in self.fronts.iter().filter(|front| front.parent == NONE) {
            for (size, needed) in sizes.iter_mut().zip(front.stack_needed) {
                *size = (*size).max(needed);
            }
        }
        sizes
    }

    /// Children of a front, ascending.
    pub(crate) fn children(&self, front: usize) -> &[u32] {
        &self.children[self.child_offsets[front]..self.child_offsets[front + 1]]
    }

    /// Original blocks of a front.
    pub(crate) fn entries(&self, front: usize) -> &[Entry] {
        &self.entries[self.entry_offsets[front]..self.entry_offsets[front + 1]]
    }

    /// Where the update matrix of a front goes in its parent.
    pub(crate) fn runs(&self, front: usize) -> &[Run] {
        &self.runs[self.run_offsets[front]..self.run_offsets[front + 1]]
    }

    /// The caller's node at a position of a front.
    pub(crate) fn node_at(&self, front: usize, position: usize) -> usize {
        let shape = &self.fronts[front];
        let step = match position.checked_sub(shape.columns) {
            None => shape.first_step + position,
            Some(row) => self.tree.rows(front)[row] as usize,
        };
        self.tree.order[step] as usize
    }
}

fn children(tree: &AssemblyTree) -> (Vec<usize>, Vec<u32>) {
    let num_fronts = tree.num_fronts();
    let mut offsets = vec![0; num_fronts + 1];
    for &parent in tree.parent.iter().filter(|&&parent| parent != NONE) {
        offsets[parent as usize + 1] += 1;
    }
    for front in 0..num_fronts {
        offsets[front + 1] += offsets[front];
    }
    let mut next = offsets.clone();
    let mut children = vec![0; offsets[num_fronts]];
    for (front, &parent) in tree.parent.iter().enumerate() {
        if parent != NONE {
            children[next[parent as usize]] = front as u32;
            next[parent as usize] += 1;
        }
    }
    (offsets, children)
}

/// Sorts the original blocks by front and finds their places there.
fn place_entries(pattern: &BlockPattern, tree: &AssemblyTree) -> (Vec<usize>, Vec<Entry>) {
    let num_nodes = pattern.num_nodes();
    // Blocks by the step that eliminates them, rows given as steps.
    let mut offsets = vec![0usize; num_nodes + 1];
    for_each_block(pattern, tree, |_, _, column| {
        offsets[column as usize + 1] += 1;
    });
    for step in 0..num_nodes {
        offsets[step + 1] += offsets[step];
    }
    let mut next = offsets.clone();
    let unplaced = Entry { source: 0, row: 0, column: 0 };
    let mut entries = vec![unplaced; pattern.num_blocks()];
    for_each_block(pattern, tree, |source, row, column| {
        entries[next[column as usize]] = Entry { source, row, column };
        next[column as usize] += 1;
    });

    let mut entry_offsets = vec![0];
    let mut position = vec![0u32; num_nodes];
    for front in 0..tree.num_fronts() {
        let (first, end) = (tree.first_step[front], tree.first_step[front + 1]);
        for (row, k) in (first..end).chain(tree.rows(front).iter().copied()).zip(0u32..) {
            position[row as usize] = k;
        }
        let range = offsets[first as usize]..offsets[end as usize];
        entry_offsets.push(range.end);
        for entry in &mut entries[range] {
            entry.row = position[entry.row as usize];
            entry.column -= first;
        }
    }
    (entry_offsets, entries)
}

/// Calls `visit(source, row step, column step)` for every block of the lower triangle after reordering.
fn for_each_block(pattern: &BlockPattern, tree: &AssemblyTree, mut visit: impl FnMut(u32, u32, u32)) {
    let mut block = 0u32;
    for j in 0..pattern.num_nodes() {
        let step_j = tree.step[j];
        for &i in pattern.column(j) {
            let step_i = tree.step[i as usize];
            if step_i >= step_j {
                visit(2 * block, step_i, step_j);
            } else {
                visit(2 * block + 1, step_j, step_i);
            }
            block += 1;
        }
    }
}

/// Finds the runs by which update matrices are added into their parents.
fn place_updates(tree: &AssemblyTree) -> (Vec<usize>, Vec<Run>) {
    let mut run_offsets = vec![0];
    let mut runs: Vec<Run> = Vec::new();
    for front in 0..tree.num_fronts() {
        let start = runs.len();
        if tree.parent[front] != NONE {
            let parent = tree.parent[front] as usize;
            let (first, end) = (tree.first_step[parent], tree.first_step[parent + 1]);
            let parent_rows = tree.rows(parent);
            let columns = end - first;
            let mut cursor = 0;
            for (source, &row) in (0u32..).zip(tree.rows(front)) {
                let target = if row < end {
                    row - first
                } else {
                    while parent_rows[cursor] < row {
                        cursor += 1;
                    }
                    columns + cursor as u32
                };
                match runs[start..].last_mut() {
                    // A run never straddles the parent's panel and update matrix.
                    Some(run) if run.target + run.length == target && target != columns => {
                        run.length += 1;
                    }
                    _ => runs.push(Run { source, target, length: 1 }),
                }
            }
        }
        run_offsets.push(runs.len());
    }
    (run_offsets, runs)
}

/// Leading dimension for a number of rows: columns a multiple of 4 KiB apart would compete for the same cache sets.
fn stride(rows: usize) -> usize {
    if rows > 0 && rows.is_multiple_of(512) { rows + 8 } else { rows }
}

/// Assigns storage: panels one after another, update matrices on two alternating stacks.
///
/// A front's update matrix is written while those of its children are still being read. With one stack it would have
/// to be moved down afterwards; with two, a front writes on the one its children do not use, where everything above
/// its offset has been released.
fn lay_out<const B: usize>(tree: &AssemblyTree, child_offsets: &[usize], children: &[u32]) -> (Vec<Front>, usize) {
    let num_fronts = tree.num_fronts();
    let mut fronts: Vec<Front> = Vec::with_capacity(num_fronts);
    let mut panel_offset = 0;
    for f in 0..num_fronts {
        let columns = tree.num_columns(f);
        let rows = tree.rows(f).len();
        let (c, u) = (columns * B, rows * B);
        let front = Front {
            columns,
            rows,
            first_step: tree.first_step[f] as usize,
            parent: tree.parent[f],
            first_descendant: f as u32,
            stack: 0,
            stack_offset: [0; 2],
            stack_needed: [0; 2],
            panel_offset,
            panel_stride: stride(c + u),
            update_stride: stride(u),
            flops: (1..=c).map(|k| ((u + k) as f64).powi(2)).sum(),
        };
        panel_offset += front.panel_len::<B>();
        fronts.push(front);
    }
    for f in (0..num_fronts).rev() {
        if fronts[f].parent != NONE {
            fronts[f].stack = 1 - fronts[fronts[f].parent as usize].stack;
        }
    }
    // Bottom up: how much a subtree needs.
    for f in 0..num_fronts {
        let (own, other) = (fronts[f].stack, 1 - fronts[f].stack);
        let mut needed = [0; 2];
        let mut waiting = 0;
        for &child in &children[child_offsets[f]..child_offsets[f + 1]] {
            let child = &fronts[child as usize];
            needed[own] = needed[own].max(child.stack_needed[own]);
            needed[other] = needed[other].max(waiting + child.stack_needed[other]);
            waiting += child.update_len::<B>();
        }
        needed[own] = needed[own].max(fronts[f].update_len::<B>());
        fronts[f].stack_needed = needed;
        if let Some(&first) = children[child_offsets[f]..child_offsets[f + 1]].first() {
            fronts[f].first_descendant = fronts[first as usize].first_descendant;
        }
    }
    // Top down: where it starts.
    for f in (0..num_fronts).rev() {
        let other = 1 - fronts[f].stack;
        let mut offset = fronts[f].stack_offset;
        for &child in &children[child_offsets[f]..child_offsets[f + 1]] {
            fronts[child as usize].stack_offset = offset;
            offset[other] += fronts[child as usize].update_len::<B>();
        }
    }
    (fronts, panel_offset)
}
