//! A boundary-value problem with what is to be found out about it.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use pneuflex_deck::Extent;
use pneuflex_mesh::{Actuator, Division, Hollow, build_actuator_with};
use pneuflex_model::load::Load;
use pneuflex_model::model_file::Model;
use pneuflex_model::{
    Case, CaseError, Contact, Formulation, LoadParameter, Output, Probe, Problem, Solver, Undividable,
};
use pneuflex_newton::{ConvergedState, TieError, glued};
use pneuflex_post::summary::{Described, StepSummary, probe_sites};

use crate::accuracy::{Expected, expected};
use crate::body_file::{is_deck, read_body};
use crate::cad::is_part;
use crate::caution::cautions;
use crate::derived;
use crate::diagnosis::{Subject, Warning, warnings};
use crate::document::CaseFile;
use crate::error::Error;
use crate::error_estimate::ErrorEstimate;
use crate::files::{Files, INPUT};
use crate::holding;
use crate::input_error::InputError;
use crate::memory::Estimate;
use crate::recorded_mesh::{self, RecordedMesh};
use crate::refusals::refusals;
use crate::store::Store;
use crate::vocabulary::Vocabulary;

/// Whether a body of a size may be built, and what to warn of.
pub type Guard<'a> = &'a dyn Fn(Estimate) -> Result<Option<String>, InputError>;

/// A meshed body with materials, supports and loads, the positions on the load path at which results are wanted, and solver settings: ready to be solved,
/// any number of times.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Title, repeated in the output.
    pub title: String,
    /// What is solved.
    pub problem: Problem,
    /// Positions on the load path to reach: pressures in kPa for actuators, times of a schedule for others.
    pub requested: Vec<LoadParameter>,
    /// Solver settings.
    pub solver: Solver,
    /// Points whose displacement is reported.
    pub probes: Vec<Probe>,
    /// Which files are written where the results are recorded.
    pub output: Output,
    /// How it was described.
    pub description: Description,
    /// Hollow spaces of the body that were found, by the names of the sets of their walls.
    pub hollows: Vec<(String, Hollow)>,
    /// What to know before it is solved: sizes, and what was understood in another way than it may be meant.
    pub notes: Vec<String>,
    /// File that it was read from, or what stands for it.
    pub path: PathBuf,
    /// What a model's tables were added to; `None` for an actuator's case.
    pub(crate) undressed: Option<Box<Undressed>>,
}

/// A body as a model's tables find it.
#[derive(Clone, Debug)]
pub(crate) struct Undressed {
    /// The body, with what a deck says of loads and supports.
    pub(crate) body: Problem,
    /// Times and first increment of a deck.
    pub(crate) schedule: Option<(Vec<f64>, f64)>,
}

/// How a problem was described.
#[derive(Clone, Debug)]
pub enum Description {
    /// By an actuator's parameters.
    Actuator(Box<Case>),
    /// By a model file, and the files of its body.
    Model(Box<Model>, Files),
    /// By a model whose body was built in memory.
    Body(Box<Model>),
}

impl Description {
    /// The tables of a model; `None` for an actuator's case.
    pub fn model(&self) -> Option<&Model> {
        match self {
            Self::Actuator(_) => None,
            Self::Model(model, _) | Self::Body(model) => Some(model),
        }
    }

    /// An actuator's case; `None` for a model.
    pub fn case(&self) -> Option<&Case> {
        match self {
            Self::Actuator(case) => Some(case),
            Self::Model(..) | Self::Body(_) => None,
        }
    }
}

impl Analysis {
    pub(crate) fn of_case_file(file: &CaseFile, guard: Guard<'_>) -> Result<Self, Vec<InputError>> {
        let warning = guard(Estimate::of(&file.case))?;
        let problem = Problem::from_case(&file.case).map_err(|e| file.out_of_range(&e))?;
        let refused = refusals(&problem, &file.case.probes);
        if !refused.is_empty() {
            return Err(refused.iter().map(|error| file.out_of_range(error)).collect());
        }
        let notes = warning.into_iter().map(|warning| format!("warning: {warning}")).collect();
        Self { notes, ..Self::of_case(file.path(), file.case.clone(), problem) }.held()
    }

