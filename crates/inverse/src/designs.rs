//! Solving a design: its results and their derivatives by the variables.

use std::time::Instant;

use pneuflex::gradient::{Gradient, Request};
use pneuflex::model::CaseError;
use pneuflex::{Analysis, Error, InputError, MemoryLimit, Neighbour, Solution, Status, StopToken, Study};
use pneuflex_sweep::base::{Base, Design};
use pneuflex_sweep::identity;

use crate::history::Tried;
use crate::variables::{PATH, Variable};

/// A design starts from the last one where no value differs by more than this share of the larger one: what sweeps do, too.
const NEAR: f64 = 0.1;

/// What is solved for every design.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What they are made from.
    pub base: Base,
    /// What they differ in.
    pub variables: Vec<Variable>,
    /// Results.
    pub requests: Vec<Request>,
    /// Pressures, kPa, or times at which they are wanted; empty if these are a variable, or those of the file.
    pub positions: Vec<f64>,
    /// How much memory there may be.
    pub limit: MemoryLimit,
}

/// A solver of designs.
#[derive(Debug)]
pub struct Designs {
    setup: Setup,
    /// Values of the variables where the search begins.
    pub start: Vec<f64>,
    /// A digest of the first design.
    pub origin: String,
    stop: StopToken,
    last: Option<(Vec<f64>, Neighbour)>,
}

impl Designs {
    /// Checks everything that can be checked before anything is solved, and finds out where the search begins.
    ///
    /// # Errors
    /// A design that cannot be built; keys that are no numbers that results have derivatives by; results without; values that are not within the
    /// bounds, of the key `variables.NAME`.
    pub fn new(setup: Setup, stop: &StopToken) -> Result<Self, Error> {
        let given = setup.variables.iter().filter_map(|variable| Some(variable.changes(variable.start?)));
        let mut changes: Design = given.flatten().collect();
        let first = setup.base.study(&changes)?;
        if first.case().is_none() && first.model().is_none() {
            let help = "write a model file around the deck: [model] with file = \"...\"".to_owned();
            let error = InputError::about_file(&setup.base.path, "a deck has no keys that could be looked for");
            return Err(error.with_help(Some(help)).into());
        }
        changes.extend(positions(&first, &setup.positions));
        let study = setup.base.study(&changes)?;
        let analysis = study.build_within(setup.limit)?;
        let mut start = Vec::new();
        for variable in &setup.variables {
            let refused = |value: String, allowed: &str| -> Error {
                let (key, allowed) = (format!("variables.{}", variable.name), allowed.to_owned());
                InputError::new(CaseError { key: key.clone(), value, allowed }.to_string()).of_key(key).into()
            };
            let numbers = variable.keys.iter().map(|key| analysis.number(key)).collect::<Result<Vec<f64>, _>>()?;
            let value = variable.start.unwrap_or(numbers[0]);
            if numbers.iter().any(|number| (number - value).abs() > 1e-12 * value.abs()) {
                return Err(refused(
                    format!("{numbers:?}"),
                    "must have one value for all its keys, or say where to start",
                ));
            }
            if !(variable.bounds[0]..=variable.bounds[1]).contains(&value) {
                let allowed = "the value in the case must be between the bounds, or start be said";
                return Err(refused(value.to_string(), allowed));
            }
            if variable.keys.len() > 1 {
                // One by one they may have no derivatives: a wall of one chamber alone is another lattice.
                analysis.number(&variable.key())?;
            }
            start.push(value);
        }
        analysis.check_gradients(&setup.requests)?;
        let origin = identity::of_study(&study, &identity::content(&study), false)?;
        let designs = Self { setup, start, origin, stop: stop.clone(), last: None };
        // Not every number by which there are derivatives can be set.
        designs.analysis(&designs.start)?;
        Ok(designs)
    }

    /// The variables.
    pub fn variables(&self) -> &[Variable] {
        &self.setup.variables
    }

