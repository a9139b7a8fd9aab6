//! Derived quantities and field output.
