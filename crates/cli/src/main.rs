//! The `pneuflex` command line program: the only crate that touches files, clock and terminal.
//!
//! * [`args`], [`examples`]: the command line and its help.
//! * [`study`]: what is to be solved, from whichever kind of file.
//! * [`case_file`], [`repair`], [`error`], [`suggest`]: reading case files, and messages about them.
//! * [`check`], [`converge`], [`fit`], [`materials`], [`new`], [`run`], [`rod`], [`view`]: the commands;
//!   [`completions`], [`man`]: those about the program itself.
//! * [`folder`], [`recorder`], [`checkpoint`], [`diagnosis`], [`json`]: the output folder.
//! * [`interrupt`]: Ctrl-C, the run stops at its next iteration.
//! * [`memory`], [`progress`]: estimates and progress.
//!
//! Exit codes: 0 done, 1 an output could not be written, 2 bad input, 3 not converged, 130 interrupted.

mod args;
mod case_file;
mod check;
mod checkpoint;
mod completions;
mod converge;
mod diagnosis;
mod error;
mod examples;
mod fit;
mod folder;
mod interrupt;
mod json;
mod man;
mod materials;
mod memory;
mod new;
mod progress;
mod recorder;
mod repair;
mod rod;
mod run;
mod study;
mod suggest;
mod view;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use error::CliError;
use run::Outcome;

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Check(arguments) => check::check(&arguments).map(|()| Outcome::Converged),
        Command::New(arguments) => new::new(&arguments).map(|()| Outcome::Converged),
        Command::View(arguments) => view::view(&arguments).map(|()| Outcome::Converged),
        Command::Converge(arguments) => converge::converge(&arguments),
        Command::Rod(arguments) => rod::rod(&arguments),
        Command::Fit(arguments) => fit::fit(&arguments),
        Command::Materials(arguments) => materials::materials(&arguments).map(|()| Outcome::Converged),
        Command::Completions(arguments) => {
            completions::completions(&arguments);
            Ok(Outcome::Converged)
        }
        Command::Man(arguments) => man::man(&arguments).map(|()| Outcome::Converged),
    };
    match done {
        Ok(Outcome::Converged) => ExitCode::SUCCESS,
        Ok(Outcome::NotConverged) => ExitCode::from(3),
        Ok(Outcome::Interrupted) => ExitCode::from(interrupt::EXIT_CODE),
        Err(error) => {
            error.print();
            ExitCode::from(match error {
                CliError::Output(_) => 1,
                CliError::Input(_) => 2,
            })
        }
    }
}
