//! The node graph of a symmetric matrix, and the product of such a matrix with a vector.

use crate::error::{FactorError, check_length};

/// Lower triangle (row ≥ column, in the caller's node numbering) of a symmetric node graph, compressed by columns.
///
/// Every column starts with its diagonal and continues with strictly ascending rows. A matrix on this pattern stores
/// `B × B` values per block, column-major inside the block, in the order of [`BlockPattern::column`]; diagonal blocks
/// are stored in full, an off-diagonal block `(i, j)`, `i > j`, holds `K[dofs of i, dofs of j]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockPattern {
    column_offsets: Vec<usize>,
    rows: Vec<u32>,
}

impl BlockPattern {
    /// Checks and wraps a compressed lower triangle.
    ///
    /// # Errors
    /// [`FactorError::InvalidOffsets`], [`FactorError::InvalidRows`] or [`FactorError::TooLarge`] name the first
    /// column that breaks the layout.
    pub fn new(column_offsets: Vec<usize>, rows: Vec<u32>) -> Result<Self, FactorError> {
        if column_offsets.first() != Some(&0) {
            return Err(FactorError::InvalidOffsets { column: 0 });
        }
        let num_nodes = column_offsets.len() - 1;
        if i32::try_from(num_nodes).is_err() {
            return Err(FactorError::TooLarge { what: "number of nodes" });
        }
        for column in 0..num_nodes {
            let range = column_offsets[column]..column_offsets[column + 1];
            let Some(column_rows) = rows.get(range) else {
                return Err(FactorError::InvalidOffsets { column });
            };
            let starts_at_diagonal = column_rows.first().is_some_and(|&row| row as usize == column);
            let ascending = column_rows.windows(2).all(|pair| pair[0] < pair[1]);
            let inside = column_rows.last().is_some_and(|&row| (row as usize) < num_nodes);
            if !(starts_at_diagonal && ascending && inside) {
                return Err(FactorError::InvalidRows { column, num_nodes });
            }
        }
        if column_offsets[num_nodes] != rows.len() {
            return Err(FactorError::InvalidOffsets { column: num_nodes });
        }
        Ok(Self { column_offsets, rows })
    }

