//! Sparse symmetric direct solvers for node-blocked matrices.
