//! Fill-reducing orderings of the node graph.

use crate::error::{FactorError, check_length};
use crate::geometric::geometric_dissection;
use crate::minimum_degree::minimum_degree;
use crate::pattern::{Adjacency, BlockPattern};

/// How the nodes are renumbered before elimination.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Ordering<'a> {
    /// Multilevel nested dissection (Karypis & Kumar 1998): little fill on any three-dimensional mesh.
    #[default]
    NestedDissection,
    /// Nested dissection by planes through the given node positions: on meshes whose layers follow the coordinate
    /// axes, 8 times quicker to compute and 7–25 % less work than [`Ordering::NestedDissection`]; on bent or skewed
    /// meshes up to twice the work. Pass positions in which the mesh is straight (reference or lattice coordinates).
    Geometric(&'a [[f64; 3]]),
    /// Approximate minimum degree (Amestoy, Davis & Duff 1996): quicker to compute, 2–5 times the work on large
    /// three-dimensional meshes.
    Amd,
    /// The caller's numbering.
    Natural,
}

/// Elimination order of the nodes: `order[k]` is the caller's node eliminated in step `k`.
pub(crate) fn order_nodes(
    pattern: &BlockPattern,
    graph: &Adjacency,
    ordering: Ordering<'_>,
) -> Result<Vec<u32>, FactorError> {
    let n = pattern.num_nodes();
    match ordering {
        _ if n == 0 => Ok(Vec::new()),
        Ordering::Natural => Ok((0..n as u32).collect()),
        Ordering::Amd => minimum_degree(pattern),
        Ordering::NestedDissection => nested_dissection(graph, n),
        Ordering::Geometric(positions) => {
            check_length("positions", n, positions.len())?;
            geometric_dissection(graph, positions)
        }
    }
}

fn nested_dissection(graph: &Adjacency, num_nodes: usize) -> Result<Vec<u32>, FactorError> {
    let (offsets, neighbours) = graph.as_parts();
    let graph = feral_metis::CscPattern::new(num_nodes, offsets, neighbours)
        .ok_or_else(|| FactorError::Analysis("malformed node graph".into()))?;
    let order = feral_metis::metis_order(&graph).map_err(|error| FactorError::Analysis(error.to_string()))?;
    Ok(order.into_iter().map(|node| node as u32).collect())
}
