//! What commands are given: an actuator's case file, a model file, or a deck, as something that can be solved.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use pneuflex_deck::DeckError;
use pneuflex_mesh::Actuator;
use pneuflex_model::model_file::{Model, Source};
use pneuflex_model::{Case, CaseError, Formulation, Probe, Problem, Solver};
use pneuflex_post::contact;

use crate::case_file::{CaseFile, Written, is_model};
use crate::error::InputError;
use crate::memory::Estimate;

/// Folder within a result folder that the files of a body are copied to.
pub const INPUT: &str = "input";

/// Names of included files as a deck has them, in the order of their copies.
pub const INCLUDED: &str = "included.json";

/// Depth by which rounding may make an obstacle that just touches overlap the body, mm.
const MOST_OVERLAP: f64 = 1e-9;

/// Bytes that a deck or a mesh may have.
const MOST_BYTES: u64 = 2_000_000_000;

/// Whether a body of a size may be built, and what to warn of.
pub type Guard<'a> = &'a dyn Fn(Estimate) -> Result<Option<String>, InputError>;

/// A problem with what is to be found out about it.
#[derive(Debug)]
pub struct Study {
    /// Title, repeated in the output.
    pub title: String,
    /// What is solved.
    pub problem: Problem,
    /// Times to land on; pressures in kPa for actuators.
    pub times: Vec<f64>,
    /// Solver settings.
    pub solver: Solver,
    /// Points whose displacement is reported.
    pub probes: Vec<Probe>,
    /// Whether field files are written.
    pub fields: bool,
    /// How it was described.
    pub description: Description,
    /// What to say before it is solved: sizes, and what was understood in another way than it may be meant.
    pub notes: Vec<String>,
    /// File that it was read from.
    pub path: PathBuf,
}

/// How a problem was described.
#[derive(Debug)]
pub enum Description {
    /// By an actuator's parameters.
    Actuator(Box<Case>),
    /// By a model file, and the files of its body.
    Model(Box<Model>, Files),
}

/// The files of a body as they were read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    /// Name of the first one, without folder.
    pub name: String,
    /// Its bytes; empty if the body is made of parameters.
    pub bytes: Vec<u8>,
    /// Included files by the names that the deck has for them.
    pub included: Vec<(String, Vec<u8>)>,
}

impl Study {
    /// Reads a case, a model or a deck. `force` goes on though the memory may not do.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(path: &Path, changes: &[String], force: bool) -> Result<Self, Vec<InputError>> {
        Self::guarded(path, changes, &|estimate| estimate.guard(force))
    }

    /// The same; `guard` says from its size whether a body may be built, and what to warn of.
    ///
    /// # Errors
    /// Everything that is wrong with it, or what the guard says.
    pub fn guarded(path: &Path, changes: &[String], guard: Guard<'_>) -> Result<Self, Vec<InputError>> {
        if is_deck(path) {
            if let Some(change) = changes.first() {
                let help = "write a model file around the deck: [model] with file = \"...\"".to_owned();
                return Err(vec![
                    InputError::new(format!("--set {change}: a deck has no keys to change")).help(Some(help)),
                ]);
            }
            let file = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            let model = Model { model: Some(Source { file, scale: 1.0 }), ..Model::default() };
            return Self::of_model(path, model, guard, &|error| InputError::file(path, error));
        }
        if is_model(path) {
            let written: Written<Model> = Written::load(path, changes)?;
            return Self::of_model(path, written.case.clone(), guard, &|error| written.out_of_range(&error));
        }
        Self::of_case(CaseFile::load(path, changes)?, guard)
    }

    fn of_case(file: CaseFile, guard: Guard<'_>) -> Result<Self, Vec<InputError>> {
        let warning = guard(Estimate::of(&file.case))?;
        let problem = Problem::from_case(&file.case).map_err(|e| file.out_of_range(&e))?;
        if let Some(overlap) = overlap(&problem) {
            return Err(vec![file.out_of_range(&overlap)]);
        }
        let notes = warning.into_iter().map(|warning| format!("warning: {warning}")).collect();
        let path = file.path().to_owned();
        Ok(Self { notes, ..Self::of_actuator(&path, file.case, problem) })
    }

    /// An actuator's case whose problem is known.
    pub fn of_actuator(path: &Path, case: Case, problem: Problem) -> Self {
        Self {
            title: case.title.clone(),
            problem,
            times: case.load.pressure_kpa.clone(),
            solver: case.solver.clone(),
            probes: case.probes.clone(),
            fields: case.output.fields,
            path: path.to_owned(),
            description: Description::Actuator(Box::new(case)),
            notes: Vec::new(),
        }
    }

    fn of_model(
        path: &Path,
        model: Model,
        guard: Guard<'_>,
        say: &dyn Fn(CaseError) -> InputError,
    ) -> Result<Self, Vec<InputError>> {
        let mut notes = Vec::new();
        let mut warnings = Vec::new();
        let mut check = |estimate: Estimate| -> Result<(), InputError> {
            warnings.extend(guard(estimate)?.map(|warning| format!("warning: {warning}")));
            Ok(())
        };
        let (mut title, mut files, mut schedule) = (model.title.clone(), Files::default(), None);
        let body = match (&model.model, &model.actuator) {
            (Some(source), _) => {
                let body = path.parent().unwrap_or(Path::new("")).join(&source.file);
                let read = read_body(&body, source)?;
                check(Estimate::of_body(&read.problem.mesh))?;
                notes.extend(read.notes);
                if title.is_empty() {
                    title = read.title;
                }
                (files, schedule) = (read.files, read.schedule);
                read.problem
            }
            (None, Some(actuator)) => {
                let formulation = model.mesh.formulation();
                let size = model.mesh.mesh_size(actuator);
                let material = model.material.clone().unwrap_or_default();
                check(Estimate::of_actuator(actuator, formulation.element_kind(), &size))?;
                Problem::from_actuator(actuator, &size, formulation, material, Default::default())
                    .map_err(|error| say(error.into()))?
            }
            // The ranges of a model file ask for one of them.
            (None, None) => return Err(vec![InputError::file(path, "there is neither [model] nor [actuator]")]),
        };
        notes.extend(warnings);
        let schedule = schedule.as_ref().map(|(times, first): &(Vec<f64>, f64)| (&times[..], *first));
        let study =
            model.study(body, schedule).map_err(|errors| errors.into_iter().map(say).collect::<Vec<InputError>>())?;
        if let Some(overlap) = overlap(&study.problem) {
            return Err(vec![say(overlap)]);
        }
        Ok(Self {
            title,
            problem: study.problem,
            times: study.times,
            solver: study.solver,
            probes: model.probes.clone(),
            fields: model.output.fields,
            path: path.to_owned(),
            description: Description::Model(Box::new(model), files),
            notes,
        })
    }

    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        self.path.file_stem().map_or_else(|| "case".into(), |s| s.to_string_lossy().into_owned())
    }

    /// The actuator that the body is, if it is one.
    pub fn actuator(&self) -> Option<&Actuator> {
        match &self.description {
            Description::Actuator(case) => Some(&case.actuator),
            Description::Model(model, _) => model.actuator.as_ref(),
        }
    }

    /// The text of the resolved case, with every default; a model's refers to the copies of its files.
    ///
    /// # Errors
    /// Values that TOML cannot hold.
    pub fn resolved(&self) -> Result<String, String> {
        match &self.description {
            Description::Actuator(case) => toml::to_string(&case.resolved()),
            Description::Model(model, files) => {
                let mut model = (**model).clone();
                model.title.clone_from(&self.title);
                if let Some(source) = &mut model.model {
                    source.file = format!("{INPUT}/{}", files.name);
                }
                toml::to_string(&model)
            }
        }
        .map_err(|error| error.to_string())
    }
}

