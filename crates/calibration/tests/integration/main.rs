//! From the file of a test to constants.
//!
//! * [`choice`]: which law is recommended.
//! * [`curves`]: layouts of files, and what is refused.
//! * [`fits`]: fits with known answers.
//! * [`fuzz`]: files that may hold anything.
//! * [`intervals`]: how often intervals of confidence have the truth in them.
//! * [`traps`]: what people write and miswrite.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

mod choice;
mod curves;
mod fits;
mod fuzz;
mod traps;
