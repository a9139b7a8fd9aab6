//! An analysis with other numbers on the same elements.
//!
//! Between the planes of an actuator's shape the nodes move evenly with the lengths. All other choices that the program makes by itself stay,
//! too: penalties that no file gives, which faces and nodes a table speaks of.

use std::sync::Arc;

use pneuflex_mesh::{Actuator, Cuts, Mesh};
use pneuflex_model::load::{Cavity, Control, Gas, Load};
use pneuflex_model::model_file::Model;
use pneuflex_model::{Case, CaseError, Clock, Curve, LoadParameter, Problem};
use pneuflex_newton::glued;
use toml::Value;

use super::variables::{Kind, LINK, Variable, collect};
use crate::analysis::{Analysis, Description};
use crate::document::place::{self, Step};
use crate::input_error::{InputError, InputErrorKind};
use crate::vocabulary::Vocabulary;

/// Shares of what is large for a number by which it is changed for a difference.
const SHARE: f64 = 1e-3;
const SHARE_OF_LINEAR: f64 = 1e-2;

/// A file with another number.
enum Changed {
    Case(Box<Case>),
    Model(Box<Model>),
}

/// An analysis with other numbers.
pub(super) struct Variants<'a> {
    analysis: &'a Analysis,
    document: Value,
}

impl<'a> Variants<'a> {
    /// Those of an analysis.
    ///
    /// # Errors
    /// A deck, which has no keys; values that TOML cannot hold.
    pub fn of(analysis: &'a Analysis) -> Result<Self, InputError> {
        if analysis.vocabulary() == Vocabulary::Deck {
            let help = "write a model file around the deck: [model] with file = \"...\"".to_owned();
            let what = "a deck has no keys that results could be differentiated by";
            return Err(InputError::new(what).with_help(Some(help)));
        }
        let document = match &analysis.description {
            Description::Actuator(case) => Value::try_from(case.as_ref()),
            Description::Model(model, _) | Description::Body(model) => Value::try_from(model.as_ref()),
        };
        let document = document.map_err(|error| InputError::new(error.to_string()))?;
        Ok(Self { analysis, document })
    }

    /// The problem as it is.
    pub fn problem(&self) -> &Problem {
        &self.analysis.problem
    }

    /// Every number that results can be differentiated by at a position on the load path, in the order of the file; lists whose entries are
    /// one number count as one.
    pub fn all(&self, at: LoadParameter) -> Vec<Variable> {
        let mut found = Vec::new();
        collect(&self.document, &mut Vec::new(), &mut found);
        found.extend((!self.has_corner(at)).then(|| self.path(at)));
        found
    }

    /// The variable of a key at a position on the load path; of several keys with `+` between them, the one that changes all of them.
    ///
    /// # Errors
    /// A key that does not exist, or is no number that results can be differentiated by; keys of several values.
    pub fn find(&self, key: &str, at: LoadParameter) -> Result<Variable, InputError> {
        let mut linked = key.split(LINK).map(|key| self.find_one(key.trim(), at));
        let first = linked.next().unwrap_or_else(|| self.find_one(key, at))?;
        let refused = |why: String| InputError::new(format!("no derivative by {key}: {why}")).of_key(key);
        let found = linked.try_fold(first, |found, next| found.linked_to(next?).map_err(refused))?;
        Ok(Variable { key: key.to_owned(), ..found })
    }

    fn find_one(&self, key: &str, at: LoadParameter) -> Result<Variable, InputError> {
        let (all, path) = (self.all(at), self.path(at));
        let place = place::resolve(&self.document, key);
        let is_there = |variable: &&Variable| place.as_ref().is_ok_and(|place| variable.places == [place.clone()]);
        let is_path = |variable: &&Variable| variable.kind == Kind::Path && variable.key == key;
        if let Some(found) = all.iter().find(|variable| is_there(variable) || is_path(variable)) {
            return Ok(found.clone());
        }
        if let Some(entry) = place.as_ref().ok().and_then(|place| self.entry(key, place, &all)) {
            return Ok(entry);
        }
        let refused = |why: String| InputError::new(format!("no derivative by {key}: {why}")).of_key(key);
        if key == path.key {
            return Err(refused(format!("a load has a corner at {}", self.analysis.problem.clock.words(at))));
        }
        let table = key.split(['.', '[']).next().unwrap_or_default();
        let why = match table {
            "mesh" => "the elements stay what they are".to_owned(),
            "solver" => "it says how an equilibrium is found, not which one".to_owned(),
            "probe" => "a probe reads the nearest node, and would jump from one to the next".to_owned(),
            "output" | "title" => "it changes no result".to_owned(),
            _ => {
                let known: Vec<&str> = all.iter().map(|variable| variable.key.as_str()).collect();
                let help = format!("there are {}", known.join(", "));
                let why = "it is no number of this file that results depend on smoothly".to_owned();
                return Err(refused(place.err().unwrap_or(why)).of_kind(InputErrorKind::Unknown).with_help(Some(help)));
            }
        };
        Err(refused(why))
    }

