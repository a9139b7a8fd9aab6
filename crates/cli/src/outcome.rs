//! How a command ended, and the program's exit codes.

use std::process::ExitCode;

use crate::error::CliError;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Everything that was asked for was reached.
    Converged,
    /// The path could not be followed to its end.
    NotConverged,
    /// Somebody asked to stop.
    Interrupted,
}

/// Exit code of a run that was interrupted, by the shells' custom.
pub const INTERRUPTED: u8 = 130;

/// Prints what went wrong, if something did, and returns the program's exit code.
pub fn exit_code(done: Result<Outcome, CliError>) -> ExitCode {
    match done {
        Ok(Outcome::Converged) => ExitCode::SUCCESS,
        Ok(Outcome::NotConverged) => ExitCode::from(3),
        Ok(Outcome::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            error.print();
            ExitCode::from(match error {
                CliError::Output(_) => 1,
                CliError::Input(_) => 2,
                CliError::NotConverged(_) => 3,
            })
        }
    }
}
