//! The report of a result folder, one page that shows it in a browser.

use std::fs;
use std::path::{Path, PathBuf};

use pneuflex_model::{Clock, LoadParameter};
use pneuflex_post::fields::contact_faces;
use pneuflex_post::vtu::Grid;
use pneuflex_report::comparison::Comparison;
use pneuflex_report::inputs::{Group, Row, groups};
use pneuflex_report::state::State;
use pneuflex_report::summary::{FORMAT, Summary};
use pneuflex_report::{Report, render};

use crate::analysis::{Analysis, Description};
use crate::error::Error;
use crate::folder::{COMPARISON, COMPARISON_PICTURE, GRADIENTS, OutputFolder, REPORT};
use crate::input_error::InputError;
use crate::memory::Estimate;
use crate::on_the_way::on_the_way_number;
use crate::overview::OverviewRow;
use crate::study::Study;
use crate::words::plural;

/// An estimate is no further away from a number of nodes than this factor, and a little for the smallest meshes.
const LARGEST_ERROR: f64 = 2.0;
const FEW_NODES: f64 = 1e4;

/// Kinds of named sets, of which a page needs no list.
const SETS: [&str; 3] = ["nodes", "elements", "faces"];

/// Writes `report.html` into a result folder; returns its path.
///
/// # Errors
/// [`Error::Input`]: a folder that is none of this program's, files that are missing or damaged. [`Error::Results`]: a report that cannot
/// be written.
pub fn write_report(folder: &OutputFolder) -> Result<PathBuf, Error> {
    folder.write(REPORT, report_page(folder.path())?)?;
    Ok(folder.path().join(REPORT))
}

/// The text of the report of a result folder.
///
/// # Errors
/// [`Error::Input`]: a folder that is none of this program's, files that are missing or damaged.
pub fn report_page(folder: &Path) -> Result<String, Error> {
    let RecordedRun { analysis, summary, states } = RecordedRun::read(folder)?;
    let report = Report {
        title: &analysis.title,
        about: &about(&analysis),
        inputs: &inputs(&analysis),
        problem: &analysis.problem,
        summary: &summary,
        states: states.as_deref(),
    };
    Ok(render(&report).map_err(|e| InputError::about_file(folder, e))?)
}

/// What a result folder holds, read and checked.
pub(crate) struct RecordedRun {
    pub(crate) analysis: Analysis,
    pub(crate) summary: Summary,
    /// The fields at every reached pressure or time; `None` if none were asked for.
    pub(crate) states: Option<Vec<State>>,
}

impl RecordedRun {
    /// Reads a folder.
    ///
    /// # Errors
    /// [`Error::Input`]: a folder that is none of this program's, files that are missing or damaged.
    pub(crate) fn read(folder: &Path) -> Result<Self, Error> {
        let mut summary = read_summary(folder)?;
        let gradients = folder.join(GRADIENTS);
        if gradients.exists() {
            summary.gradients = serde_json::from_str(&read(&gradients)?).map_err(|e| damaged(&gradients, e))?;
        }
        let comparison = folder.join(COMPARISON);
        if comparison.exists() {
            let mut found: Comparison =
                serde_json::from_str(&read(&comparison)?).map_err(|e| damaged(&comparison, e))?;
            found.picture = read(&folder.join(COMPARISON_PICTURE))?;
            summary.comparison = Some(found);
        }
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
        let analysis = Study::load(&case_path)?.build_guarded(&has_nodes_of_summary)?;
        let states = read_states(folder, &analysis, &summary)?;
        Ok(Self { analysis, summary, states })
    }
}

/// An analysis in a few words.
fn about(analysis: &Analysis) -> String {
    match (&analysis.description, analysis.actuator()) {
        (_, Some(actuator)) => plural(actuator.chambers, "chamber"),
        (Description::Model(_, files), None) => files.name.clone(),
        (Description::Actuator(_) | Description::Body(_), None) => String::new(),
    }
}

