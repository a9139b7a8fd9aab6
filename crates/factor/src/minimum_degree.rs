//! Approximate minimum degree (Amestoy, Davis & Duff 1996, *SIAM J. Matrix Anal. Appl.* 17).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::error::FactorError;
use crate::pattern::BlockPattern;

/// Elimination order of the nodes by approximate minimum degree.
pub(crate) fn minimum_degree(pattern: &BlockPattern) -> Result<Vec<u32>, FactorError> {
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
