//! Element kernels and deterministic parallel assembly.
