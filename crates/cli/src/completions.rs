//! `pneuflex completions`: what a shell needs to complete commands and options.

use std::io::{self, Write};

use clap::{Args, Command};
use clap_complete::Shell;

/// Arguments of `pneuflex completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// Which shell
    pub shell: Shell,
}

/// Prints the completions of a shell for a program.
pub fn completions(arguments: &CompletionsArguments, mut program: Command) {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "pneuflex", &mut script);
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(&script);
}
