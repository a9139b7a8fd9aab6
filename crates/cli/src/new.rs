//! `pneuflex new`: a commented case or model file to start from.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;

use pneuflex::start_model::start_model;
use pneuflex::{InputError, template};

use crate::args::{CaseKind, NewArguments};
use crate::error::CliError;
use crate::terminal::say;

/// What is written: the file and its text.
fn text(arguments: &NewArguments) -> Result<(PathBuf, String), CliError> {
    let (default, text) = match arguments.kind {
        CaseKind::TwoChamber => ("two_chamber.toml", template::two_chambers()),
        CaseKind::Actuator => ("actuator.toml", template::full_actuator()),
        CaseKind::Model => return model(arguments),
    };
    if let Some(more) = &arguments.model {
        return Err(InputError::new(format!("{}: only a model has two files", more.display())).into());
    }
    Ok((arguments.file.clone().unwrap_or_else(|| PathBuf::from(default)), text))
}

/// A model file around a body.
fn model(arguments: &NewArguments) -> Result<(PathBuf, String), CliError> {
    let Some(body) = &arguments.file else {
        let help = "for example `pneuflex new model part.step`".to_owned();
        return Err(InputError::new("a model needs a part from CAD, a mesh or a deck").with_help(Some(help)).into());
    };
    let default = || body.file_name().map_or_else(|| PathBuf::from("model"), PathBuf::from).with_extension("toml");
    let path = arguments.model.clone().unwrap_or_else(default);
    if path.exists() {
        return Err(exists(&path).into());
    }
    // As the model file's folder has it.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let named = match folder {
        None => body.clone(),
        Some(folder) => body
            .strip_prefix(folder)
            .map_or_else(|_| std::path::absolute(body).unwrap_or_else(|_| body.clone()), std::path::Path::to_path_buf),
    };
    let start = start_model(body, &named.display().to_string())?;
    start.notes.iter().for_each(|note| say(note));
    Ok((path, start.text))
}

fn exists(path: &std::path::Path) -> InputError {
    let help = "give another file name as the last argument".to_owned();
    InputError::about_file(path, "exists already and is not replaced").with_help(Some(help))
}

/// Writes the case file and says what to do with it.
///
/// # Errors
/// A file that exists already or cannot be written; a body that cannot be read.
pub fn new(arguments: &NewArguments) -> Result<(), CliError> {
    let (path, text) = text(arguments)?;
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists(&path),
        _ => InputError::about_file(&path, format!("cannot be written: {error}"))
            .with_help(Some("give another file name as the last argument".into())),
    })?;
    file.write_all(text.replace("THIS.toml", &path.display().to_string()).as_bytes())
        .map_err(|error| CliError::Output(format!("{}: cannot be written: {error}", path.display())))?;
    let name = path.display();
    // Nobody reading on is no error.
    let _ = writeln!(io::stdout(), "wrote {name}\nnext: pneuflex check {name}\n      pneuflex run {name}");
    Ok(())
}
