//! What a factorisation reports, and how it may use the machine.

/// How many threads a call may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parallelism {
    /// The calling thread only.
    #[default]
    Serial,
    /// The current rayon pool.
    Threads,
}

/// The factorisation that succeeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// `L Lᵀ`: the matrix is positive definite.
    Cholesky,
    /// `L D Lᵀ` with a diagonal `D` and no row exchanges: at least one pivot was not positive.
    Ldl,
}

/// Signs of the pivots of a symmetric matrix (Sylvester's law of inertia: the number of negative pivots is the number
/// of negative eigenvalues).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inertia {
    /// Number of negative pivots; 0 means positive definite.
    pub negative: usize,
    /// The factorisation that produced the pivots.
    pub method: Method,
}
