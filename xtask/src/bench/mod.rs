//! `cargo xtask bench`: time and memory of whole cases, measured on the real program.
//!
//! * [`arguments`], [`plan`]: which cases.
//! * [`process`], [`runner`]: one process, measured; what the program says about it.
//! * [`fit`], [`table`]: what comes out.
//! * [`calculix`], [`comparison`]: the same mesh in CalculiX, if it is installed.

mod arguments;
mod calculix;
mod comparison;
mod fit;
mod plan;
mod process;
mod runner;
mod table;

use std::path::Path;
use std::process::ExitCode;

use serde::Serialize;

use arguments::Arguments;
use comparison::Comparison;
use runner::{Row, Runner};
use table::Growth;

/// All numbers, for `--out`.
#[derive(Debug, Serialize)]
struct Report {
    rows: Vec<Row>,
    growth: Vec<Growth>,
    /// Left out without CalculiX.
    #[serde(skip_serializing_if = "Option::is_none")]
    calculix: Option<Vec<Comparison>>,
}

/// Measures and prints. Exit code 0, 1 if something could not be measured or a case did not converge, 2 for arguments that
/// make no sense.
pub fn run(words: &[String]) -> ExitCode {
    let arguments = match Arguments::read(words) {
        Ok(arguments) => arguments,
        Err(text) => {
            eprintln!("bench: {text}");
            return ExitCode::from(2);
        }
    };
    match bench(&arguments) {
        Ok(report) if report.rows.iter().all(|row| row.converged) => ExitCode::SUCCESS,
        Ok(_) => {
            eprintln!("bench: a case did not converge");
            ExitCode::FAILURE
        }
        Err(text) => {
            eprintln!("bench: {text}");
            ExitCode::FAILURE
        }
    }
}

fn bench(arguments: &Arguments) -> Result<Report, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().map_err(|e| e.to_string())?;
    let program = crate::program::build(&root)?;
    let runner = Runner::new(program, &root, &crate::program::target_folder(&root).join("bench"));
    let runs = plan::runs(arguments);
    let mut rows = Vec::new();
    for (number, run) in (1..).zip(&runs) {
        eprintln!("[{number}/{}] {}", runs.len(), run.name());
        let row = runner.measure(run)?;
        eprintln!("    {:.1} s", row.process_s);
        rows.push(row);
    }
    print!("{}", table::rows(&rows));
    let growth = table::growth(&rows);
    print!("{}", table::growth_text(&growth));
    let calculix = match comparison::find() {
        None => {
            println!("\nCalculiX (ccx) is not on PATH: no comparison.");
            None
        }
        Some(ccx) => {
            let comparisons = comparison::compare(&ccx, &runner, arguments.is_quick)?;
            print!("{}", comparison::text(&comparisons));
            Some(comparisons)
        }
    };
    let report = Report { rows, growth, calculix };
    if let Some(path) = &arguments.out {
        let text = serde_json::to_string_pretty(&report).map_err(|e| e.to_string())?;
        std::fs::write(path, text + "\n").map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(report)
}
