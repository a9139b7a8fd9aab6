//! `pneuflex converge`: the same case on finer and finer meshes, and what that says about the exact answer.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;

use pneuflex::convergence::{AtPressure, Level, LevelEvent, Measured};
use pneuflex::model::Case;
use pneuflex::plot::PlotError;
use pneuflex::plot::chart::{Chart, Series, Style};
use pneuflex::post::convergence::Extrapolated;
use pneuflex::words::thousands;
use pneuflex::{CaseFile, Estimate, OutputFolder, json};

use crate::args::ConvergeArguments;
use crate::error::CliError;
use crate::outcome::Outcome;
use crate::progress::duration;
use crate::terminal::say;

/// Solves a case on several meshes and reports values with error bars.
///
/// # Errors
/// Bad input, found before anything is solved or written; a result that cannot be written.
pub fn converge(arguments: &ConvergeArguments) -> Result<Outcome, CliError> {
    let file = CaseFile::load(&arguments.case.case, &arguments.case.changes()?)?;
    let case = &file.case;
    let base = case.mesh.mesh_size(&case.actuator);
    let finest = usize::from(arguments.levels);
    Estimate::of_size(case, &base.divided(finest)).within(arguments.solve.memory_limit())?;
    arguments.solve.use_threads()?;
    let default = || PathBuf::from("out").join(format!("{}-converge", file.stem()));
    let folder = OutputFolder::to_add_to(&arguments.out.clone().unwrap_or_else(default))?;

    let mut progress = |event: LevelEvent<'_>| match event {
        _ if arguments.solve.quiet => {}
        LevelEvent::Started { divisions, unknowns } => {
            say(&format!("elements divided by {divisions}: {} unknowns", thousands(unknowns as u64)));
        }
        LevelEvent::Finished(level) => {
            say(&format!("  {} iterations in {}", level.iterations, duration(level.seconds)));
        }
    };
    let found = pneuflex::convergence::converge(&file, finest, &mut progress)?;
    let table = report(&found.levels, &found.results);
    let drawing = chart(case, &found.levels, &found.results).and_then(|c| c.draw()).and_then(|d| d.to_svg());
    let text = json::pretty(&found).map_err(|e| CliError::Output(format!("converge.json: {e}")))?;
    folder.write("converge.json", text)?;
    if let Ok(drawing) = drawing {
        folder.write("convergence.svg", drawing)?;
    }
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(table.as_bytes());
    if let Some(failure) = &found.failure {
        say(&format!("error: {failure}\n  what was computed so far is in {}", folder.path().display()));
        return Ok(Outcome::NotConverged);
    }
    if !arguments.solve.quiet {
        say(&format!("results are in {}", folder.path().display()));
    }
    Ok(Outcome::Converged)
}

fn report(levels: &[Level], results: &[AtPressure]) -> String {
    let mut text =
        format!("{:>10} {:>10} {:>10} {:>9} {:>6}\n", "divided by", "elements", "unknowns", "size, mm", "iter");
    for level in levels {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:>10} {:>10} {:>10} {:>9.3} {:>6}",
            level.divisions,
            thousands(level.elements as u64),
            thousands(level.unknowns as u64),
            level.element_size_mm,
            level.iterations
        );
    }
    for at in results {
        let _ = writeln!(text, "\n{} kPa", at.pressure_kpa);
        let mut row = |name: &str, digits: usize, values: Vec<f64>, e: &Extrapolated| {
            let values: Vec<String> = values.iter().map(|v| format!("{v:.digits$}")).collect();
            let order = e.order.map_or("no order seen".into(), |p| format!("order {p:.2}"));
            let _ = writeln!(
                text,
                "  {name:<24} {}  extrapolated {:.digits$}, error bar of the finest +-{:.digits$} ({:.2} %), {order}",
                values.join("  "),
                e.extrapolated,
                e.error_bar,
                100.0 * e.error_bar / e.finest.abs().max(f64::MIN_POSITIVE),
            );
        };
        let values = |value: fn(&Measured) -> f64| {
            let found = |level: &Level| level.steps.iter().find(|s| s.pressure_kpa == at.pressure_kpa).map(value);
            levels.iter().filter_map(found).collect::<Vec<f64>>()
        };
        row("end face angle, deg", 3, values(|m| m.end_face_angle_deg), &at.end_face_angle_deg);
        row("tip displacement, mm", 4, values(|m| m.tip_displacement_mm), &at.tip_displacement_mm);
        row("p99 von Mises, MPa", 5, values(|m| m.von_mises_p99_mpa), &at.von_mises_p99_mpa);
    }
    text
}

/// Deviation from the extrapolated values over the element size, at the last pressure.
fn chart(case: &Case, levels: &[Level], results: &[AtPressure]) -> Result<Chart, PlotError> {
    let pressure = results.last().map_or(0.0, |at| at.pressure_kpa);
    let series = |name: &str, value: fn(&Measured) -> f64, limit: Option<&Extrapolated>| {
        let points = levels
            .iter()
            .filter_map(|level| {
                let step = level.steps.iter().find(|s| s.pressure_kpa == pressure)?;
                Some([level.element_size_mm, 100.0 * (value(step) / limit?.extrapolated - 1.0)])
            })
            .collect();
        Series::line(name, points).style(Style::SolidWithDots)
    };
    let last = results.last();
    Ok(Chart {
        x_label: "element size: cube root of the mean volume (mm)".into(),
        y_label: "deviation from the extrapolated value (%)".into(),
        x_shows: vec![0.0],
        y_shows: vec![0.0],
        series: vec![
            series("end face angle", |m| m.end_face_angle_deg, last.map(|at| &at.end_face_angle_deg)),
            series("tip displacement", |m| m.tip_displacement_mm, last.map(|at| &at.tip_displacement_mm)),
            series("p99 von Mises stress", |m| m.von_mises_p99_mpa, last.map(|at| &at.von_mises_p99_mpa)),
        ],
        caption: format!("{}, {}.", case.title, case.mesh.formulation()),
        ..Chart::new(&format!("Mesh convergence at {pressure} kPa"))
    })
}
