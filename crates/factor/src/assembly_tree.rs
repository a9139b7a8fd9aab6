//! From columns to fronts: supernodes, their amalgamation and the order in which they are eliminated.

use crate::elimination::{EliminationTree, NONE};
use crate::pattern::Adjacency;

/// Groups of columns eliminated together ("fronts"), in an order where children precede their parent and subtrees are
/// contiguous. All sizes count nodes.
pub(crate) struct AssemblyTree {
    /// `order[k]` is the caller's node eliminated in step `k`.
    pub(crate) order: Vec<u32>,
    /// Inverse of `order`.
    pub(crate) step: Vec<u32>,
    /// Front `f` eliminates the steps `first_step[f]..first_step[f + 1]`.
    pub(crate) first_step: Vec<u32>,
    /// Parent front, larger than its children, or [`NONE`].
    pub(crate) parent: Vec<u32>,
    /// The steps front `f` updates, ascending: `rows[row_offsets[f]..row_offsets[f + 1]]`.
    pub(crate) row_offsets: Vec<usize>,
    /// See `row_offsets`.
    pub(crate) rows: Vec<u32>,
}

impl AssemblyTree {
    /// Groups the columns of `tree`; `block` is the number of unknowns per node.
    pub(crate) fn new(graph: &Adjacency, tree: &EliminationTree, block: usize) -> Self {
        let mut groups = Groups::fundamental(tree);
        groups.amalgamate(&CostModel::new(block));
        groups.into_tree(graph, tree)
    }

    /// Number of fronts.
    pub(crate) fn num_fronts(&self) -> usize {
        self.parent.len()
    }

    /// Number of columns front `f` eliminates.
    pub(crate) fn num_columns(&self, f: usize) -> usize {
        (self.first_step[f + 1] - self.first_step[f]) as usize
    }

    /// The steps front `f` updates.
    pub(crate) fn rows(&self, f: usize) -> &[u32] {
        &self.rows[self.row_offsets[f]..self.row_offsets[f + 1]]
    }
}

/// Predicted time of a front, to decide which fronts are better merged. Units: nanoseconds on a core of 2023.
struct CostModel {
    block: f64,
}

impl CostModel {
    /// Work at the rate of matrix products.
    const PER_FLOP: f64 = 1.0 / 40.0;
    /// Elimination of a column of pivots, per row: slow kernels of small blocks.
    const PER_PIVOT_ENTRY: f64 = 0.35;
    /// Adding one entry of a child's update matrix into its parent.
    const PER_UPDATE_ENTRY: f64 = 0.6;
    /// Fixed cost.
    const PER_FRONT: f64 = 3000.0;

    fn new(block: usize) -> Self {
        Self { block: block as f64 }
    }

    /// `columns` eliminated and `rows` updated nodes.
    fn time(&self, columns: u64, rows: u64) -> f64 {
        let c = columns as f64 * self.block;
        let u = rows as f64 * self.block;
        let m = c + u;
        let flops = (m * m * m - u * u * u) / 3.0;
        let update_entries = 0.5 * u * u;
        Self::PER_FRONT
            + Self::PER_FLOP * flops
            + Self::PER_PIVOT_ENTRY * m * c
            + Self::PER_UPDATE_ENTRY * update_entries
    }
}

/// A forest of column groups under construction.
struct Groups {
    /// Members of each group, ascending labels; empty once merged into the parent.
    columns: Vec<Vec<u32>>,
    num_rows: Vec<u64>,
    parent: Vec<u32>,
}

impl Groups {
    /// Maximal runs of consecutive labels whose columns have the same rows below.
    fn fundamental(tree: &EliminationTree) -> Self {
        let n = tree.order.len();
        let mut columns: Vec<Vec<u32>> = Vec::new();
        let mut num_rows = Vec::new();
        let mut group_of = vec![0u32; n];
        for j in 0..n {
            let continues = j > 0 && tree.parent[j - 1] == j as u32 && tree.counts[j - 1] == tree.counts[j] + 1;
            match columns.last_mut() {
                Some(last) if continues => {
                    last.push(j as u32);
                }
                _ => {
                    columns.push(vec![j as u32]);
                    num_rows.push(0);
                }
            }
            let group = columns.len() - 1;
            group_of[j] = group as u32;
            num_rows[group] = u64::from(tree.counts[j]) - 1;
        }
        let parent = columns
            .iter()
            .map(|members| match members.last() {
                Some(&last) if tree.parent[last as usize] != NONE => group_of[tree.parent[last as usize] as usize],
                _ => NONE,
            })
            .collect();
        Self { columns, num_rows, parent }
    }

