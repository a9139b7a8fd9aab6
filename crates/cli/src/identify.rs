//! `pneuflex identify`: constants and lengths from measurements.

use std::fmt::Write as _;
use std::io::Write as _;

use pneuflex::folder::IDENTIFIED;
use pneuflex_inverse::identify::{Identification, Identified, Value};
use pneuflex_inverse::minimise::Why;

use crate::args::{SearchArguments, changes};
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::search::{ended, folder, line, number};
use crate::terminal::say;

/// Correlations from this on are said.
const CORRELATED: f64 = 0.9;

/// Identifies, and prints the values with their intervals.
///
/// # Errors
/// Bad input, found before anything is solved or written; what cannot be written.
pub fn identify(arguments: &SearchArguments) -> Result<Outcome, CliError> {
    let solve = &arguments.solve;
    solve.with.use_threads()?;
    let stop = interrupt::listen();
    let identification = Identification::load(&arguments.file, &changes(&arguments.set)?, solve.memory_limit(), &stop)?;
    let path = folder(arguments, &identification.stem());
    let found = identification.run((&path, arguments.resume), &mut |progress| {
        if !solve.with.quiet {
            let misfit = progress.step.judged.map(|judged| {
                let residuals = &judged.residuals;
                format!("misfit {}", number((residuals.norm_squared() / residuals.len() as f64).sqrt()))
            });
            line(progress, &misfit.unwrap_or_default());
        }
    });
    let found = match found {
        Ok(found) => found,
        Err(error) => return ended(error, &path, &stop),
    };
    // Nobody reading on is no error.
    let _ = std::io::stdout().write_all(text(&found).as_bytes());
    if !solve.with.quiet {
        say(&format!(
            "{} has all numbers, case.toml beside it the case with these values",
            path.join(IDENTIFIED).display()
        ));
    }
    Ok(match found.why {
        Why::Met | Why::Converged => Outcome::Converged,
        // Said even when quiet: it is the reason for the exit code.
        Why::NoDescent => {
            say("not converged: no step makes the misfit less, however short; another start may help");
            Outcome::NotConverged
        }
        Why::Enough => {
            say(&format!(
                "not converged after {} solutions: `solutions` allows more, --resume goes on",
                found.solutions
            ));
            Outcome::NotConverged
        }
    })
}

fn text(found: &Identified) -> String {
    let mut text = format!("{:<28} {:>12} {:>14} {:>12}\n", "", "value", "95 % interval", "start");
    for Value { name, value, start, is_at_bound, half_width, .. } in &found.values {
        let interval = match half_width {
            Some(half_width) => format!("± {}", number(*half_width)),
            None if *is_at_bound => "at its bound".to_owned(),
            None => "not known".to_owned(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<28} {:>12} {interval:>14} {:>12}", number(*value), number(*start));
    }
    for column in &found.columns {
        let _ =
            writeln!(text, "left of {}: {} (root mean square of {})", column.name, number(column.left), column.count);
    }
    let free: Vec<&str> =
        found.values.iter().filter(|value| !value.is_at_bound).map(|value| value.name.as_str()).collect();
    for (i, row) in found.correlation.iter().enumerate() {
        for (j, correlation) in row.iter().enumerate().take(i).filter(|(_, c)| c.abs() >= CORRELATED) {
            let _ = writeln!(text, "correlation of {} and {}: {:.3}", free[j], free[i], correlation);
        }
    }
    for untold in &found.untold {
        let _ = writeln!(text, "{untold}");
    }
    text
}
