//! `pneuflex converge`: the same case on finer and finer meshes, and what that says about the exact answer.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::time::Instant;

use pneuflex_model::{Case, Problem};
use pneuflex_newton::{ConvergedState, Event, follow_path};
use pneuflex_post::chart::{Chart, Series, Style};
use pneuflex_post::convergence::{Extrapolated, extrapolate};
use pneuflex_post::{PostError, measures, stress};
use serde::Serialize;

use crate::args::ConvergeArguments;
use crate::case_file::CaseFile;
use crate::error::{CliError, say};
use crate::folder::OutputFolder;
use crate::json;
use crate::memory::{Estimate, thousands};
use crate::progress::duration;
use crate::run::{Outcome, use_threads};

/// `converge.json`. Its keys are a contract: later versions add to them.
#[derive(Debug, Serialize)]
struct ConvergeFile<'a> {
    program: &'static str,
    version: &'static str,
    title: &'a str,
    element: &'static str,
    levels: Vec<Level>,
    /// One per pressure that was reached on every mesh.
    results: Vec<AtPressure>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
}

/// One mesh.
#[derive(Debug, Serialize)]
struct Level {
    /// Number of parts into which every element of the case's mesh is divided along every direction.
    divisions: usize,
    elements: usize,
    unknowns: usize,
    /// Edge of a cube with the mean volume of an element, mm.
    element_size_mm: f64,
    seconds: f64,
    iterations: usize,
    steps: Vec<Measured>,
}

/// What is compared.
#[derive(Clone, Copy, Debug, Serialize)]
struct Measured {
    pressure_kpa: f64,
    end_face_angle_deg: f64,
    /// Length of the displacement of the bottom centreline's last node, mm.
    tip_displacement_mm: f64,
    von_mises_p99_mpa: f64,
}

#[derive(Debug, Serialize)]
struct AtPressure {
    pressure_kpa: f64,
    end_face_angle_deg: Extrapolated,
    tip_displacement_mm: Extrapolated,
    von_mises_p99_mpa: Extrapolated,
}

/// Solves a case on several meshes and reports values with error bars.
///
/// # Errors
/// Bad input, found before anything is solved or written; a result that cannot be written.
pub fn converge(arguments: &ConvergeArguments) -> Result<Outcome, CliError> {
    let file = CaseFile::load(&arguments.case.case, &arguments.case.set)?;
    let case = &file.case;
    let base = case.mesh.mesh_size(&case.actuator);
    let finest = usize::from(arguments.levels);
    Estimate::of_size(case, &base.divided(finest)).guard(arguments.solve.force)?;
    use_threads(arguments.solve.threads)?;
    let default = || PathBuf::from("out").join(format!("{}-converge", file.stem()));
    let folder = OutputFolder::to_add_to(&arguments.out.clone().unwrap_or_else(default))?;

    let (mut levels, mut failure) = (Vec::new(), None);
    for divisions in 1..=finest {
        let problem = Problem::from_case_on(case, &base.divided(divisions)).map_err(|e| file.out_of_range(&e))?;
        if !arguments.solve.quiet {
            say(&format!("elements divided by {divisions}: {} unknowns", thousands(problem.num_unknowns() as u64)));
        }
        let (level, ended) = solve(case, &problem, divisions);
        if !arguments.solve.quiet {
            say(&format!("  {} iterations in {}", level.iterations, duration(level.seconds)));
        }
        levels.push(level);
        if let Err(cause) = ended {
            failure = Some(format!("elements divided by {divisions}: {cause}"));
            break;
        }
    }
    let results = compare(&levels);
    let table = report(&levels, &results);
    let drawing = chart(case, &levels, &results).and_then(|c| c.draw()).and_then(|d| d.to_svg());
    let content = ConvergeFile {
        program: "pneuflex",
        version: env!("CARGO_PKG_VERSION"),
        title: &case.title,
        element: case.mesh.formulation().name(),
        levels,
        results,
        failure,
    };
    let text = json::pretty(&content).map_err(|e| CliError::Output(format!("converge.json: {e}")))?;
    folder.write("converge.json", text).map_err(CliError::Output)?;
    if let Ok(drawing) = drawing {
        folder.write("convergence.svg", drawing).map_err(CliError::Output)?;
    }
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(table.as_bytes());
    if let Some(failure) = &content.failure {
        say(&format!("error: {failure}\n  what was computed so far is in {}", folder.path().display()));
        return Ok(Outcome::NotConverged);
    }
    if !arguments.solve.quiet {
        say(&format!("results are in {}", folder.path().display()));
    }
    Ok(Outcome::Converged)
}

/// Follows the case's pressures on one mesh; what was reached is kept when it fails.
fn solve(case: &Case, problem: &Problem, divisions: usize) -> (Level, Result<(), String>) {
    let began = Instant::now();
    let mut steps = Vec::new();
    let mut measured = Ok(());
    let result = follow_path(problem, &case.load.pressure_kpa, &case.solver, &mut |event| {
        if let (Event::Converged(state), Ok(())) = (event, &measured) {
            match measure(problem, state) {
                Ok(step) => steps.push(step),
                Err(error) => measured = Err(error.to_string()),
            }
        }
    });
    let (iterations, ended) = match result {
        Ok(report) => (report.iterations, measured),
        Err(ended) => (ended.1.iterations, Err(ended.0.to_string())),
    };
    let elements = problem.mesh.num_elements();
    let level = Level {
        divisions,
        elements,
        unknowns: problem.num_unknowns(),
        element_size_mm: (problem.mesh.volume() / elements as f64).cbrt(),
        seconds: began.elapsed().as_secs_f64(),
        iterations,
        steps,
    };
    (level, ended)
}

fn measure(problem: &Problem, state: &ConvergedState) -> Result<Measured, PostError> {
    let u = &state.displacement;
    let tip = problem.mesh.node_set("bottom_centreline").last().map_or([0.0; 3], |&node| u[node as usize]);
    Ok(Measured {
        pressure_kpa: state.time,
        end_face_angle_deg: measures::end_face_angle_deg(problem, u)?,
        tip_displacement_mm: tip.iter().map(|x| x * x).sum::<f64>().sqrt(),
        von_mises_p99_mpa: stress::recover(problem, u)?.von_mises_quantile(0.99),
    })
}

/// Extrapolates at the pressures that every mesh reached.
fn compare(levels: &[Level]) -> Vec<AtPressure> {
    let h: Vec<f64> = levels.iter().map(|level| level.element_size_mm).collect();
    let reached = levels.iter().map(|level| level.steps.len()).min().unwrap_or(0);
    (0..reached)
        .filter_map(|step| {
            let of = |value: fn(&Measured) -> f64| {
                extrapolate(&h, &levels.iter().map(|level| value(&level.steps[step])).collect::<Vec<_>>())
            };
            Some(AtPressure {
                pressure_kpa: levels[0].steps[step].pressure_kpa,
                end_face_angle_deg: of(|m| m.end_face_angle_deg)?,
                tip_displacement_mm: of(|m| m.tip_displacement_mm)?,
                von_mises_p99_mpa: of(|m| m.von_mises_p99_mpa)?,
            })
        })
        .collect()
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
fn chart(case: &Case, levels: &[Level], results: &[AtPressure]) -> Result<Chart, PostError> {
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
