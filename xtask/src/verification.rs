//! The verification suite: problems with known solutions, as a table.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use pneuflex_verification::{Effort, Row, run as solve, table};

/// Prints every row and writes `docs/verification.md`; with `quick`, the two coarsest meshes only, and nothing is written.
/// Fails if a row misses its bound and that is not a known limit.
pub fn run(quick: bool) -> ExitCode {
    let effort = if quick { Effort::Quick } else { Effort::Full };
    let sections = solve(effort, &|row| print!("{}", table::line(row)));
    let count = |of: fn(&Row) -> bool| sections.iter().flat_map(|s| &s.rows).filter(|row| of(row)).count();
    let (missed, faults) = (count(|row| !row.passes()), count(Row::is_fault));
    println!("{missed} rows miss their bounds, {faults} of them not by a known limit");
    if !quick {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/verification.md");
        if let Err(error) = fs::write(&file, table::markdown(&sections)) {
            eprintln!("{}: {error}", file.display());
            return ExitCode::FAILURE;
        }
    }
    if faults == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