    /// An actuator's case with its problem, e.g. on another mesh than the case's own. `path` stands for its file.
    pub fn of_case(path: &Path, case: Case, problem: Problem) -> Self {
        Self {
            title: case.title.clone(),
            problem,
            requested: case.load.pressure_kpa.iter().copied().map(LoadParameter).collect(),
            solver: case.solver.clone(),
            probes: case.probes.clone(),
            output: case.output.clone(),
            path: path.to_owned(),
            description: Description::Actuator(Box::new(case)),
            hollows: Vec::new(),
            notes: Vec::new(),
            undressed: None,
        }
    }

    /// A model file; `say` turns an error of a key into one with its place.
    pub(crate) fn of_model(
        store: &Store,
        path: &Path,
        model: Model,
        guard: Guard<'_>,
        say: &dyn Fn(CaseError) -> InputError,
    ) -> Result<Self, Vec<InputError>> {
        let mut notes = Vec::new();
        let (mut title, mut files, mut schedule) = (model.title.clone(), Files::default(), None);
        let (body, warning) = match (&model.model, &model.actuator) {
            (Some(source), _) => {
                let body = store.beside(path, &source.file);
                // A deck that is solved as it is must hold all of its problem.
                let extent = if is_deck(path) { Extent::Problem } else { Extent::Body };
                let read = read_body(store, &body, source, model.mesh.element, extent)?;
                let help = if is_part(&body) { "choose a larger model.size" } else { "mesh it with larger elements" };
                let warning = guard(Estimate::of_body(&read.problem.mesh, &read.problem.equations))
                    .map_err(|error| error.with_help(Some(help.to_owned())))?;
                notes.extend(read.notes);
                if title.is_empty() {
                    title = read.title;
                }
                (files, schedule) = (read.files, read.schedule);
                (read.problem, warning)
            }
            (None, Some(actuator)) => {
                let formulation = model.mesh.formulation();
                let size = model.mesh.mesh_size(actuator);
                let material = model.material.clone().unwrap_or_default();
                let (kind, cuts) = (formulation.element_kind(), model.cuts());
                let warning = guard(Estimate::of_actuator(actuator, kind, &size, &cuts))?;
                let mesh = build_actuator_with(actuator, &size, kind, &cuts).map_err(|error| say(error.into()))?;
                let contact = Contact::of_actuator(&material, actuator);
                (Problem::of_actuator_mesh(actuator.chambers, mesh, formulation, material, contact), warning)
            }
            // The ranges of a model file ask for one of them.
            (None, None) => {
                return Err(InputError::about_file(path, "there is neither [model] nor [actuator]").into());
            }
        };
        notes.extend(warning.map(|warning| format!("warning: {warning}")));
        let said = |errors: Vec<CaseError>| errors.into_iter().map(say).collect::<Vec<InputError>>();
        let analysis = Self::of_body(path, model.clone(), body, schedule).map_err(said)?;
        notes.extend(analysis.notes.iter().cloned());
        Self { title, notes, description: Description::Model(Box::new(model), files), ..analysis }.held()
    }

    /// The same, once something holds every part of the body.
    ///
    /// # Errors
    /// The rigid motions that nothing holds.
    pub(crate) fn held(mut self) -> Result<Self, Vec<InputError>> {
        let warning = holding::check(&self.problem, self.vocabulary())?;
        self.check_error_estimate()?;
        self.notes.extend(warning.map(|warning| format!("warning: {warning}")));
        Ok(self)
    }

    /// What things are called where it was written.
    pub fn vocabulary(&self) -> Vocabulary {
        match &self.description {
            Description::Actuator(_) => Vocabulary::CaseFile,
            Description::Body(_) => Vocabulary::Program,
            Description::Model(..) if is_deck(&self.path) => Vocabulary::Deck,
            Description::Model(model, _) => match &model.model {
                None => Vocabulary::ActuatorModel,
                Some(source) if is_deck(source.file.as_ref()) => Vocabulary::DeckModel,
                Some(_) => Vocabulary::MeshModel,
            },
        }
    }