    /// One chamber's entry of a length or factor that is given for all of them by one number.
    fn entry(&self, key: &str, place: &[Step], all: &[Variable]) -> Option<Variable> {
        let (_, list) = place.split_last()?;
        place::entries(&self.document, list)?;
        let common = all.iter().find(|variable| variable.places == [list.to_vec()])?;
        Some(Variable { key: key.to_owned(), places: vec![place.to_vec()], ..common.clone() })
    }

    /// The position on the load path as a variable.
    fn path(&self, at: LoadParameter) -> Variable {
        let (key, unit) = match self.analysis.problem.clock {
            Clock::Pressure => ("load.pressure_kpa", "kPa"),
            Clock::Steps => ("load.times", ""),
        };
        Variable { key: key.to_owned(), value: at.0, unit, kind: Kind::Path, places: Vec::new() }
    }

    /// Whether what drives the body has no derivative by the position on the path there.
    fn has_corner(&self, at: LoadParameter) -> bool {
        curves(&self.analysis.problem).any(|curve| curve.corners().any(|corner| corner == at))
    }

    /// By how much a variable is changed for a difference at frozen displacements.
    pub fn step(&self, variable: &Variable) -> f64 {
        let share = if variable.kind == Kind::Linear { SHARE_OF_LINEAR } else { SHARE };
        share * self.size(variable)
    }

    /// What changes of a variable are small against.
    pub fn size(&self, variable: &Variable) -> f64 {
        if variable.kind == Kind::Length {
            let thinnest = self.analysis.actuator().map_or(f64::INFINITY, Actuator::thinnest_wall);
            return thinnest.min(self.analysis.problem.mesh.mean_node_spacing());
        }
        if variable.value == 0.0 { self.size_of_zero(variable) } else { variable.value.abs() }
    }

    /// What a number that is zero is small against.
    fn size_of_zero(&self, variable: &Variable) -> f64 {
        match variable.unit {
            "MPa" => self.analysis.problem.material.shear_modulus(),
            _ => 1.0,
        }
    }

    /// The position on the path and the problem with another value of a variable.
    ///
    /// # Errors
    /// Why there is none, in words.
    pub fn with(&self, variable: &Variable, value: f64, at: LoadParameter) -> Result<(Problem, LoadParameter), String> {
        if variable.kind == Kind::Path {
            return Ok((self.analysis.problem.clone(), LoadParameter(value)));
        }
        let changed = self.changed(variable, value)?;
        let mesh = self.mesh_of(&changed)?;
        let mut problem = match changed {
            Changed::Case(case) => {
                Problem::from_case_with(&case, Arc::unwrap_or_clone(mesh)).map_err(|error| error.to_string())?
            }
            Changed::Model(model) => self.problem_of_model(&model, mesh)?,
        };
        self.keep_choices(&mut problem, variable);
        let base = &self.analysis.problem;
        if is_alike(base, &problem) {
            Ok((problem, at))
        } else {
            Err("with another value the file speaks of other faces or nodes of the mesh".to_owned())
        }
    }

    /// The mesh alone with another value of a variable.
    ///
    /// # Errors
    /// As [`Self::with`].
    pub fn mesh_with(&self, variable: &Variable, value: f64) -> Result<Arc<Mesh>, String> {
        self.mesh_of(&self.changed(variable, value)?)
    }

    /// Whether a variable is a length of the body.
    pub fn is_of_shape(&self, variable: &Variable) -> bool {
        let is_of_actuator = |place: &Vec<Step>| place.first() == Some(&Step::Key("actuator".to_owned()));
        !variable.places.is_empty() && variable.places.iter().all(is_of_actuator)
    }

    /// The file with another value of a variable.
    fn changed(&self, variable: &Variable, value: f64) -> Result<Changed, String> {
        let mut document = self.document.clone();
        let places = variable.places.iter();
        places
            .map(|place| self.set(&mut document, place, value))
            .collect::<Option<()>>()
            .ok_or("there is no such number")?;
        let said = |error: toml::de::Error| error.message().to_owned();
        let (changed, problems) = match &self.analysis.description {
            Description::Actuator(_) => {
                let case: Case = document.try_into().map_err(said)?;
                let problems = case.problems();
                (Changed::Case(Box::new(case)), problems)
            }
            Description::Model(..) | Description::Body(_) => {
                let model: Model = document.try_into().map_err(said)?;
                let problems = model.problems();
                (Changed::Model(Box::new(model)), problems)
            }
        };
        problems.first().map_or(Ok(changed), |first| Err(first.to_string()))
    }

    fn problem_of_model(&self, changed: &Model, mesh: Arc<Mesh>) -> Result<Problem, String> {
        let undressed = self.analysis.undressed.as_ref().ok_or("its body is not known")?;
        let mut body = undressed.body.clone();
        if changed.actuator.is_some() {
            body.mesh = mesh;
        }
        let schedule = undressed.schedule.as_ref().map(|(times, first)| (&times[..], *first));
        let said = |errors: Vec<CaseError>| errors.first().map_or_else(String::new, ToString::to_string);
        let problem = changed.study(body, schedule).map_err(said)?.problem;
        glued(problem).map(|(problem, _)| problem).map_err(|error| error.to_string())
    }

