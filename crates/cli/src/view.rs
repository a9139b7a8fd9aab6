//! `pneuflex view`: the report of a result folder, `report.html`. `pneuflex run` writes it the same way at its end.

use std::fs;
use std::path::{Path, PathBuf};

use pneuflex_model::{Case, Problem};
use pneuflex_post::vtu::Grid;
use pneuflex_report::state::State;
use pneuflex_report::summary::Summary;
use pneuflex_report::{Report, render};

use crate::args::ViewArguments;
use crate::case_file::{CaseFile, is_model};
use crate::error::{CliError, InputError, say};
use crate::folder::OutputFolder;
use crate::memory::Estimate;

/// Name of the report in a result folder.
pub const REPORT: &str = "report.html";

/// An estimate is no further away from a number of nodes than this factor, and a little for the smallest meshes.
const LARGEST_ERROR: f64 = 2.0;
const FEW_NODES: f64 = 1e4;

/// Writes the report of a result folder and says where it is.
///
/// # Errors
/// A folder that is none of this program's, files that are missing or damaged, a report that cannot be written.
pub fn view(arguments: &ViewArguments) -> Result<(), CliError> {
    // First what can fail without a trace: a folder that is none of ours is not touched.
    let page = page(&arguments.results)?;
    let folder = OutputFolder::to_add_to(&arguments.results)?;
    folder.write(REPORT, page).map_err(CliError::Output)?;
    say(&format!("wrote {}", folder.path().join(REPORT).display()));
    Ok(())
}

/// Writes the report of a run's folder; returns its path.
///
/// # Errors
/// As for [`view`].
pub fn write_report(folder: &OutputFolder) -> Result<PathBuf, CliError> {
    folder.write(REPORT, page(folder.path())?).map_err(CliError::Output)?;
    Ok(folder.path().join(REPORT))
}

/// The text of the report of a result folder.
fn page(folder: &Path) -> Result<String, CliError> {
    let summary = read_summary(folder)?;
    let case_path = folder.join("case.toml");
    if is_model(&case_path) {
        return Err(
            InputError::file(folder, "there are no reports of models yet; open fields/series.pvd in ParaView").into()
        );
    }
    let file = CaseFile::load(&case_path, &[])?;
    // Checked before anything is built: a damaged length may stand for a mesh beyond all memory.
    let (expected, found) = (Estimate::of(&file.case).unknowns / 3.0, summary.mesh.nodes as f64);
    let fits = expected <= LARGEST_ERROR * found + FEW_NODES;
    if !fits {
        let why = format!("its mesh has about {expected:.3e} nodes, that of summary.json has {found}");
        return Err(damaged(&case_path, why).into());
    }
    let problem = Problem::from_case(&file.case).map_err(|e| file.out_of_range(&e))?;
    let states = read_states(folder, &file.case, &problem, &summary)?;
    let report = Report { case: &file.case, problem: &problem, summary: &summary, states: states.as_deref() };
    Ok(render(&report).map_err(|e| InputError::file(folder, e))?)
}

fn read_summary(folder: &Path) -> Result<Summary, InputError> {
    let path = folder.join("summary.json");
    if !folder.is_dir() || !path.exists() {
        let what = if folder.is_dir() { "holds no summary.json" } else { "is no folder" };
        let help = "name the folder that `pneuflex run` wrote, e.g. out/actuator";
        return Err(InputError::file(folder, format!("not a result folder: it {what}")).help(Some(help.into())));
    }
    let summary: Summary = serde_json::from_str(&read(&path)?).map_err(|e| damaged(&path, e))?;
    match summary.steps.iter().find(|step| step.converged && step.landed.is_none()) {
        Some(step) => Err(damaged(&path, format!("results are missing at {} kPa", step.pressure_kpa))),
        None => Ok(summary),
    }
}

/// The fields at every landed pressure; `None` if the case asked for none.
fn read_states(
    folder: &Path,
    case: &Case,
    problem: &Problem,
    summary: &Summary,
) -> Result<Option<Vec<State>>, InputError> {
    if !case.output.fields {
        return Ok(None);
    }
    let has_walls = problem.contact_pairs.iter().any(|pair| !pair.slave.is_empty());
    let state = |number: usize, pressure_kpa: f64| {
        let path = |name: &str| folder.join(format!("fields/{name}_{number:02}.vtu"));
        let body_path = path("step");
        let body = read_grid(&body_path)?;
        let is_same = (body.time - pressure_kpa).abs() <= 1e-9;
        if !is_same {
            return Err(damaged(&body_path, format!("it is of {} kPa instead of {pressure_kpa}", body.time)));
        }
        let walls = has_walls.then(|| read_grid(&path("contact"))).transpose()?;
        State::from_grids(problem, &body, walls.as_ref()).map_err(|e| damaged(&body_path, e))
    };
    let landed = summary.landed().enumerate();
    landed.map(|(i, (pressure, _))| state(i + 1, pressure)).collect::<Result<_, _>>().map(Some)
}

fn read_grid(path: &Path) -> Result<Grid, InputError> {
    Grid::from_vtu(&read(path)?).map_err(|e| damaged(path, e))
}

fn read(path: &Path) -> Result<String, InputError> {
    fs::read_to_string(path).map_err(|e| {
        InputError::file(path, format!("cannot be read: {e}"))
            .help(Some("run the case again to have a complete result folder".into()))
    })
}

fn damaged(path: &Path, why: impl std::fmt::Display) -> InputError {
    InputError::file(path, format!("damaged: {why}"))
        .help(Some("run the case again to have a complete result folder".into()))
}
