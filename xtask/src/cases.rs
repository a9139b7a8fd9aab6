//! `cargo xtask cases`: small inputs that were once answered wrongly.

use std::process::ExitCode;

use pneuflex_verification::Effort;
use pneuflex_verification::known_cases::run as solve;

/// Solves all of them and says which are wrong.
pub fn run() -> ExitCode {
    let found = solve(Effort::Full, &|case| match &case.verdict {
        Ok(()) => println!("right  {}", case.name),
        Err(why) => println!("WRONG  {}: {why}", case.name),
    });
    if found.iter().all(|case| case.verdict.is_ok()) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
