//! `pneuflex completions`: what a shell needs to complete commands and options.

use std::io::{self, Write};

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::args::Arguments;

/// Arguments of `pneuflex completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// Which shell
    pub shell: Shell,
}

/// Prints the completions of a shell.
pub fn completions(arguments: &CompletionsArguments) {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "pneuflex", &mut script);
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(&script);
}
