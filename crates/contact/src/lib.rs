//! Frictionless penalty contact between facing surfaces.
