//! `pneuflex design`: designs from targets.

use std::fmt::Write as _;
use std::io::Write as _;

use pneuflex::folder::DESIGNED;
use pneuflex_inverse::design::{DesignProblem, Designed, Held, Reached, Value};
use pneuflex_inverse::minimise::{Judged, TOLERANCE};

use crate::args::{SearchArguments, changes};
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::search::{ended, folder, line, number};
use crate::terminal::say;

/// Looks for a design, and prints it.
///
/// # Errors
/// Bad input, found before anything is solved or written; what cannot be written.
pub fn design(arguments: &SearchArguments) -> Result<Outcome, CliError> {
    let solve = &arguments.solve;
    solve.with.use_threads()?;
    let stop = interrupt::listen();
    let problem = DesignProblem::load(&arguments.file, &changes(&arguments.set)?, solve.memory_limit(), &stop)?;
    let path = folder(arguments, &problem.stem());
    let found = problem.run((&path, arguments.resume), &mut |progress| {
        if !solve.with.quiet {
            line(progress, &progress.step.judged.map(goodness).unwrap_or_default());
        }
    });
    let found = match found {
        Ok(found) => found,
        Err(error) => return ended(error, &path, &stop),
    };
    // Nobody reading on is no error.
    let _ = std::io::stdout().write_all(text(&found).as_bytes());
    // Said even when quiet where it is the reason for the exit code.
    if !(found.is_good() && solve.with.quiet) {
        say(&found.why_in_words());
    }
    if !solve.with.quiet {
        say(&format!("{} has all numbers, case.toml beside it the design", path.join(DESIGNED).display()));
    }
    Ok(if found.is_good() { Outcome::Converged } else { Outcome::NotConverged })
}

/// How good a design is, in words.
fn goodness(judged: &Judged) -> String {
    let mut words = Vec::new();
    if !judged.residuals.is_empty() {
        words.push(format!("targets missed by {} of what they may be", number(judged.residuals.norm())));
    }
    if judged.extreme != 0.0 {
        words.push(format!("extremes {}", number(judged.extreme)));
    }
    if judged.violation() > TOLERANCE {
        words.push(format!("a limit exceeded by {} %", number(100.0 * judged.violation())));
    }
    words.join(", ")
}

fn text(found: &Designed) -> String {
    let mut text = format!("{:<28} {:>12} {:>12}\n", "", "value", "start");
    for Value { name, value, start, is_at_bound } in &found.values {
        let bound = if *is_at_bound { "  at its bound" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<28} {:>12} {:>12}{bound}", number(*value), number(*start));
    }
    for (place, start) in found.starts.iter().enumerate().filter(|_| found.starts.len() > 1) {
        let mark = if start.is_best { ", the best" } else { "" };
        let _ = match start.objective {
            Some(objective) => writeln!(
                text,
                "start {}: objective {} after {} solutions{mark}",
                place + 1,
                number(objective),
                start.solutions
            ),
            None => writeln!(text, "start {}: no results", place + 1),
        };
    }
    for target in &found.targets {
        let Reached { name, wanted, off, within } = target;
        let _ = match wanted {
            Some(wanted) => writeln!(
                text,
                "{name}: {} for {}, within {}: {}",
                number(wanted + off),
                number(*wanted),
                number(*within),
                if target.is_met() { "met" } else { "missed" }
            ),
            None => writeln!(
                text,
                "{name}: {} mm off (root mean square), within {}: {}",
                number(*off),
                number(*within),
                if target.is_met() { "met" } else { "missed" }
            ),
        };
    }
    for (name, value) in &found.extremes {
        let _ = writeln!(text, "{name}: {}", number(*value));
    }
    for Held { name, value, holds, is_active } in &found.limits {
        let state = if !holds {
            "exceeded"
        } else if *is_active {
            "active"
        } else {
            "held"
        };
        let _ = writeln!(text, "{name}: {} ({state})", number(*value));
    }
    text
}
