//! `pneuflex export`: results in the formats of other programs.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use pneuflex::InputError;
use pneuflex::export::{Format, Reel};
use pneuflex::picture::Look;

use crate::args::{ExportArguments, ExportFormat, PictureColours, PictureView};
use crate::error::CliError;
use crate::picture::{check_range, colours, view};
use crate::terminal::say;

/// Width of the pictures of a film, px, and their number.
const WIDTH: u32 = 700;
const PICTURES: u32 = 40;

/// Thickness of a mould's walls, mm.
const WALL: f64 = 5.0;

/// Writes the files and says where they are.
///
/// # Errors
/// An option that the format has no use for, a folder that is none of this program's, results that do not have what is asked for, a file that
/// cannot be written.
pub fn export(arguments: &ExportArguments) -> Result<(), CliError> {
    refuse_unused(arguments)?;
    check_range(arguments.range)?;
    let out = arguments.out.clone().map_or_else(|| default_out(&arguments.results, arguments.to), Ok)?;
    let files = pneuflex::export::export(&arguments.results, &format(arguments), &out)?;
    match &files[..] {
        [file] => say(&format!("wrote {}", file.display())),
        files => say(&format!("wrote {} files into {}", files.len(), out.display())),
    }
    Ok(())
}

fn format(arguments: &ExportArguments) -> Format {
    let look = Look {
        at: arguments.at,
        colours: colours(arguments.colour.unwrap_or(PictureColours::VonMises)),
        view: view(arguments.view.unwrap_or(PictureView::Iso)),
        range: arguments.range,
        width: f64::from(arguments.width.unwrap_or(WIDTH)),
    };
    let film = |reel| {
        let pictures = arguments.pictures.unwrap_or(PICTURES) as usize;
        Format::Film { look: look.clone(), pictures, reel }
    };
    match arguments.to {
        ExportFormat::Stl => Format::Stl(arguments.at),
        ExportFormat::Obj => Format::Obj(look),
        ExportFormat::Glb => Format::Glb(look),
        ExportFormat::Csv => Format::Csv(arguments.at),
        ExportFormat::Npz => Format::Npz,
        ExportFormat::Vtk => Format::Vtk,
        ExportFormat::Msh => Format::Msh,
        ExportFormat::Png => film(Reel::Png),
        ExportFormat::Gif => film(Reel::Gif),
        ExportFormat::Mp4 => film(Reel::Mp4),
        ExportFormat::Mould => Format::Mould(arguments.wall.unwrap_or(WALL)),
    }
}

/// Refuses options that the format has no use for.
fn refuse_unused(arguments: &ExportArguments) -> Result<(), InputError> {
    use ExportFormat::{Csv, Gif, Glb, Mould, Mp4, Obj, Png, Stl};
    let film = [Png, Gif, Mp4];
    let painted = [Obj, Glb, Png, Gif, Mp4];
    let options: [(&str, bool, &[ExportFormat]); 7] = [
        ("--at", arguments.at.is_some(), &[Stl, Obj, Glb, Csv]),
        ("--colour", arguments.colour.is_some(), &painted),
        ("--range", arguments.range.is_some(), &painted),
        ("--view", arguments.view.is_some(), &film),
        ("--width", arguments.width.is_some(), &film),
        ("--pictures", arguments.pictures.is_some(), &film),
        ("--wall", arguments.wall.is_some(), &[Mould]),
    ];
    match options.into_iter().find(|(_, is_given, formats)| *is_given && !formats.contains(&arguments.to)) {
        None => Ok(()),
        Some((option, _, formats)) => {
            let what = format!("{option} means nothing to --to {}", name(arguments.to));
            let formats: Vec<String> = formats.iter().map(|format| name(*format)).collect();
            Err(InputError::new(what).with_help(Some(format!("it is for {}", formats.join(", ")))))
        }
    }
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
