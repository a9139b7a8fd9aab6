//! Contact models from outside.
//!
//! * [`derivatives`]: force and tangent against finite differences.
//! * [`obstacles`]: rigid obstacles and their motion.
//! * [`surfaces`]: self-contact, and surfaces that are slave and master in turn.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

mod derivatives;
mod obstacles;
mod support;
mod surfaces;