/// A body that was read.
struct Body {
    title: String,
    problem: Problem,
    schedule: Option<(Vec<f64>, f64)>,
    notes: Vec<String>,
    files: Files,
}

/// The first obstacle that overlaps the body at rest, if there is one: no load path could begin there.
fn overlap(problem: &Problem) -> Option<CaseError> {
    if problem.obstacles.is_empty() {
        return None;
    }
    let at_rest = contact::evaluate(problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).ok()?;
    let deep = |(_, found): &(usize, &contact::ObstacleForce)| found.max_penetration_mm > MOST_OVERLAP;
    let (number, found) = at_rest.obstacles.iter().enumerate().find(deep)?;
    let allowed = format!("it overlaps the body at rest by {:.4} mm", found.max_penetration_mm);
    Some(CaseError { key: format!("obstacle[{number}].name"), value: format!("{:?}", found.name), allowed })
}

fn is_deck(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("inp"))
}

fn read_body(path: &Path, source: &Source) -> Result<Body, Vec<InputError>> {
    let bytes = read(path).map_err(|why| InputError::file(path, why))?;
    let shown = path.display().to_string();
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = Files { name, bytes: bytes.clone(), included: Vec::new() };
    if is_deck(path) {
        if source.scale != 1.0 {
            return Err(vec![InputError::new("model.scale = must be 1 for a deck: decks are in mm, N, MPa")]);
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let copies = copies(folder);
        let mut include = |name: &str| {
            let copy = copies.iter().position(|known| known == name).map(included_name);
            let bytes = read(&folder.join(copy.unwrap_or_else(|| name.to_owned())))?;
            files.included.push((name.to_owned(), bytes.clone()));
            Ok(bytes)
        };
        let deck = pneuflex_deck::read(&shown, bytes, &mut include).map_err(said)?;
        return Ok(Body {
            title: deck.title,
            problem: deck.problem,
            schedule: Some((deck.schedule.times, deck.schedule.first_increment)),
            notes: deck.notes.iter().map(ToString::to_string).collect(),
            files,
        });
    }
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("msh")) {
        let help = "decks end in .inp, meshes of Gmsh in .msh".to_owned();
        return Err(vec![InputError::file(path, "is neither a deck nor a mesh").help(Some(help))]);
    }
    let read = pneuflex_deck::msh::read(&shown, &bytes).map_err(said)?;
    let kind = read.mesh.kind;
    let Some(formulation) = Formulation::of_kind(kind) else {
        return Err(vec![InputError::file(path, format!("{} cannot be solved", kind.words()))]);
    };
    let mesh = read.mesh.map_nodes(|x| x.map(|t| source.scale * t));
    let problem = Problem::body(mesh, formulation, Default::default());
    let notes = read.notes.iter().map(ToString::to_string).collect();
    Ok(Body { title: String::new(), problem, schedule: None, notes, files })
}

/// Name of the copy of an included file.
pub fn included_name(number: usize) -> String {
    format!("included_{:03}.inp", number + 1)
}

/// Names of included files of which copies lie in a folder.
fn copies(folder: &Path) -> Vec<String> {
    fs::read(folder.join(INCLUDED)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let cannot = |e: std::io::Error| format!("cannot be read: {e}");
    fs::File::open(path).map_err(cannot)?.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(cannot)?;
    if bytes.len() as u64 > MOST_BYTES { Err("is larger than 2 GB".into()) } else { Ok(bytes) }
}

fn said(errors: Vec<DeckError>) -> Vec<InputError> {
    errors.into_iter().map(|error| InputError::new(error.to_string())).collect()
}
