//! Meshes: shape functions, quadrature, named sets and the parametric actuator.