    /// A model on a body that is there.
    pub(crate) fn of_body(
        path: &Path,
        model: Model,
        body: Problem,
        schedule: Option<(Vec<f64>, f64)>,
    ) -> Result<Self, Vec<CaseError>> {
        let undressed = Some(Box::new(Undressed { body: body.clone(), schedule: schedule.clone() }));
        let schedule = schedule.as_ref().map(|(times, first)| (&times[..], *first));
        let study = model.study(body, schedule)?;
        let refused = refusals(&study.problem, &model.probes);
        if !refused.is_empty() {
            return Err(refused);
        }
        let value = || model.model.as_ref().map_or(String::new(), |source| source.file.to_string());
        let said =
            |why: TieError| vec![CaseError { key: "model.file".into(), value: value(), allowed: why.to_string() }];
        let (problem, of_ties) = glued(study.problem).map_err(said)?;
        Ok(Self {
            title: model.title.clone(),
            problem,
            requested: study.times.into_iter().map(LoadParameter).collect(),
            solver: study.solver,
            probes: model.probes.clone(),
            output: model.output.clone(),
            path: path.to_owned(),
            description: Description::Body(Box::new(model)),
            hollows: study.hollows,
            notes: study.notes.into_iter().chain(of_ties).collect(),
            undressed,
        })
    }

    /// The same with every element divided into eight, and how. Probes stay at their nodes.
    ///
    /// # Errors
    /// What says nothing of a finer mesh, or cannot be put on it.
    pub(crate) fn divided(&self) -> Result<(Self, Division), Vec<InputError>> {
        let refused = |why: Undividable| {
            let help = match why {
                Undividable::Torn(_) => "merge the nodes of neighbouring elements",
                Undividable::Equations => "mesh the body finer where it comes from, and compare the results",
                Undividable::Held(_) => "mesh it with two elements or more between them",
                Undividable::Forces => {
                    "let a [[traction]], [[pressure]] or [[force]] of a model file around the deck act on a surface"
                }
            };
            vec![InputError::new(format!("the mesh cannot be divided: {why}")).with_help(Some(help.to_owned()))]
        };
        let probes = self.probes_at_nodes();
        let (Some(model), Some(undressed)) = (self.description.model(), &self.undressed) else {
            let (problem, division) = self.problem.divided().map_err(refused)?;
            return Ok((Self { problem, probes, ..self.clone() }, division));
        };
        if let Some(why) = self.says_nothing_of_finer_meshes() {
            return Err(refused(why));
        }
        let (body, division) = undressed.body.divided().map_err(refused)?;
        let said = |errors: Vec<CaseError>| {
            let of_finer =
                |error: CaseError| InputError::new(format!("on the divided mesh: {error}")).of_key(&error.key);
            errors.into_iter().map(of_finer).collect::<Vec<_>>()
        };
        let finer = Self::of_body(&self.path, model.clone(), body, undressed.schedule.clone()).map_err(said)?;
        let (title, description) = (self.title.clone(), self.description.clone());
        Ok((Self { title, description, probes, ..finer }, division))
    }

    /// What it says of single nodes, and so nothing of those that a finer mesh has between them.
    pub(crate) fn says_nothing_of_finer_meshes(&self) -> Option<Undividable> {
        let (model, undressed) = (self.description.model()?, self.undressed.as_ref()?);
        let body = &undressed.body;
        if !(model.equations.is_empty() && body.equations.is_empty() && body.distances.is_empty()) {
            return Some(Undividable::Equations);
        }
        let is_force = |load: &Load| matches!(load, Load::Force { .. });
        undressed.body.loads.iter().any(is_force).then_some(Undividable::Forces)
    }

    /// Probes at the nodes that they take on this mesh.
    pub(crate) fn probes_at_nodes(&self) -> Vec<Probe> {
        let sites = probe_sites(&self.problem.mesh, &self.probes).into_iter();
        sites.map(|(name, site)| Probe { name, at: site.at }).collect()
    }

    /// Size, and the memory that solving will need.
    pub fn estimate(&self) -> Estimate {
        let mesh = &self.problem.mesh;
        match &self.description {
            Description::Actuator(case) => Estimate::of_mesh(case, mesh.num_elements(), self.problem.num_unknowns()),
            Description::Model(..) | Description::Body(_) => Estimate::of_body(mesh, &self.problem.equations),
        }
    }

    /// The requested positions that are not among the states that were reached.
    pub fn left(&self, states: &[StepSummary]) -> &[LoadParameter] {
        let reached = states.iter().filter(|state| state.kind.is_requested()).count();
        self.requested.get(reached..).unwrap_or_default()
    }

