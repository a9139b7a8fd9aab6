//! `pneuflex check-gradient`: derivatives of a result beside differences of whole runs.

use std::io::Write;

use pneuflex::gradient::{Checked, check};
use pneuflex::words::rounded;
use pneuflex::{Error, Study};

use crate::args::CheckGradientArguments;
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::terminal::say;

/// Digits of derivatives.
const DIGITS: i32 = 9;

/// Prints a row for every key.
///
/// # Errors
/// Bad input, found before anything is solved; runs that do not converge.
pub fn check_gradient(arguments: &CheckGradientArguments) -> Result<Outcome, CliError> {
    let CheckGradientArguments { case, of, by, solve } = arguments;
    solve.with.use_threads()?;
    let study = Study::load_with(&case.case, case.changes()?)?;
    let analysis = study.build_within(solve.memory_limit())?;
    let keys = Some(&by[..]).filter(|keys| !keys.is_empty());
    // Nobody reading on is no error.
    let print = |line: &str| drop(writeln!(std::io::stdout(), "{line}"));
    print(&format!("{:<28} {:>16} {:>16} {:>12}", format!("d {of} / d"), "exact", "by differences", "relative"));
    let row = |checked: &Checked| {
        let [exact, differences] =
            [checked.exact.derivative, checked.by_differences].map(|x| rounded(x, DIGITS).to_string());
        let relative = checked.relative_difference();
        print(&format!("{:<28} {exact:>16} {differences:>16} {relative:>12.1e}", checked.exact.by));
    };
    match check(&analysis, of, keys, &interrupt::listen(), &mut |checked| row(checked)) {
        Ok(_) => Ok(Outcome::Converged),
        Err(Error::Interrupted(_)) => {
            say("interrupted");
            Ok(Outcome::Interrupted)
        }
        Err(error) => Err(error.into()),
    }
}
