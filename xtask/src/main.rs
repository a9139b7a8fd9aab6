//! Repository tasks, run as `cargo xtask TASK`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod tidy;
mod validate;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask TASK

tasks:
  tidy      check the rules of this repository: arrows between crates, docs
  validate  the paper's figures and statements by the real program, as a report in target/validation
            [--quick] [--measured FILE.csv] [--docs]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("validate") => validate::run(&arguments[1..]),
        Some("tidy") if arguments.len() == 1 => tidy::run(),
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
    }
}
