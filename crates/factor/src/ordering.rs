//! Fill-reducing orderings of the node graph.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::error::FactorError;
use crate::pattern::BlockPattern;

/// How the nodes are renumbered before elimination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ordering {
    /// Multilevel nested dissection (Karypis & Kumar 1998): the least fill on three-dimensional meshes.
    #[default]
    NestedDissection,
    /// Approximate minimum degree (Amestoy, Davis & Duff 1996): quicker to compute, 2–4 times the work on large
    /// three-dimensional meshes.
    Amd,
    /// The caller's numbering.
    Natural,
}

/// Elimination order of the nodes: `order[k]` is the caller's node eliminated in step `k`.
pub(crate) fn order_nodes(pattern: &BlockPattern, ordering: Ordering) -> Result<Vec<u32>, FactorError> {
    let n = pattern.num_nodes();
    match ordering {
        _ if n == 0 => Ok(Vec::new()),
        Ordering::Natural => Ok((0..n as u32).collect()),
        Ordering::Amd => minimum_degree(pattern),
        Ordering::NestedDissection => nested_dissection(pattern),
    }
}

fn minimum_degree(pattern: &BlockPattern) -> Result<Vec<u32>, FactorError> {
    let n = pattern.num_nodes();
    let offsets: Vec<usize> = pattern.column_offsets().to_vec();
    let rows: Vec<usize> = (0..n).flat_map(|j| pattern.column(j).iter().map(|&i| i as usize)).collect();
    let graph = SymbolicSparseColMatRef::new_checked(n, n, &offsets, None, &rows);
    let mut order = vec![0usize; n];
    let mut position = vec![0usize; n];
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, rows.len()));
    amd::order_maybe_unsorted(&mut order, &mut position, graph, amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|error| FactorError::Analysis(error.to_string()))?;
    Ok(order.into_iter().map(|node| node as u32).collect())
}

fn nested_dissection(pattern: &BlockPattern) -> Result<Vec<u32>, FactorError> {
    let adjacency = pattern.adjacency()?;
    let (offsets, neighbours) = adjacency.as_parts();
    let graph = feral_metis::CscPattern::new(pattern.num_nodes(), offsets, neighbours)
        .ok_or_else(|| FactorError::Analysis("malformed node graph".into()))?;
    let order = feral_metis::metis_order(&graph).map_err(|error| FactorError::Analysis(error.to_string()))?;
    Ok(order.into_iter().map(|node| node as u32).collect())
}