    /// Merges children into their parents wherever the model says the larger front is quicker than the two
    /// (explicit zeros against fixed costs, small kernels and update traffic: relaxed supernodes of Ashcraft & Grimes
    /// 1989, with a predicted time in place of a fraction of zeros).
    fn amalgamate(&mut self, cost: &CostModel) {
        let num_groups = self.columns.len();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); num_groups];
        for group in 0..num_groups {
            if self.parent[group] != NONE {
                children[self.parent[group] as usize].push(group as u32);
            }
        }
        for parent in 0..num_groups {
            let mut candidates = std::mem::take(&mut children[parent]);
            // Large update matrices first: they resemble the parent most.
            candidates.sort_by_key(|&child| std::cmp::Reverse(self.num_rows[child as usize]));
            let rows = self.num_rows[parent];
            let mut merged_children = Vec::new();
            for child in candidates {
                let c = child as usize;
                let separate = cost.time(self.columns[c].len() as u64, self.num_rows[c])
                    + cost.time(self.columns[parent].len() as u64, rows);
                let together = cost.time((self.columns[c].len() + self.columns[parent].len()) as u64, rows);
                if together <= separate {
                    let mut columns = std::mem::take(&mut self.columns[c]);
                    columns.append(&mut self.columns[parent]);
                    self.columns[parent] = columns;
                    for &grandchild in &children[c] {
                        self.parent[grandchild as usize] = parent as u32;
                    }
                    merged_children.append(&mut children[c]);
                } else {
                    merged_children.push(child);
                }
            }
            children[parent] = merged_children;
        }
    }

    /// Orders the groups, renumbers the nodes accordingly and computes the rows of every front.
    fn into_tree(mut self, graph: &Adjacency, tree: &EliminationTree) -> AssemblyTree {
        let sequence = self.sequence();
        let mut front_of_group = vec![NONE; self.columns.len()];
        for (front, &group) in sequence.iter().enumerate() {
            front_of_group[group as usize] = front as u32;
        }
        let parent: Vec<u32> = sequence
            .iter()
            .map(|&group| match self.parent[group as usize] {
                NONE => NONE,
                parent => front_of_group[parent as usize],
            })
            .collect();

        let n = tree.order.len();
        let mut order = Vec::with_capacity(n);
        let mut first_step = vec![0u32];
        for &group in &sequence {
            let members = &mut self.columns[group as usize];
            // The caller's numbering usually follows the geometry: neighbours stay together when updates are added.
            let mut nodes: Vec<u32> = members.iter().map(|&k| tree.order[k as usize]).collect();
            nodes.sort_unstable();
            order.append(&mut nodes);
            first_step.push(order.len() as u32);
        }
        let mut step = vec![0u32; n];
        for (k, &node) in order.iter().enumerate() {
            step[node as usize] = k as u32;
        }
        let (row_offsets, rows) = front_rows(graph, &order, &step, &first_step, &parent);
        AssemblyTree { order, step, first_step, parent, row_offsets, rows }
    }

    /// Surviving groups in postorder, siblings in the order that keeps the fewest update matrices waiting (Liu 1986:
    /// by descending difference between the memory a subtree needs and what it leaves behind).
    fn sequence(&self) -> Vec<u32> {
        let num_groups = self.columns.len();
        let alive = |group: usize| !self.columns[group].is_empty();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); num_groups];
        let mut roots = Vec::new();
        let mut peak = vec![0u64; num_groups];
        let update = |group: usize| self.num_rows[group] * self.num_rows[group];
        for group in (0..num_groups).filter(|&group| alive(group)) {
            let own_children = &mut children[group];
            own_children.sort_by_key(|&child| {
                let child = child as usize;
                (std::cmp::Reverse(peak[child].saturating_sub(update(child))), child)
            });
            let mut waiting = 0;
            let mut needed = 0;
            for &child in own_children.iter() {
                needed = needed.max(waiting + peak[child as usize]);
                waiting += update(child as usize);
            }
            peak[group] = needed.max(waiting + update(group));
            match self.parent[group] {
                NONE => roots.push(group as u32),
                parent => children[parent as usize].push(group as u32),
            }
        }
        // Depth first, children after their parent and from last to first; reversed, that is the postorder wanted.
        let mut sequence = Vec::new();
        let mut pending = roots;
        while let Some(group) = pending.pop() {
            sequence.push(group);
            pending.extend(&children[group as usize]);
        }
        sequence.reverse();
        sequence
    }
}

/// Rows below the columns of every front: those of its own columns and those its children pass on.
fn front_rows(
    graph: &Adjacency,
    order: &[u32],
    step: &[u32],
    first_step: &[u32],
    parent: &[u32],
) -> (Vec<usize>, Vec<u32>) {
    let num_fronts = parent.len();
    let mut child_offsets = vec![0usize; num_fronts + 1];
    for &p in parent.iter().filter(|&&p| p != NONE) {
        child_offsets[p as usize + 1] += 1;
    }
    for front in 0..num_fronts {
        child_offsets[front + 1] += child_offsets[front];
    }
    let mut children = vec![0u32; child_offsets[num_fronts]];
    let mut next = child_offsets.clone();
    for (front, &p) in parent.iter().enumerate() {
        if p != NONE {
            children[next[p as usize]] = front as u32;
            next[p as usize] += 1;
        }
    }

    let mut row_offsets = vec![0usize];
    let mut rows: Vec<u32> = Vec::new();
    let mut seen_by = vec![NONE; order.len()];
    for front in 0..num_fronts {
        let start = rows.len();
        let end_step = first_step[front + 1];
        let mut add = |rows: &mut Vec<u32>, row: u32| {
            if row >= end_step && seen_by[row as usize] != front as u32 {
                seen_by[row as usize] = front as u32;
                rows.push(row);
            }
        };
        for k in first_step[front]..end_step {
            for &neighbour in graph.neighbours(order[k as usize]) {
                add(&mut rows, step[neighbour as usize]);
            }
        }
        for &child in &children[child_offsets[front]..child_offsets[front + 1]] {
            for position in row_offsets[child as usize]..row_offsets[child as usize + 1] {
                let row = rows[position];
                add(&mut rows, row);
            }
        }
        rows[start..].sort_unstable();
        row_offsets.push(rows.len());
    }
    (row_offsets, rows)
}
