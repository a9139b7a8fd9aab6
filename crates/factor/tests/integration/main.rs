//! Factorisations of node-blocked matrices.
//!
//! * [`backends`]: one suite for every backend.
//! * [`pattern`]: the node graph and the matrix-vector product.
//! * [`threads`]: the number of threads changes nothing.

mod backends;
mod pattern;
mod threads;