    /// The pattern in which every clique (the nodes of an element, of a contact pair, …) couples all its nodes.
    ///
    /// Repeated nodes within a clique are harmless; nodes without a clique keep their diagonal block.
    ///
    /// # Panics
    /// If a clique names a node that is not below `num_nodes`, or if `num_nodes` does not fit 31 bits.
    pub fn from_cliques<'a>(num_nodes: usize, cliques: impl Iterator<Item = &'a [u32]>) -> Self {
        assert!(i32::try_from(num_nodes).is_ok(), "{num_nodes} nodes exceed 31 bits");
        let mut clique_offsets = vec![0];
        let mut clique_nodes = Vec::new();
        let mut incidence_offsets = vec![0; num_nodes + 1];
        for clique in cliques {
            for &node in clique {
                incidence_offsets[node as usize + 1] += 1;
            }
            clique_nodes.extend_from_slice(clique);
            clique_offsets.push(clique_nodes.len());
        }
        for node in 0..num_nodes {
            incidence_offsets[node + 1] += incidence_offsets[node];
        }
        let mut incidence = vec![0; clique_nodes.len()];
        let mut next = incidence_offsets.clone();
        for clique in 0..clique_offsets.len() - 1 {
            for &node in &clique_nodes[clique_offsets[clique]..clique_offsets[clique + 1]] {
                incidence[next[node as usize]] = clique;
                next[node as usize] += 1;
            }
        }

        let mut column_offsets = Vec::with_capacity(num_nodes + 1);
        column_offsets.push(0);
        let mut rows = Vec::new();
        let mut last_seen_by = vec![usize::MAX; num_nodes];
        for column in 0..num_nodes {
            let start = rows.len();
            rows.push(column as u32);
            last_seen_by[column] = column;
            for &clique in &incidence[incidence_offsets[column]..incidence_offsets[column + 1]] {
                for &row in &clique_nodes[clique_offsets[clique]..clique_offsets[clique + 1]] {
                    if row as usize > column && last_seen_by[row as usize] != column {
                        last_seen_by[row as usize] = column;
                        rows.push(row);
                    }
                }
            }
            rows[start..].sort_unstable();
            column_offsets.push(rows.len());
        }
        Self { column_offsets, rows }
    }

    /// Number of nodes (block rows).
    pub fn num_nodes(&self) -> usize {
        self.column_offsets.len() - 1
    }

    /// Number of stored blocks, diagonal included.
    pub fn num_blocks(&self) -> usize {
        self.rows.len()
    }

    /// Rows of column `j`, ascending, the diagonal first.
    ///
    /// # Panics
    /// If `j` is not below [`BlockPattern::num_nodes`].
    pub fn column(&self, j: usize) -> &[u32] {
        &self.rows[self.column_offsets[j]..self.column_offsets[j + 1]]
    }

    /// Position of the first block of each column, and one past the last block: `num_nodes + 1` numbers.
    pub fn column_offsets(&self) -> &[usize] {
        &self.column_offsets
    }

    /// Position of block `(row, col)` in the value storage; `None` when it is not stored (or `row < col`).
    pub fn position(&self, row: usize, col: usize) -> Option<usize> {
        let start = *self.column_offsets.get(col)?;
        let end = *self.column_offsets.get(col + 1)?;
        let row = u32::try_from(row).ok()?;
        let offset = self.rows[start..end].binary_search(&row).ok()?;
        Some(start + offset)
    }

    /// The whole graph without its diagonal, both triangles, compressed by nodes with ascending neighbours.
    pub(crate) fn adjacency(&self) -> Result<Adjacency, FactorError> {
        let n = self.num_nodes();
        let num_directed = 2 * (self.num_blocks() - n);
        if i32::try_from(num_directed).is_err() {
            return Err(FactorError::TooLarge { what: "number of edges" });
        }
        let mut offsets = vec![0i32; n + 1];
        for j in 0..n {
            let below = &self.column(j)[1..];
            offsets[j + 1] += below.len() as i32;
            for &i in below {
                offsets[i as usize + 1] += 1;
            }
        }
        for j in 0..n {
            offsets[j + 1] += offsets[j];
        }
        let mut neighbours = vec![0i32; num_directed];
        let mut next = offsets.clone();
        // A node's smaller neighbours arrive while their columns are visited, in ascending order and before the node's
        // own column appends the larger ones: each list ends up sorted.
        for j in 0..n {
            for &i in &self.column(j)[1..] {
                neighbours[next[i as usize] as usize] = j as i32;
                next[i as usize] += 1;
                neighbours[next[j] as usize] = i as i32;
                next[j] += 1;
            }
        }
        Ok(Adjacency { offsets, neighbours })
    }
}

/// Both triangles of a node graph, without the diagonal (32-bit, as the orderings want it).
pub(crate) struct Adjacency {
    offsets: Vec<i32>,
    neighbours: Vec<i32>,
}

impl Adjacency {
    /// Ascending neighbours of a node.
    pub(crate) fn neighbours(&self, node: u32) -> &[i32] {
        let node = node as usize;
        &self.neighbours[self.offsets[node] as usize..self.offsets[node + 1] as usize]
    }

    /// The two compressed arrays: offsets and neighbours.
    pub(crate) fn as_parts(&self) -> (&[i32], &[i32]) {
        (&self.offsets, &self.neighbours)
    }
}

/// `y = K x` for a symmetric matrix stored as `B × B` blocks on `pattern`.
///
/// `values` has `B·B·num_blocks` entries, `x` and `y` have `B·num_nodes`. No degree of freedom is treated as held.
///
/// # Errors
/// [`FactorError::Length`] when a slice does not fit the pattern.
pub fn multiply<const B: usize>(
    pattern: &BlockPattern,
    values: &[f64],
    x: &[f64],
    y: &mut [f64],
) -> Result<(), FactorError> {
    let n = pattern.num_nodes();
    check_length("values", pattern.num_blocks() * B * B, values.len())?;
    check_length("x", n * B, x.len())?;
    check_length("y", n * B, y.len())?;
    let (x, _) = x.as_chunks::<B>();
    let (y, _) = y.as_chunks_mut::<B>();
    y.fill([0.0; B]);
    let mut blocks = values.chunks_exact(B * B);
    for j in 0..n {
        let mut column_sum = [0.0; B];
        for &i in pattern.column(j) {
            let i = i as usize;
            let Some(block) = blocks.next() else { break };
            for c in 0..B {
                for r in 0..B {
                    y[i][r] += block[c * B + r] * x[j][c];
                }
            }
            if i != j {
                for c in 0..B {
                    for r in 0..B {
                        column_sum[c] += block[c * B + r] * x[i][r];
                    }
                }
            }
        }
        for c in 0..B {
            y[j][c] += column_sum[c];
        }
    }
    Ok(())
}
