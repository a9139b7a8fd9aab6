//! `cargo xtask cases`: small inputs that were once answered wrongly, and those on which advice is tried.

use std::process::ExitCode;

use pneuflex_verification::{Effort, advice, known_cases};

/// Solves all of them and says which are wrong.
pub fn run() -> ExitCode {
    let found = known_cases::run(Effort::Full, &|case| match &case.verdict {
        Ok(()) => println!("right  {}", case.name),
        Err(why) => println!("WRONG  {}: {why}", case.name),
    });
    let tried = advice::run(Effort::Full, &|tried| match &tried.verdict {
        Ok(()) => println!("helps  {}", tried.name),
        Err(why) => println!("NO USE {}: {why}", tried.name),
    });
    let is_right = found.iter().all(|case| case.verdict.is_ok()) && tried.iter().all(|tried| tried.verdict.is_ok());
    if is_right { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
