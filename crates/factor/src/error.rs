//! What can go wrong while preparing or computing a factorisation.

/// Why a pattern, an analysis, a factorisation or a solve was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// The column offsets do not start at 0, decrease, or do not end at the number of rows given.
    #[error("column offsets of the block pattern are inconsistent at column {column}")]
    InvalidOffsets {
        /// First offending column.
        column: usize,
    },
    /// The rows of a column are not strictly ascending from the diagonal, or leave the matrix.
    #[error("column {column} of the block pattern must hold its diagonal and then ascending rows below {num_nodes}")]
    InvalidRows {
        /// First offending column.
        column: usize,
        /// Number of nodes of the pattern.
        num_nodes: usize,
    },
    /// The graph has more nodes or edges than the 32-bit orderings can index.
    #[error("the node graph is too large: {what} exceeds 32-bit indices")]
    TooLarge {
        /// The count that overflows.
        what: &'static str,
    },
    /// The fill-reducing ordering or the symbolic phase gave up.
    #[error("fill-reducing ordering or symbolic analysis failed: {0}")]
    Analysis(String),
    /// A slice given by the caller has the wrong length.
    #[error("{what}: expected {expected} entries, got {found}")]
    Length {
        /// Which argument.
        what: &'static str,
        /// Length required by the pattern.
        expected: usize,
        /// Length received.
        found: usize,
    },
    /// A pivot is zero, infinite or not a number: the matrix is singular (or so badly scaled that elimination without
    /// row exchanges breaks down).
    #[error("singular matrix: pivot {pivot:e} at node {node}, component {component}")]
    Pivot {
        /// Node of the pivot, in the caller's numbering.
        node: usize,
        /// Degree of freedom within the node.
        component: usize,
        /// The pivot itself.
        pivot: f64,
    },
    /// The system does not give the memory that the factor needs.
    #[error("not enough memory: the factor of the tangent needs another {:.1} GiB", *.bytes as f64 / 1_073_741_824.0)]
    OutOfMemory {
        /// Bytes asked for.
        bytes: usize,
    },
    /// A solve was asked for before any factorisation succeeded.
    #[error("no factorisation is available: factorize first")]
    NotFactorized,
}

/// Checks the length of an argument.
pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), FactorError> {
    if expected == found { Ok(()) } else { Err(FactorError::Length { what, expected, found }) }
}
