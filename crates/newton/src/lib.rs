//! Newton-Raphson with mixed linearisation, rotation-aware increments and load stepping.
