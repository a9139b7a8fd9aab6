//! Repository tasks, run as `cargo xtask TASK`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod accuracy;
mod bench;
mod cases;
mod corpus;
mod coverage;
mod decks;
mod estimates;
mod fuzz;
mod gradients;
mod identify;
mod kills;
mod obstacles;
mod pictures;
mod program;
mod record;
mod relations;
mod report_test;
mod tidy;
mod validate;
mod verification;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask TASK

tasks:
  accuracy  errors of the headline quantities on the program's meshes, by kind of design, as a table; fails if one is larger than
            what the program says and it does not warn
            [--quick] [--docs] [--only PART OF A NAME]
  bench     time and memory of whole cases by the real program, as a table; beside CalculiX if it is installed
            [--quick] [--full] [--chambers LIST] [--resolutions LIST] [--out FILE.json]
  cases     small inputs that were once answered wrongly: each must have its right value; advice is tried: it must help
  corpus    random designs, or with `--contact` random obstacles, by the real program: how many converge or end for a
            physical reason; fails below 98 %
            [--count N] [--seed S] [--only NUMBERS] [--cases FOLDER] [--limit SECONDS] [--jobs N]
  coverage  how often 95 % intervals of fits cover the constants that simulated curves were made of; fails outside of 90 to 99 %
            [--draws N]
  decks     how many input decks of a folder run, and which keywords stop the rest
            FOLDER [--limit SECONDS]
  estimates what `output.error_estimate` says of random designs, against the errors that a finer mesh shows, as a table
            [--count N] [--seed S] [--jobs N] [--docs]
  fuzz      damaged inputs of every reader, in this process: none may panic or take long; writes those that do into target/fuzz
            [--draws N] [--seed S] [--docs]
  gradients exact derivatives of results against differences of whole runs, as a table; fails where they are apart
  identify  lengths and constants from the shapes that they give, and how often 95 % intervals cover them where there is noise
            [--draws N] [--only recovery|coverage]
  kills     random problems by the real program, killed twice at random moments and gone on with: each must end as if nothing had been
            [--draws N] [--seed S] [--docs]
  obstacles iterations where an obstacle moves and where supports do, by shape, element, stiffness and size
  pictures  reports of six runs from top to bottom, on desk and phone, light and dark, to be looked at, in target/pictures; and the
            guide's mould
            [--docs]
  relations random problems, each written in two ways that must have one solution: case and model, half and whole, mm and m,
            turned, split, resumed, ...; fails if one has two, and writes it into target/relations;
            --docs of this and of fuzz and kills writes what was found into docs/relations.md
            [--quick] [--draws N] [--seed S] [--from NUMBER] [--only PART OF A NAME] [--docs]
  report-test [--all] [RESULT_DIR]
            open the report of a run in Chromium and use it: clicks, slider, colours, sections; pictures of it in
            target/report-test
  tidy      check the rules of this repository: arrows between crates, docs
  validate  the paper's figures and statements by the real program, as a report in target/validation
            [--quick] [--measured FILE.csv] [--docs]
  verification [--quick]
            solve problems with known solutions and write docs/verification.md; fails if a row misses its bound
            and that is not a known limit";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let rest: Vec<&str> = arguments.iter().skip(1).map(String::as_str).collect();
    match arguments.first().map(String::as_str) {
        Some("accuracy") => accuracy::run(&arguments[1..]),
        Some("bench") => bench::run(&arguments[1..]),
        Some("cases") if rest.is_empty() => cases::run(),
        Some("corpus") => corpus::run(&arguments[1..]),
        Some("coverage") => coverage::run(&arguments[1..]),
        Some("decks") => decks::run(&arguments[1..]),
        Some("estimates") => estimates::run(&arguments[1..]),
        Some("fuzz") => fuzz::run(&arguments[1..]),
        Some("gradients") if rest.is_empty() => gradients::run(),
        Some("identify") => identify::run(&arguments[1..]),
        Some("kills") => kills::run(&arguments[1..]),
        Some("obstacles") if rest.is_empty() => obstacles::run(),
        Some("pictures") => pictures::run(&arguments[1..]),
        Some("relations") => relations::run(&arguments[1..]),
        Some("report-test") => report_test::run(&arguments[1..]),
        Some("validate") => validate::run(&arguments[1..]),
        Some("verification") if rest.is_empty() => verification::run(false),
        Some("verification") if rest == ["--quick"] => verification::run(true),
        Some("tidy") if arguments.len() == 1 => tidy::run(),
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
    }
}
