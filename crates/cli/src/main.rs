//! The `pneuflex` command line program: arguments, progress, messages and exit codes.
//!
//! * [`args`], [`examples`]: the command line and its help.
//! * [`check`], [`check_gradient`], [`compare`], [`converge`], [`design`], [`export`], [`find`], [`fit`], [`identify`], [`materials`], [`mesh`], [`new`],
//!   [`picture`], [`run`], [`rod`], [`sweep`], [`table`], [`uncertainty`], [`view`]: the commands; [`completions`], [`man`]: those about the program itself.
//! * [`search`]: what is said of every design of a search.
//! * [`error`], [`outcome`], [`progress`], [`run_table`], [`terminal`]: messages, exit codes, progress, what a run found, lines of a terminal.
//! * [`interrupt`]: Ctrl-C, the run stops at its next iteration.
//!
//! Everything else is the library's, the crate `pneuflex`.
//!
//! Exit codes: 0 done, 1 an output could not be written, 2 bad input, 3 not converged, 130 interrupted.

mod args;
mod check;
mod check_gradient;
mod compare;
mod completions;
mod converge;
mod design;
mod error;
mod examples;
mod export;
mod find;
mod fit;
mod identify;
mod interrupt;
mod man;
mod materials;
mod mesh;
mod new;
mod outcome;
mod picture;
mod progress;
mod rod;
mod run;
mod run_table;
mod search;
mod sweep;
mod table;
mod terminal;
mod uncertainty;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use args::{Arguments, Command};
use outcome::{Outcome, exit_code};

fn main() -> ExitCode {
    interrupt::honour_nohup();
    // The width 0 breaks no line.
    let command = Arguments::command().term_width(terminal::columns_of_output().unwrap_or_default());
    let arguments = Arguments::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit());
    let done = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Check(arguments) => check::check(&arguments).map(|()| Outcome::Converged),
        Command::New(arguments) => new::new(&arguments).map(|()| Outcome::Converged),
        Command::Mesh(arguments) => mesh::mesh(&arguments).map(|()| Outcome::Converged),
        Command::Picture(arguments) => picture::picture(&arguments).map(|()| Outcome::Converged),
        Command::View(arguments) => view::view(&arguments).map(|()| Outcome::Converged),
        Command::Compare(arguments) => compare::compare(&arguments).map(|()| Outcome::Converged),
        Command::Export(arguments) => export::export(&arguments).map(|()| Outcome::Converged),
        Command::Find(arguments) => find::find(&arguments),
        Command::CheckGradient(arguments) => check_gradient::check_gradient(&arguments),
        Command::Design(arguments) => design::design(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Uncertainty(arguments) => uncertainty::uncertainty(&arguments),
        Command::Table(arguments) => table::table(&arguments).map(|()| Outcome::Converged),
        Command::Converge(arguments) => converge::converge(&arguments),
        Command::Sweep(arguments) => sweep::sweep(&arguments),
        Command::Rod(arguments) => rod::rod(&arguments),
        Command::Fit(arguments) => fit::fit(&arguments),
        Command::Materials(arguments) => materials::materials(&arguments).map(|()| Outcome::Converged),
        Command::Completions(arguments) => {
            completions::completions(&arguments, Arguments::command());
            Ok(Outcome::Converged)
        }
        Command::Man(arguments) => man::man(&arguments, Arguments::command()).map(|()| Outcome::Converged),
    };
    exit_code(done)
}