    /// The results.
    pub fn requests(&self) -> &[Request] {
        &self.setup.requests
    }

    /// A design, ready to be solved.
    ///
    /// # Errors
    /// Values that make no body.
    pub fn analysis(&self, values: &[f64]) -> Result<Analysis, Error> {
        let pairs = self.setup.variables.iter().zip(values);
        let mut design: Design = pairs.flat_map(|(variable, value)| variable.changes(*value)).collect();
        let study = self.setup.base.study(&design)?;
        design.extend(positions(&study, &self.setup.positions));
        self.setup.base.study(&design)?.build_within(self.setup.limit)
    }

    /// Solves a design. One that makes no body, or whose load path ends early, is outside.
    ///
    /// # Errors
    /// [`Error::Interrupted`], and what is no fault of the design.
    pub fn solve(&mut self, values: &[f64]) -> Result<Tried, Error> {
        let began = Instant::now();
        let mut tried = Tried { values: values.to_vec(), ..Tried::default() };
        match self.solved(values, &mut tried) {
            Ok(gradients) => {
                let row = |gradient: &Gradient| self.setup.variables.iter().map(|v| by(gradient, v)).collect();
                tried.results = gradients.iter().map(|gradient| gradient.value).collect();
                tried.derivatives = gradients.iter().map(row).collect();
            }
            Err(Error::Input(errors)) if !errors.iter().any(|error| error.kind().is_of_machine()) => {
                tried.outside = Some(Error::Input(errors).to_string());
            }
            Err(Error::NotConverged(ended) | Error::Setup(ended)) => tried.outside = Some(ended.to_string()),
            Err(other) => return Err(other),
        }
        tried.seconds = began.elapsed().as_secs_f64();
        Ok(tried)
    }

    fn solved(&mut self, values: &[f64], tried: &mut Tried) -> Result<Vec<Gradient>, Error> {
        let analysis = self.analysis(values)?;
        let is_near = |last: &&(Vec<f64>, Neighbour)| {
            last.0.iter().zip(values).all(|(a, b)| (a - b).abs() <= NEAR * a.abs().max(b.abs()))
        };
        let neighbour = self.last.as_ref().filter(is_near).map(|(_, neighbour)| neighbour.clone());
        let mut ended = self.followed(&analysis, neighbour);
        if ended.as_ref().is_err_and(Error::has_left_neighbour) {
            ended = self.followed(&analysis, None);
        }
        let mut solution = ended?;
        if solution.status != Status::Converged {
            return Err(InputError::new("the load has a limit below what is asked for").into());
        }
        tried.has_started_from_last = solution.has_started_from;
        tried.line = solution.states.last().map(|state| state.centreline.clone()).unwrap_or_default();
        let keys: Vec<String> = self.setup.variables.iter().map(Variable::key).collect();
        let gradients = analysis.gradients(&solution.fields, &self.setup.requests, Some(&keys))?;
        self.last = solution.neighbour.take().map(|neighbour| (values.to_vec(), neighbour));
        Ok(gradients)
    }

    fn followed(&self, analysis: &Analysis, neighbour: Option<Neighbour>) -> Result<Solution, Error> {
        let mut analysis = analysis.clone();
        analysis.output.error_estimate = false;
        analysis.run().stop(&self.stop).start_from(neighbour).keep_equilibria(true).solve()
    }
}

/// The derivative of a result by a variable.
fn by(gradient: &Gradient, variable: &Variable) -> f64 {
    let key = variable.key();
    gradient.derivatives.iter().find(|derivative| derivative.by == key).map_or(0.0, |derivative| derivative.derivative)
}

/// The change that asks for results at some positions.
fn positions(study: &Study, wanted: &[f64]) -> Option<(String, String)> {
    let key = PATH[usize::from(study.model().is_some())];
    (!wanted.is_empty()).then(|| (key.to_owned(), format!("{wanted:?}")))
}
