//! `pneuflex export`: results in the formats of other programs.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use pneuflex::InputError;
use pneuflex::export::Format;
use pneuflex::export_request::{NoFormat, Request};

use crate::args::{ExportArguments, ExportFormat};
use crate::error::CliError;
use crate::picture::{check_range, colours, view};
use crate::terminal::say;

/// Writes the files and says where they are.
///
/// # Errors
/// An option that the format has no use for, a folder that is none of this program's, results that do not have what is asked for, a file that
/// cannot be written.
pub fn export(arguments: &ExportArguments) -> Result<(), CliError> {
    check_range(arguments.range)?;
    let format = format(arguments)?;
    let out = arguments.out.clone().map_or_else(|| default_out(&arguments.results, arguments.to), Ok)?;
    let files = pneuflex::export::export(&arguments.results, &format, &out)?;
    match &files[..] {
        [file] => say(&format!("wrote {}", file.display())),
        files => say(&format!("wrote {} files into {}", files.len(), out.display())),
    }
    Ok(())
}

fn format(arguments: &ExportArguments) -> Result<Format, InputError> {
    let request = Request {
        at: arguments.at,
        colour: arguments.colour.map(colours),
        range: arguments.range,
        view: arguments.view.map(view),
        width: arguments.width.map(f64::from),
        pictures: arguments.pictures.map(|pictures| pictures as usize),
        wall: arguments.wall,
    };
    Format::named(&name(arguments.to), &request).map_err(|error| match error {
        NoFormat::Unused { option, format, formats } => {
            InputError::new(format!("--{option} means nothing to --to {format}"))
                .with_help(Some(format!("it is for {}", formats.join(", "))))
        }
        error => InputError::new(error.to_string()),
    })
}

fn name(format: ExportFormat) -> String {
    format.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Where the files go if nothing is said: beside the user, under the name of the run.
fn default_out(results: &Path, format: ExportFormat) -> Result<PathBuf, InputError> {
    let folder = results.canonicalize().map_err(|e| InputError::about_file(results, e))?;
    let run = folder.file_name().map_or_else(|| "results".into(), |name| name.to_string_lossy().into_owned());
    Ok(match format {
        ExportFormat::Png => format!("{run}-pictures"),
        ExportFormat::Mould => format!("{run}-mould"),
        format => format!("{run}.{}", name(format)),
    }
    .into())
}
