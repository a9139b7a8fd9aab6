//! `pneuflex view`: the report of a result folder, `report.html`. `pneuflex run` writes it the same way at its end.

use std::fs;
use std::path::{Path, PathBuf};

use pneuflex_mesh::actuator::Part;
use pneuflex_model::Clock;
use pneuflex_post::fields::contact_faces;
use pneuflex_post::vtu::Grid;
use pneuflex_report::inputs::{Group, Row, groups};
use pneuflex_report::state::State;
use pneuflex_report::summary::Summary;
use pneuflex_report::{Report, render};

use crate::args::ViewArguments;
use crate::check::model::understood;
use crate::check::plural;
use crate::error::{CliError, InputError, say};
use crate::folder::OutputFolder;
use crate::memory::Estimate;
use crate::study::{Description, Study};

/// Name of the report in a result folder.
pub const REPORT: &str = "report.html";

/// An estimate is no further away from a number of nodes than this factor, and a little for the smallest meshes.
const LARGEST_ERROR: f64 = 2.0;
const FEW_NODES: f64 = 1e4;

/// Kinds of named sets, of which a page needs no list.
const SETS: [&str; 3] = ["nodes", "elements", "faces"];

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
    // Checked before anything is built: a damaged length may stand for a mesh beyond all memory.
    let has_nodes_of_summary = |estimate: Estimate| {
        let (expected, found) = (estimate.unknowns / 3.0, summary.mesh.nodes as f64);
        if expected <= LARGEST_ERROR * found + FEW_NODES {
            return Ok(None);
        }
        let why = format!("its mesh has about {expected:.3e} nodes, that of summary.json has {found}");
        Err(damaged(&case_path, why))
    };
    let study = Study::guarded(&case_path, &[], &has_nodes_of_summary)?;
    let states = read_states(folder, &study, &summary)?;
    let report = Report {
        title: &study.title,
        about: &about(&study),
        inputs: &inputs(&study),
        mirrored: study.actuator().is_some_and(|actuator| actuator.part == Part::Half),
        problem: &study.problem,
        summary: &summary,
        states: states.as_deref(),
    };
    Ok(render(&report).map_err(|e| InputError::file(folder, e))?)
}

/// A study in a few words.
fn about(study: &Study) -> String {
    match (&study.description, study.actuator()) {
        (_, Some(actuator)) => plural(actuator.chambers, "chamber"),
        (Description::Model(_, files), None) => files.name.clone(),
        (Description::Actuator(_), None) => String::new(),
    }
}

/// The keys of a case; those of a model with what its body was understood as.
fn inputs(study: &Study) -> Vec<Group> {
    let model = match &study.description {
        Description::Actuator(case) => return groups(case),
        Description::Model(model, _) => model,
    };
    let row = |(key, value): (&str, String)| Row { key: key.into(), meaning: "", value, unit: "" };
    let understood = understood(study).into_iter().filter(|(kind, _)| !SETS.contains(kind));
    let mut groups = groups(model);
    groups.push(Group { heading: "Understood as".into(), rows: understood.map(row).collect() });
    groups
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
        Some(step) => {
            let clock = if step.time.is_some() { Clock::Steps } else { Clock::Pressure };
            Err(damaged(&path, format!("results are missing at {}", clock.words(step.when()))))
        }
        None => Ok(summary),
    }
}

/// The fields at every landed pressure or time; `None` if none were asked for.
fn read_states(folder: &Path, study: &Study, summary: &Summary) -> Result<Option<Vec<State>>, InputError> {
    if !study.fields {
        return Ok(None);
    }
    let problem = &study.problem;
    let has_walls = !contact_faces(problem).is_empty();
    let state = |number: usize, time: f64| {
        let path = |name: &str| folder.join(format!("fields/{name}_{number:02}.vtu"));
        let body_path = path("step");
        let body = read_grid(&body_path)?;
        let is_same = (body.time - time).abs() <= 1e-9;
        if !is_same {
            let [found, expected] = [body.time, time].map(|time| problem.clock.words(time));
            return Err(damaged(&body_path, format!("it is of {found} instead of {expected}")));
        }
        let walls = has_walls.then(|| read_grid(&path("contact"))).transpose()?;
        State::from_grids(problem, &body, walls.as_ref()).map_err(|e| damaged(&body_path, e))
    };
    let landed = summary.landed().enumerate();
    landed.map(|(i, (time, _))| state(i + 1, time)).collect::<Result<_, _>>().map(Some)
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
