//! Repository tasks, run as `cargo xtask TASK`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod pictures;
mod tidy;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask TASK

tasks:
  tidy      check the rules of this repository: arrows between crates, docs
  pictures  solve the fixtures at 35 kPa and draw the pictures of README.md into docs/";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("pictures") if arguments.len() == 1 => pictures::run(),
        Some("tidy") if arguments.len() == 1 => tidy::run(),
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
    }
}
