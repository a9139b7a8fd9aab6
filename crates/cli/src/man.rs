//! `pneuflex man`: the manual, as one page or one page per command.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man;
use pneuflex::OutputFolder;

use crate::error::CliError;
use crate::terminal::say;

/// Arguments of `pneuflex man`.
#[derive(Debug, Args)]
pub struct ManArguments {
    /// Folder for one page per command; without it, one page with everything is printed
    pub dir: Option<PathBuf>,
}

/// Prints the manual page of a program, or writes one page per command.
///
/// # Errors
/// A folder or page that cannot be written.
pub fn man(arguments: &ManArguments, program: Command) -> Result<(), CliError> {
    let program = with_full_names(program);
    let failed = |error: io::Error| CliError::Output(format!("manual page: {error}"));
    let Some(dir) = &arguments.dir else {
        let page = whole(&program).map_err(failed)?;
        // Nobody reading on is no error.
        let _ = io::stdout().write_all(page.as_bytes());
        return Ok(());
    };
    let folder = OutputFolder::to_add_to(dir)?;
    let commands = program.get_subcommands().cloned();
    let pages: Vec<Command> = std::iter::once(program.clone()).chain(commands).collect();
    for command in &pages {
        let name = command.get_display_name().unwrap_or(command.get_name());
        let page = sections(command, true).map_err(failed)?;
        folder.write(&format!("{name}.1"), page)?;
    }
    say(&format!("wrote {} pages to {}", pages.len(), folder.path().display()));
    Ok(())
}

/// The command line with its commands' full names (`pneuflex-run`).
fn with_full_names(program: Command) -> Command {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    program
}

/// One page: the program, then every command with its sections one level below.
fn whole(program: &Command) -> io::Result<String> {
    // Its commands are sections here, not pages.
    let mut page = sections(program, true)?.replace("\npneuflex\\-", "\npneuflex ").replace("(1)\n", "\n");
    for command in program.get_subcommands() {
        let title = format!("{} {}", program.get_name(), command.get_name()).to_uppercase();
        page += &format!(".SH {title}\n{}", sections(command, false)?.replace("\n.SH ", "\n.SS "));
    }
    Ok(page)
}

/// Everything that is said about one command; with the title, a page of its own.
fn sections(command: &Command, is_page: bool) -> io::Result<String> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    if is_page {
        man.render_title(&mut page)?;
        man.render_name_section(&mut page)?;
    }
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    if command.get_after_help().or(command.get_after_long_help()).is_some() {
        man.render_extra_section(&mut page)?;
    }
    let page = String::from_utf8_lossy(&page);
    let extra = if command.has_subcommands() { "\n.SH NOTES" } else { "\n.SH EXAMPLES" };
    Ok(portable(&page.replace("\n.SH EXTRA", extra)))
}

/// Keeps indented lines as they are, and writes characters beyond ASCII as roff's escapes, which every reader of it knows.
fn portable(page: &str) -> String {
    let mut text = String::new();
    let mut is_kept = false;
    for line in page.lines() {
        if line.starts_with("  ") != is_kept {
            is_kept = !is_kept;
            text += if is_kept { ".nf\n" } else { ".fi\n" };
        }
        for c in line.chars() {
            match c {
                ascii if ascii.is_ascii() => text.push(ascii),
                other => text += &format!("\\[u{:04X}]", u32::from(other)),
            }
        }
        text.push('\n');
    }
    if is_kept { text + ".fi\n" } else { text }
}
