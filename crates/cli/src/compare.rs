//! `pneuflex compare`: a run beside what somebody has measured.

use std::fs;
use std::io::Write;

use pneuflex::compare::{Choices, Fit, Line, compare as differences};
use pneuflex::folder::{COMPARISON, COMPARISON_PICTURE, REPORT};
use pneuflex::model::{Clock, LoadParameter};
use pneuflex::report::comparison::Comparison;
use pneuflex::report_page::write_report;
use pneuflex::words::rounded;
use pneuflex::{InputError, OutputFolder, json};

use crate::args::{CompareArguments, CompareFit, CompareLine};
use crate::error::CliError;
use crate::terminal::say;

/// Digits of the numbers.
const DIGITS: i32 = 4;

/// Compares, prints the table, and adds it to the result folder and its report.
///
/// # Errors
/// Measurements or results that cannot be compared, files that cannot be written.
pub fn compare(arguments: &CompareArguments) -> Result<(), CliError> {
    let has = |what: CompareFit| arguments.fit.contains(&what);
    let choices = Choices {
        line: arguments.line.map(|line| match line {
            CompareLine::Bottom => Line::Bottom,
            CompareLine::Outline => Line::Outline,
        }),
        fit: Fit {
            scale: has(CompareFit::Scale),
            rotation: has(CompareFit::Rotation),
            offset: has(CompareFit::Offset),
        },
    };
    let out = arguments.out.as_ref().map(|out| {
        let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok((out, true)),
            Some("png") => Ok((out, false)),
            _ => Err(InputError::new(format!("--out {}: a picture ends with .png or .svg", out.display()))),
        }
    });
    let out = out.transpose()?;
    let (found, drawing) = differences(&arguments.results, &arguments.measured, choices)?;
    let folder = OutputFolder::to_add_to(&arguments.results)?;
    folder.write(COMPARISON, json::pretty(&found).map_err(CliError::Output)?)?;
    folder.write(COMPARISON_PICTURE, &found.picture)?;
    if let Some((out, is_svg)) = out {
        let bytes = if is_svg { Ok(found.picture.clone().into_bytes()) } else { drawing.to_png(2.0) };
        let bytes = bytes.map_err(|e| InputError::about_file(out, e))?;
        fs::write(out, bytes).map_err(|e| CliError::Output(format!("{}: cannot be written: {e}", out.display())))?;
    }
    // Nobody reading on is no error.
    let _ = std::io::stdout().write_all(text(&found).as_bytes());
    if folder.path().join(REPORT).exists() {
        say(&format!("report: {}", write_report(&folder)?.display()));
    }
    Ok(())
}

/// The table, and what was done before.
fn text(found: &Comparison) -> String {
    let number = |x: f64| rounded(x, DIGITS).to_string();
    let clock = if found.is_by_time { Clock::Steps } else { Clock::Pressure };
    let when = |at: f64| clock.words(LoadParameter(rounded(at, DIGITS)));
    let mut rows = vec![["measured", "number", "RMS", "largest", "where", "mean"].map(str::to_owned)];
    rows.extend(found.kinds.iter().map(|kind| {
        let of = if kind.unit.is_empty() { kind.of.clone() } else { format!("{}, {}", kind.of, kind.unit) };
        let mean = kind.mean.map_or_else(String::new, number);
        [of, kind.count.to_string(), number(kind.rms), number(kind.largest), when(kind.largest_at), mean]
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let cells: Vec<String> = row
            .iter()
            .zip(widths)
            .enumerate()
            .map(|(i, (cell, width))| if i == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") })
            .collect();
        text += cells.join("  ").trim_end();
        text.push('\n');
    }
    if let Some(line) = &found.line {
        text += &format!("Points are compared with the nearest point of the {line}.\n");
    }
    if let Some(alignment) = &found.alignment {
        text += &format!("{}\n", alignment.words());
    }
    if !found.interpolated_at.is_empty() {
        let places: Vec<String> = found.interpolated_at.iter().map(|at| when(*at)).collect();
        text += &format!("The run is interpolated at {}.\n", places.join(", "));
    }
    text
}
