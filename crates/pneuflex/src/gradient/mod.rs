//! Exact derivatives of results by the numbers of a case or model file (theory §18): what changes a result most, and by how much.
//!
//! One more solution with the tangent of a state gives the multipliers of a result; with them, every number costs a few evaluations of the
//! equations at the displacements of the state ([`pneuflex_newton::adjoint`]). The derivatives are those of the equilibrium on its mesh, which
//! follows the lengths with the same elements.
//!
//! ```
//! let mut study = pneuflex::Study::from_text("finger.toml", &pneuflex::template::two_chambers())?;
//! study.set("mesh.size", "9")?.set("mesh.element", "hex8-q1p0")?.set("load.pressure_kpa", "[5]")?; // coarse, to be quick
//! let analysis = study.build()?;
//! let solution = analysis.solve()?;
//!
//! let found = analysis.gradients(&solution.fields, &["end_face_angle".parse()?], None)?;
//! let by = |key: &str| found[0].derivatives.iter().find(|derivative| derivative.by == key).map(|found| found.derivative);
//! assert!(by("material.c10").is_some_and(|slope| slope < 0.0)); // degrees per MPa: a stiffer finger bends less
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beside_columns;
mod check;
mod request;
mod results;
mod shape;
mod slopes;
mod solved;
#[cfg(test)]
mod tests;
mod variables;
mod variants;

use std::cmp::Ordering;
use std::time::Instant;

use pneuflex_model::{ContactMethod, LoadParameter, Pressure, Problem, StateKind};
use pneuflex_newton::{ConvergedState, springs_of};
use pneuflex_post::summary::StepSummary;
use rayon::prelude::*;
use serde::Serialize;

pub use self::check::{Checked, check};
pub use self::request::Request;
use self::results::Scalar;
pub use self::shape::{ShapeGradient, write_shape_gradients};
use self::slopes::Slopes;
use self::solved::{Solved, no_gradient};
use self::variables::Variable;
use self::variants::Variants;
use crate::analysis::Analysis;
use crate::columns::Tip;
use crate::error::{Error, ResultsError};
use crate::folder::{GRADIENTS, OutputFolder};
use crate::input_error::InputError;
use crate::json;

/// Slopes by the positions of the nodes are worth while for so many results by a length: one takes as long as two to three residuals.
const RESULTS_PER_LENGTH: usize = 2;

/// The derivatives of a result of a state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gradient {
    /// The result's column.
    pub of: String,
    /// Time of the state; left out for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Its pressure, kPa; that of the first cavity of a model.
    pub pressure_kpa: f64,
    /// The result there.
    pub value: f64,
    /// By every number, the greatest effect of a change by a percent first.
    pub derivatives: Vec<Derivative>,
    /// Numbers by which there is no derivative.
    pub without: Vec<NoDerivative>,
    /// Seconds spent on all results of the state.
    pub seconds: f64,
}

/// The derivative of a result by a number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Derivative {
    /// Key of the number.
    pub by: String,
    /// Its value.
    pub value: f64,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// Change of the result per unit of the number.
    pub derivative: f64,
    /// Change of the result when the number grows by one percent of itself.
    pub per_percent: f64,
}

/// A number by which there is no derivative.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoDerivative {
    /// Its key.
    pub by: String,
    /// Why.
    pub why: String,
}

impl Analysis {
    /// Refuses what there are no derivatives of, before anything is solved.
    ///
    /// # Errors
    /// A result that the body does not have, or that has no derivative; a pressure or time that is not asked for; contact that has no
    /// derivative.
    pub fn check_gradients(&self, requests: &[Request]) -> Result<(), Error> {
        if requests.is_empty() {
            return Ok(());
        }
        self.check_contact()?;
        let rest = self.describe(&at_rest(&self.problem))?.summary;
        let tip = Tip::of_analysis(self);
        for request in requests {
            self.position(request)?;
            Scalar::check(&request.column, &rest, self, &tip)?;
        }
        Variants::of(self)?;
        Ok(())
    }

    /// The value of a number of the file, of which results have derivatives at the last position that is asked for; by its key, which may be one of a
    /// single chamber.
    ///
    /// # Errors
    /// A key that does not exist, or is no such number.
    pub fn number(&self, key: &str) -> Result<f64, Error> {
        let at = self.requested.last().copied().unwrap_or_default();
        Ok(Variants::of(self)?.find(key, at)?.value)
    }

    /// Refuses contact and constraints that have no derivative.
    fn check_contact(&self) -> Result<(), InputError> {
        let Some((key, why)) = self.without_gradient() else { return Ok(()) };
        Err(InputError::new(format!("{key}: {why}, and its states have no derivatives")).of_key(key))
    }

    /// Key and reason of what in it has no derivative.
    fn without_gradient(&self) -> Option<(&'static str, &'static str)> {
        let Problem { contact_pairs, contact, obstacles, distances, .. } = &self.problem;
        let is_mortar = contact_pairs.iter().any(|pair| pair.method.unwrap_or(contact.method) == ContactMethod::Mortar);
        let until = contact_pairs.iter().map(|pair| pair.interference_until);
        let overlaps = until.chain(obstacles.iter().map(|obstacle| obstacle.interference_until)).any(|it| it.is_some());
        if is_mortar {
            Some(("contact.method", "gaps that are averaged (\"mortar\") are cut anew in every state"))
        } else if overlaps {
            Some(("contact.interference", "an overlap at rest changes with the lengths and would begin or end"))
        } else if !distances.is_empty() {
            Some(("model.file", "it has rigid bodies, whose distances are not part of the adjoint's equations"))
        } else if !springs_of(&self.problem).is_empty() {
            Some(("support", "only contact holds a part of the body, whose place depends on the path"))
        } else {
            None
        }
    }