/// The keys of a case; those of a model with what its body was understood as.
fn inputs(analysis: &Analysis) -> Vec<Group> {
    let model = match &analysis.description {
        Description::Actuator(case) => return groups(case),
        Description::Model(model, _) | Description::Body(model) => model,
    };
    let row = |OverviewRow { kind, text }| Row { key: String::from(kind), meaning: "", value: text, unit: "" };
    let understood = analysis.overview().rows.into_iter().filter(|row| !SETS.contains(&row.kind));
    let mut groups = groups(model);
    groups.push(Group { heading: "Understood as".into(), rows: understood.map(row).collect() });
    groups
}

/// What the summary of a result folder says, checked.
pub(crate) fn read_summary(folder: &Path) -> Result<Summary, InputError> {
    let path = folder.join("summary.json");
    if !folder.is_dir() || !path.exists() {
        let what = if folder.is_dir() { "holds no summary.json" } else { "is no folder" };
        let help = "name the folder that `pneuflex run` wrote, e.g. out/actuator";
        return Err(
            InputError::about_file(folder, format!("not a result folder: it {what}")).with_help(Some(help.into()))
        );
    }
    let summary: Summary = serde_json::from_str(&read(&path)?).map_err(|e| damaged(&path, e))?;
    if summary.format != FORMAT {
        let why = format!(
            "it has the format {} instead of {FORMAT}: another version of the program wrote it",
            summary.format
        );
        let help = "solve the case again, or show it with that version".to_owned();
        return Err(InputError::about_file(&path, why).with_help(Some(help)));
    }
    let steps = || summary.steps.iter().chain(&summary.on_the_way);
    if steps().any(|step| step.time.is_none() && step.pressure_kpa.is_none()) {
        return Err(damaged(&path, "a step has neither time nor pressure_kpa"));
    }
    match steps().find(|step| step.converged && step.reached.is_none()) {
        Some(step) => {
            let clock = if step.time.is_some() { Clock::Steps } else { Clock::Pressure };
            Err(damaged(&path, format!("results are missing at {}", clock.words(LoadParameter(step.when())))))
        }
        None => Ok(summary),
    }
}

/// The fields at every reached pressure or time; `None` if none were asked for.
fn read_states(folder: &Path, analysis: &Analysis, summary: &Summary) -> Result<Option<Vec<State>>, InputError> {
    if !analysis.output.fields {
        return Ok(None);
    }
    let problem = &analysis.problem;
    let has_walls = !contact_faces(problem).is_empty();
    let state = |number: String, time: f64| {
        let path = |name: &str| folder.join(format!("fields/{name}_{number}.vtu"));
        let body_path = path("step");
        let body = read_grid(&body_path)?;
        let is_same = (body.time - time).abs() <= 1e-9;
        if !is_same {
            let [found, expected] = [body.time, time].map(|time| problem.clock.words(LoadParameter(time)));
            return Err(damaged(&body_path, format!("it is of {found} instead of {expected}")));
        }
        let walls = has_walls.then(|| read_grid(&path("contact"))).transpose()?;
        State::from_grids(problem, &body, walls.as_ref()).map_err(|e| damaged(&body_path, e))
    };
    let requested = summary.steps.iter().filter(|step| step.reached.is_some()).count();
    let number = |i: usize| if i < requested { format!("{:02}", i + 1) } else { on_the_way_number(i + 1 - requested) };
    let reached = summary.reached().enumerate();
    reached.map(|(i, (time, _))| state(number(i), time)).collect::<Result<_, _>>().map(Some)
}

fn read_grid(path: &Path) -> Result<Grid, InputError> {
    Grid::from_vtu(&read(path)?).map_err(|e| damaged(path, e))
}

pub(crate) fn read(path: &Path) -> Result<String, InputError> {
    fs::read_to_string(path).map_err(|e| {
        InputError::about_file(path, format!("cannot be read: {e}"))
            .with_help(Some("run the case again to have a complete result folder".into()))
    })
}

pub(crate) fn damaged(path: &Path, why: impl std::fmt::Display) -> InputError {
    InputError::about_file(path, format!("damaged: {why}"))
        .with_help(Some("run the case again to have a complete result folder".into()))
}
