//! The program as its users have it: commands, files, messages, exit codes.
//!
//! * [`bad_input`]: one clear message, and nothing written.
//! * [`case_files`], [`runs`], [`gradients`], [`converge`], [`rod`], [`fit`], [`tables`], [`view`]: the commands.
//! * [`sweeps`]: many designs, whatever dies; jobs of clusters.
//! * [`parts`]: parts from CAD, and what is found in meshes.
//! * [`models`], [`obstacles`]: what stands in model files, decks and case files.
//! * [`interrupted`]: runs that are killed, interrupted, robbed of their folder or started twice.
//! * [`terminal`]: what is printed on a terminal.
//! * [`guide`], [`manual`]: what is written about the program is true.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod case_files;
mod comparisons;
mod converge;
mod exports;
mod fit;
mod gradients;
mod guide;
mod interrupted;
mod manual;
mod models;
mod obstacles;
mod parts;
mod rod;
mod runs;
mod searches;
mod stops;
mod support;
mod sweeps;
mod tables;
#[cfg(target_os = "linux")]
mod terminal;
mod view;
