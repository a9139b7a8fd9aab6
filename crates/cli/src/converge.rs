//! `pneuflex converge`: the same case on finer and finer meshes, and what that says about the exact answer.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;

use pneuflex::convergence::{AtState, Compared, Convergence, Level, LevelEvent};
use pneuflex::plot::PlotError;
use pneuflex::plot::chart::{Chart, Series, Style};
use pneuflex::words::thousands;
use pneuflex::{OutputFolder, Study, json};

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
    arguments.solve.with.use_threads()?;
    let (limit, levels) = (arguments.solve.memory_limit(), usize::from(arguments.levels));
    let study = Study::load_with(&arguments.case.case, arguments.case.changes()?)?;
    let analysis = study.build_within(limit)?;
    let default = || PathBuf::from("out").join(format!("{}-converge", analysis.stem()));
    let sequence = analysis.finer_meshes(levels, limit)?;
    let folder = OutputFolder::to_add_to(&arguments.out.clone().unwrap_or_else(default))?;

    let mut progress = |event: LevelEvent<'_>| match event {
        _ if arguments.solve.with.quiet => {}
        LevelEvent::Started { divisions, unknowns } => {
            say(&format!("elements divided by {divisions}: {} unknowns", thousands(unknowns as u64)));
        }
        LevelEvent::Finished(level) => {
            say(&format!("  {} iterations in {}", level.iterations, duration(level.seconds)));
        }
    };
    let found = sequence.solve(&mut progress)?;
    let table = report(&found.levels, &found.results);
    let drawing = chart(&found).and_then(|c| c.draw()).and_then(|d| d.to_svg());
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
    if !arguments.solve.with.quiet {
        say(&format!("results are in {}", folder.path().display()));
    }
    Ok(Outcome::Converged)
}

fn report(levels: &[Level], results: &[AtState]) -> String {
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
        let _ = writeln!(text, "\n{}", at.when());
        for Compared { quantity, values, extrapolated: e } in &at.compared {
            let digits = quantity.decimals;
            let values: Vec<String> = values.iter().map(|v| format!("{v:.digits$}")).collect();
            let order = e.order.map_or("no order seen".into(), |p| format!("order {p:.2}"));
            let _ = writeln!(
                text,
                "  {:<24} {}  extrapolated {:.digits$}, error bar of the finest +-{:.digits$} ({:.2} %), {order}",
                quantity.words,
                values.join("  "),
                e.extrapolated,
                e.error_bar,
                100.0 * e.error_bar / e.finest.abs().max(f64::MIN_POSITIVE),
            );
        }
    }
    text
}

/// Deviation from the extrapolated values over the element size, at the last pressure or time.
fn chart(found: &Convergence) -> Result<Chart, PlotError> {
    let (last, when) = (found.results.last(), found.results.last().map_or_else(String::new, AtState::when));
    let series = |Compared { quantity, values, extrapolated }: &Compared| {
        let points = (found.levels.iter().zip(values))
            .map(|(level, value)| [level.element_size_mm, 100.0 * (value / extrapolated.extrapolated - 1.0)])
            .filter(|point| point[1].is_finite())
            .collect();
        // Without its unit: all are percentages.
        let name = quantity.words.rsplit_once(", ").map_or(&*quantity.words, |(name, _)| name);
        Series::line(name, points).style(Style::SolidWithDots)
    };
    Ok(Chart {
        x_label: "element size: cube root of the mean volume (mm)".into(),
        y_label: "deviation from the extrapolated value (%)".into(),
        x_shows: vec![0.0],
        y_shows: vec![0.0],
        series: last.map_or_else(Vec::new, |at| at.compared.iter().map(series).collect()),
        caption: format!("{}, {}.", found.title, found.element),
        ..Chart::new(&format!("Mesh convergence at {when}"))
    })
}
