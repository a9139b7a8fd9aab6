//! The production path against the reference solver and against itself; closed forms are in `pneuflex-verification`.
//!
//! * [`cross_check`]: element, contribution, global residual and tangent, one Newton step, load path (theory §16).
//! * [`cross_check_loads`]: load paths with every load, constraint, obstacle and contact law that the reference has.
//! * [`snapshots`]: what the two standard cases come out at, production and reference alike.
//! * [`balance`]: what must hold whatever the numbers are: resultants, work, symmetry, threads, failures.
//! * [`resume`]: a path that goes on from a checkpoint is the path that never ended.
//! * [`obstacles`]: rigid obstacles, and contact without penetration.
//! * [`arc_length`]: past limit points; [`buckling`]: beyond bifurcations.
//! * [`neighbour`]: guesses from the path of a similar problem.
//! * [`held_by_contact`]: bodies without supports.
//! * [`interference`]: overlaps at rest that are pressed out.
//! * [`units`]: other units of length and force.
//! * [`penetration`]: what the two contact variants let through.

// Helpers count as tests here.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod arc_length;
mod balance;
mod buckling;
mod cross_check;
mod cross_check_loads;
mod fixtures;
mod held_by_contact;
mod interference;
mod loads;
mod neighbour;
mod obstacles;
mod penetration;
mod resume;
mod snap;
mod snapshots;
mod units;