    /// What to be careful about in results of this analysis.
    pub fn warnings(&self, states: &[StepSummary]) -> Vec<Warning> {
        let mesh = match &self.description {
            Description::Actuator(case) => &case.mesh,
            Description::Model(model, _) | Description::Body(model) => &model.mesh,
        };
        let actuator = self.actuator().map(|actuator| (actuator, mesh));
        let mut found = self.cautions();
        found.extend(warnings(Subject { problem: &self.problem, actuator, vocabulary: self.vocabulary() }, states));
        found
    }

    /// The same beside an estimate of the errors.
    pub fn warnings_beside(&self, states: &[StepSummary], estimate: Option<&ErrorEstimate>) -> Vec<Warning> {
        self.with_estimate(self.warnings(states), estimate)
    }

    /// How exact the results of an actuator are on its mesh; `None` for other bodies. Without states, as far as it is known before anything is
    /// solved.
    pub fn expected(&self, states: &[StepSummary]) -> Option<Expected> {
        let mesh = match &self.description {
            Description::Actuator(case) => &case.mesh,
            Description::Model(model, _) | Description::Body(model) => &model.mesh,
        };
        self.actuator().map(|actuator| expected(&self.problem, actuator, mesh, states))
    }

    /// The part of these that is known before anything is solved.
    pub fn cautions(&self) -> Vec<Warning> {
        let end = self.requested.last().copied().unwrap_or_default();
        cautions(&self.problem, end, self.description.model(), self.vocabulary(), &self.probes)
    }

    /// Everything that can be derived from an equilibrium of this analysis: the summary, stresses, what the contact carries.
    ///
    /// # Errors
    /// [`Error::Results`] for an equilibrium of another mesh, or one from which nothing can be derived.
    pub fn describe(&self, equilibrium: &ConvergedState) -> Result<Described, Error> {
        Ok(derived::describe(&self.problem, &probe_sites(&self.problem.mesh, &self.probes), equilibrium)?)
    }

    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        self.path.file_stem().map_or_else(|| "case".into(), |s| s.to_string_lossy().into_owned())
    }

    /// The actuator that the body is, if it is one.
    pub fn actuator(&self) -> Option<&Actuator> {
        match &self.description {
            Description::Actuator(case) => Some(&case.actuator),
            Description::Model(model, _) | Description::Body(model) => model.actuator.as_ref(),
        }
    }

    /// What is modelled of the whole body: `whole`, `half`, `quarter` or `eighth`; `None` for a deck or mesh without a declared plane of
    /// symmetry, of which nobody knows.
    pub fn modelled_part(&self) -> Option<&'static str> {
        let is_known = self.actuator().is_some() || !self.problem.symmetry.is_empty();
        is_known.then(|| self.problem.modelled_part())
    }

    /// The text of the resolved case, with every default; a model's refers to the copies of its files in a result folder.
    ///
    /// # Errors
    /// Values that TOML cannot hold.
    pub fn resolved(&self) -> Result<String, toml::ser::Error> {
        let (model, file) = match &self.description {
            Description::Actuator(case) => return toml::to_string(&case.resolved()),
            Description::Model(model, files) => (model, &*files.name),
            Description::Body(model) => (model, recorded_mesh::FILE),
        };
        let mut model = (**model).clone();
        model.title.clone_from(&self.title);
        if let Some(source) = &mut model.model {
            source.file = format!("{INPUT}/{file}");
            // Copied is the mesh.
            source.size = None;
        }
        toml::to_string(&model)
    }

    /// The files of the body, as they are copied to a result folder; `None` for an actuator's case.
    ///
    /// # Errors
    /// A mesh that cannot be written.
    pub(crate) fn files(&self) -> Result<Option<Cow<'_, Files>>, InputError> {
        match &self.description {
            Description::Actuator(_) => Ok(None),
            Description::Model(_, files) => Ok(Some(Cow::Borrowed(files))),
            Description::Body(_) => {
                // As it was given; nodes are added again.
                let (mesh, given) = (&self.problem.mesh, self.problem.given.as_ref());
                let mesh = given.map_or(mesh, |given| &given.mesh);
                let formulation = given.and_then(|given| Formulation::of_mesh(&given.mesh));
                let recorded = RecordedMesh::of(formulation.unwrap_or(self.problem.formulation), mesh);
                let bytes = recorded.written()?;
                let name = recorded_mesh::FILE.to_owned();
                Ok(Some(Cow::Owned(Files { name, bytes, included: Vec::new() })))
            }
        }
    }
}