    fn mesh_of(&self, changed: &Changed) -> Result<Arc<Mesh>, String> {
        let mesh = &self.analysis.problem.mesh;
        let (to, cuts) = match changed {
            Changed::Case(case) => (Some(&case.actuator), Cuts::default()),
            Changed::Model(model) => (model.actuator.as_ref(), model.cuts()),
        };
        match (self.analysis.actuator(), to) {
            (Some(from), Some(to)) if from != to => {
                from.mesh_moved_to(to, &cuts, mesh).map(Arc::new).map_err(|error| error.to_string())
            }
            _ => Ok(Arc::clone(mesh)),
        }
    }

    /// What the program has chosen stays: stiffnesses and tolerances that no file gives follow from lengths and constants, rounded.
    fn keep_choices(&self, problem: &mut Problem, variable: &Variable) {
        let base = &self.analysis.problem;
        let keeps_stiffness = !variable.key.ends_with(".stiffness");
        for (pair, base) in problem.contact_pairs.iter_mut().zip(&base.contact_pairs) {
            pair.penetration_tolerance = base.penetration_tolerance;
            if keeps_stiffness {
                pair.stiffness = base.stiffness;
            }
        }
        for (obstacle, base) in problem.obstacles.iter_mut().zip(&base.obstacles) {
            obstacle.penetration_tolerance = base.penetration_tolerance;
            if keeps_stiffness {
                obstacle.stiffness = base.stiffness;
            }
        }
        if keeps_stiffness {
            problem.contact = base.contact.clone();
        }
    }

    /// Sets a number of a document; an entry of what is one number for all chambers makes a list of it.
    fn set(&self, document: &mut Value, place: &[Step], value: f64) -> Option<()> {
        let mut here = document;
        for (i, step) in place.iter().enumerate() {
            here = match step {
                Step::Key(key) => here.get_mut(key)?,
                Step::Item(item) => {
                    if let Some(number) = here.as_float() {
                        let count = place::entries(&self.document, &place[..i])?;
                        *here = Value::Array(vec![Value::Float(number); count]);
                    }
                    here.get_mut(*item)?
                }
            };
        }
        *here = Value::Float(value);
        Some(())
    }
}

/// Everything that drives a problem along its path.
fn curves(problem: &Problem) -> impl Iterator<Item = &Curve> {
    fn of_cavity(cavity: &Cavity) -> &Curve {
        match &cavity.control {
            Control::Pressure(curve) | Control::Volume(curve) | Control::Gas(Gas { amount: curve, .. }) => curve,
        }
    }
    fn of_load(load: &Load) -> &Curve {
        match load {
            Load::Force { curve, .. }
            | Load::Traction { curve, .. }
            | Load::Pressure { curve, .. }
            | Load::Gravity { curve, .. } => curve,
        }
    }
    let supports = problem.supports.iter().filter_map(|support| support.motion.as_ref());
    let motions = supports.chain(problem.obstacles.iter().filter_map(|obstacle| obstacle.motion.as_ref()));
    let equations = problem.equations.iter().map(|equation| &equation.value);
    let cavities = problem.cavities.iter().map(of_cavity);
    cavities.chain(problem.loads.iter().map(of_load)).chain(motions.map(|motion| &motion.curve)).chain(equations)
}

/// Whether two problems say the same of the same mesh but for numbers.
fn is_alike(a: &Problem, b: &Problem) -> bool {
    let loads = |problem: &Problem| -> Vec<(usize, Vec<u32>)> {
        let of = |load: &Load| match load {
            Load::Force { nodes, .. } => (0, nodes.iter().map(|(node, _)| *node).collect()),
            Load::Traction { facets, .. } => (1, facets.iter().flat_map(|f| problem.mesh.facet_nodes(*f)).collect()),
            Load::Pressure { facets, .. } => (2, facets.iter().flat_map(|f| problem.mesh.facet_nodes(*f)).collect()),
            Load::Gravity { elements, .. } => (3, elements.clone().unwrap_or_default()),
        };
        problem.loads.iter().map(of).collect()
    };
    a.mesh.connectivity == b.mesh.connectivity
        && a.supports.iter().map(|s| (&s.nodes, s.axes)).eq(b.supports.iter().map(|s| (&s.nodes, s.axes)))
        && a.regions.iter().map(|region| &region.elements).eq(b.regions.iter().map(|region| &region.elements))
        && a.cavities.iter().map(|cavity| &cavity.facets).eq(b.cavities.iter().map(|cavity| &cavity.facets))
        && loads(a) == loads(b)
        && a.contact_pairs
            .iter()
            .map(|p| (&p.slave, &p.master))
            .eq(b.contact_pairs.iter().map(|p| (&p.slave, &p.master)))
        && a.obstacles.iter().map(|obstacle| &obstacle.facets).eq(b.obstacles.iter().map(|obstacle| &obstacle.facets))
        && a.equations.iter().map(|equation| equation.terms.len()).eq(b.equations.iter().map(|e| e.terms.len()))
}
