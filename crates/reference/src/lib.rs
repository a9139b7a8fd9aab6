//! A naive dense solver that cross-checks the production path.
