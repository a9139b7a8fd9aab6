//! Derivatives against differences of whole runs.

use pneuflex_model::{LoadParameter, Probe, Problem};
use pneuflex_post::summary::probe_sites;

use super::results::Scalar;
use super::slopes::extrapolated;
use super::variants::Variants;
use super::{Derivative, Request};
use crate::analysis::Analysis;
use crate::columns::Tip;
use crate::error::Error;
use crate::input_error::InputError;
use crate::observer::StopToken;

/// Runs change a number by so much that the result changes by this share of itself: little enough for hardly a point to come into contact, whose
/// force has a corner, and much against what is left of the residuals;
const EFFECT: f64 = 1e-4;

/// and by these shares of what is large for it, at the least and at the most.
const SHARES: [f64; 2] = [3e-4, 5e-3];

/// Tolerances of the runs.
const TOLERANCE: f64 = 1e-10;
const RESIDUAL_TOLERANCE: f64 = 1e-12;

/// A derivative beside what differences of runs say.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// The derivative, from the adjoint.
    pub exact: Derivative,
    /// From four runs with other values, extrapolated.
    pub by_differences: f64,
}

impl Checked {
    /// How far the two are apart, relative to the larger one.
    pub fn relative_difference(&self) -> f64 {
        let (a, b) = (self.exact.derivative, self.by_differences);
        let size = a.abs().max(b.abs());
        if size == 0.0 { 0.0 } else { (a - b).abs() / size }
    }
}

/// The derivatives of a result, by all numbers or those of some keys, against central differences of four runs each: from rest, on
/// the same elements, to tight tolerances. `listener` is told of each as it is found, in the order of their effects.
///
/// # Errors
/// As [`Analysis::gradients`] and [`crate::Run::solve`].
pub fn check(
    analysis: &Analysis,
    request: &Request,
    keys: Option<&[String]>,
    stop: &StopToken,
    listener: &mut dyn FnMut(&Checked),
) -> Result<Vec<Checked>, Error> {
    let requests = std::slice::from_ref(request);
    analysis.check_gradients(requests)?;
    let at = analysis.position(request)?;
    // Before anything is solved.
    let variants = Variants::of(analysis)?;
    keys.into_iter().flatten().try_for_each(|key| variants.find(key, at).map(drop))?;
    let tight = analysis.to_tight_tolerances(at);
    let solution = tight.run().stop(stop).solve()?;
    let mut found = Vec::new();
    for gradient in tight.gradients(&solution.fields, requests, keys)? {
        for exact in gradient.derivatives {
            let columns = std::slice::from_ref(&gradient.of);
            let differences = tight.differences(&exact, gradient.value, columns, stop)?;
            let checked = Checked { exact, by_differences: differences[0] };
            listener(&checked);
            found.push(checked);
        }
    }
    Ok(found)
}

impl Analysis {
    /// The same up to a position on the load path, for runs of which differences are taken.
    pub(super) fn to_tight_tolerances(&self, end: LoadParameter) -> Self {
        let mut tight = self.clone();
        tight.requested.retain(|requested| *requested <= end);
        tight.output.error_estimate = false;
        tight.solver.tolerance = tight.solver.tolerance.min(TOLERANCE);
        tight.solver.residual_tolerance = tight.solver.residual_tolerance.min(RESIDUAL_TOLERANCE);
        tight
    }

    /// Derivatives of some results at the end by the key of an exact derivative, from four runs; `value` is that of the result which it is of.
    pub(super) fn differences(
        &self,
        exact: &Derivative,
        value: f64,
        columns: &[String],
        stop: &StopToken,
    ) -> Result<Vec<f64>, Error> {
        let at = self.requested.last().copied().unwrap_or_default();
        let variants = Variants::of(self)?;
        let variable = variants.find(&exact.by, at)?;
        let [least, most] = SHARES.map(|share| share * variants.size(&variable));
        let step = (EFFECT * (value / exact.derivative).abs()).clamp(least, most);
        let values = |steps: f64| -> Result<Vec<f64>, Error> {
            let (problem, end) =
                variants.with(&variable, variable.value + steps * step, at).map_err(InputError::new)?;
            let probes = self.probes_on(&problem);
            let mut changed = Self { problem, probes, ..self.clone() };
            changed.requested.pop();
            changed.requested.push(end);
            let solution = changed.run().stop(stop).solve()?;
            let reached = solution.fields.iter().zip(&solution.states);
            let state = reached.rev().find(|(_, summary)| summary.kind.is_requested());
            let state = state.ok_or_else(|| InputError::new("nothing was asked for"))?;
            let tip = Tip::of_analysis(&changed);
            let values = columns.iter().map(|column| Ok(Scalar::find(column, state, &changed, &tip)?.value));
            values.collect()
        };
        let [near, far] = [[values(-1.0)?, values(1.0)?], [values(-2.0)?, values(2.0)?]];
        let at = |ends: &[Vec<f64>; 2], i: usize| [ends[0][i], ends[1][i]];
        Ok((0..columns.len()).map(|i| extrapolated(at(&near, i), at(&far, i), step)).collect())
    }

    /// Probes at the same nodes, where these are in another problem.
    fn probes_on(&self, problem: &Problem) -> Vec<Probe> {
        let sites = probe_sites(&self.problem.mesh, &self.probes).into_iter();
        sites.map(|(name, site)| Probe { name, at: problem.mesh.nodes[site.node] }).collect()
    }
}
