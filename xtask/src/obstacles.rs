//! `cargo xtask obstacles`: iterations where an obstacle moves to a body, and where the body's supports move to the obstacle.

use std::process::ExitCode;

use pneuflex_verification::moved_obstacle::{Comparison, difference, table};

/// An obstacle that moves may take this many times the iterations.
const MOST: f64 = 1.5;

/// Both solutions are one to this share of the largest displacement.
const SAME: f64 = 1e-6;

/// Prints the table; fails if an obstacle that moves takes too many iterations, or comes to another end.
pub fn run() -> ExitCode {
    println!("| shape | element | stiffness / default | size | obstacle moves | feet move | |");
    println!("|---|---|---|---|---|---|---|");
    let rows = table(&|row| println!("{}", line(row)));
    let misses = rows.iter().filter(|row| !fault(row).is_empty()).count();
    println!("{} of {} hold", rows.len() - misses, rows.len());
    if misses == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// A row as Markdown.
fn line(row: &Comparison) -> String {
    let Comparison { arch, ends } = row;
    let [moved, of_feet] =
        ends.each_ref().map(|end| end.as_ref().map_or_else(Clone::clone, |end| end.iterations.to_string()));
    let (shape, element, stiffness, size) = (arch.shape, arch.formulation, arch.stiffness, arch.length);
    format!("| {shape} | {element} | {stiffness} | {size} | {moved} | {of_feet} | {} |", fault(row))
}

/// What is not as it should be; empty if nothing is.
fn fault(row: &Comparison) -> String {
    let [Ok(moved), Ok(of_feet)] = &row.ends else { return "no end".to_owned() };
    let apart = difference(&moved.displacement, &of_feet.displacement);
    if moved.iterations as f64 > MOST * of_feet.iterations as f64 {
        "too many".to_owned()
    } else if apart > SAME {
        format!("another end: {apart:.1e}")
    } else {
        String::new()
    }
}