    /// Where on the load path a request is.
    fn position(&self, request: &Request) -> Result<LoadParameter, InputError> {
        let wanted = request.at.map(LoadParameter).or(self.requested.last().copied()).unwrap_or_default();
        let is_asked_for = self.requested.contains(&wanted);
        is_asked_for.then_some(wanted).ok_or_else(|| {
            let clock = self.problem.clock;
            let known: Vec<String> = self.requested.iter().map(|at| clock.words(*at)).collect();
            let what = format!("{request}: no state is asked for at {}", clock.words(wanted));
            InputError::new(what).with_help(Some(format!("there are {}", known.join(", "))))
        })
    }

    /// The gradients that are asked for, of states that were reached; by all numbers of the file, or by those of some keys.
    ///
    /// # Errors
    /// What [`Self::check_gradients`] refuses; a state that was not reached here; contact that carries multipliers; a key by which there is no
    /// derivative; a state whose equations have no unique solution.
    pub fn gradients(
        &self,
        states: &[ConvergedState],
        requests: &[Request],
        keys: Option<&[String]>,
    ) -> Result<Vec<Gradient>, Error> {
        if requests.is_empty() {
            return Ok(Vec::new());
        }
        self.check_contact()?;
        self.by_state(states, requests, |state, columns| self.gradients_at(state, columns, keys, true))
    }

    /// The gradients at a state. `by_nodes` lets lengths count by the slopes along the positions of all nodes, where there are any.
    fn gradients_at(
        &self,
        state: &ConvergedState,
        columns: &[&str],
        keys: Option<&[String]>,
        by_nodes: bool,
    ) -> Result<Vec<Gradient>, Error> {
        let began = Instant::now();
        let Solved { summary, scalars, linearised, multipliers } = self.solved(state, columns)?;
        let variants = Variants::of(self)?;
        let at = state.parameter;
        let variables = match keys {
            Some(keys) => keys.iter().map(|key| variants.find(key, at)).collect::<Result<Vec<_>, _>>()?,
            None => variants.all(at),
        };
        // One slope along all nodes for a result, or four residuals for a length: whichever is less.
        let lengths = variables.iter().filter(|variable| variants.is_of_shape(variable)).count();
        let by_nodes = by_nodes && multipliers.len() <= RESULTS_PER_LENGTH * lengths;
        let shapes = multipliers.iter().filter(|_| by_nodes).map(|result| linearised.shape_slope(result));
        let shapes: Vec<Option<Vec<[f64; 3]>>> = shapes.collect::<Result<_, _>>().map_err(no_gradient)?;
        let shapes: Option<Vec<Vec<[f64; 3]>>> = shapes.into_iter().collect();
        let by_nodes = shapes.as_deref().filter(|_| by_nodes);
        let (linearised, variants) = (&linearised, &variants);
        let slopes = Slopes { linearised, variants, scalars: &scalars, multipliers: &multipliers, by_nodes, at };
        let found: Vec<Result<Vec<f64>, String>> = variables.par_iter().map(|variable| slopes.by(variable)).collect();
        if let Some((variable, Err(why))) =
            variables.iter().zip(&found).find(|(_, found)| keys.is_some() && found.is_err())
        {
            let key = &variable.key;
            return Err(InputError::new(format!("no derivative by {key}: {why}")).of_key(key).into());
        }
        let seconds = began.elapsed().as_secs_f64();
        let gradient = |number: usize| gradient(&scalars[number], number, &summary, &variables, &found, seconds);
        Ok((0..scalars.len()).map(gradient).collect())
    }
}

fn gradient(
    scalar: &Scalar,
    number: usize,
    summary: &StepSummary,
    variables: &[Variable],
    found: &[Result<Vec<f64>, String>],
    seconds: f64,
) -> Gradient {
    let (mut derivatives, mut without) = (Vec::new(), Vec::new());
    for (variable, found) in variables.iter().zip(found) {
        let Variable { key, value, unit, .. } = variable.clone();
        match found {
            Ok(slopes) => {
                let derivative = slopes[number];
                let per_percent = 0.01 * value * derivative;
                derivatives.push(Derivative { by: key, value, unit, derivative, per_percent });
            }
            Err(why) => without.push(NoDerivative { by: key, why: why.clone() }),
        }
    }
    derivatives.sort_by(|a, b| b.per_percent.abs().partial_cmp(&a.per_percent.abs()).unwrap_or(Ordering::Equal));
    Gradient {
        of: scalar.column.clone(),
        time: summary.time,
        pressure_kpa: summary.pressure_kpa,
        value: scalar.value,
        derivatives,
        without,
        seconds,
    }
}

/// Writes the gradients into a result folder.
///
/// # Errors
/// A file that cannot be written; a number that is not finite.
pub fn write_gradients(folder: &OutputFolder, gradients: &[Gradient]) -> Result<(), Error> {
    let text = json::pretty(&gradients).map_err(|why| ResultsError::not_representable(GRADIENTS, why))?;
    Ok(folder.write(GRADIENTS, text)?)
}

/// The body at rest, as a state.
fn at_rest(problem: &Problem) -> ConvergedState {
    let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
    ConvergedState {
        parameter: LoadParameter::default(),
        kind: StateKind::default(),
        negative_pivots: 0,
        displacement: zero.clone(),
        reaction: zero,
        iterations: 0,
        load_steps: 0,
        contact_points: 0,
        cavity_pressures: vec![Pressure::default(); problem.cavities.len()],
        contact_multipliers: Vec::new(),
        augmentation: None,
        mesh_motions: None,
        bifurcations: Vec::new(),
        snaps: Vec::new(),
    }
}
