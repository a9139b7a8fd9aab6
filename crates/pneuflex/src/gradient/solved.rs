//! The transposed systems of results, solved at the states that they are of.

use pneuflex_model::LoadParameter;
use pneuflex_newton::ConvergedState;
use pneuflex_newton::adjoint::{Linearised, Multipliers};
use pneuflex_post::summary::StepSummary;

use super::request::Request;
use super::results::Scalar;
use crate::analysis::Analysis;
use crate::columns::Tip;
use crate::error::Error;
use crate::input_error::InputError;

/// Results of a state with their multipliers.
pub struct Solved {
    pub summary: StepSummary,
    pub scalars: Vec<Scalar>,
    pub linearised: Linearised,
    /// Those of every result.
    pub multipliers: Vec<Multipliers>,
}

/// Why there is no gradient of a state.
pub fn no_gradient(why: impl std::fmt::Display) -> InputError {
    InputError::new(format!("there is no gradient: {why}"))
}

impl Analysis {
    /// What `of_state` finds of some columns at a state, for every request, state by state.
    pub(super) fn by_state<T>(
        &self,
        states: &[ConvergedState],
        requests: &[Request],
        mut of_state: impl FnMut(&ConvergedState, &[&str]) -> Result<Vec<T>, Error>,
    ) -> Result<Vec<T>, Error> {
        let mut found: Vec<(usize, T)> = Vec::new();
        let positions: Vec<LoadParameter> =
            requests.iter().map(|request| self.position(request)).collect::<Result<_, _>>()?;
        for (first, at) in positions.iter().enumerate().filter(|(i, at)| !positions[..*i].contains(at)) {
            let same: Vec<usize> = (first..requests.len()).filter(|i| positions[*i] == *at).collect();
            let state = states.iter().find(|state| state.parameter == *at && state.kind.is_requested());
            let state = state.ok_or_else(|| {
                let what = format!("{}: the displacements there are not known", requests[first]);
                let help =
                    "solve it from rest: what an earlier run has reached is known by its results alone".to_owned();
                InputError::new(what).with_help(Some(help))
            })?;
            let columns: Vec<&str> = same.iter().map(|i| requests[*i].column.as_str()).collect();
            found.extend(same.into_iter().zip(of_state(state, &columns)?));
        }
        found.sort_by_key(|(number, _)| *number);
        Ok(found.into_iter().map(|(_, found)| found).collect())
    }

    /// Results at a state, with one solution of the transposed system each.
    pub(super) fn solved(&self, state: &ConvergedState, columns: &[&str]) -> Result<Solved, Error> {
        if state.contact_multipliers.iter().any(|multiplier| *multiplier != 0.0) {
            let what = "penetration_tolerance: contact carries multipliers, which depend on the way to the state";
            let help =
                "give a larger penetration_tolerance and a larger stiffness, so that the penalty alone is enough";
            return Err(InputError::new(what).with_help(Some(help.to_owned())).into());
        }
        let summary = self.describe(state)?.summary;
        let tip = Tip::of_analysis(self);
        let scalars = columns.iter().map(|column| Scalar::find(column, (state, &summary), self, &tip));
        let scalars: Vec<Scalar> = scalars.collect::<Result<_, _>>()?;
        let linearised = Linearised::at(&self.problem, state).map_err(no_gradient)?;
        let multipliers = scalars.iter().map(|scalar| {
            let objective = scalar.objective(&self.problem, linearised.displacement()).map_err(no_gradient)?;
            linearised.multipliers(&objective).map_err(no_gradient)
        });
        let multipliers = multipliers.collect::<Result<_, InputError>>()?;
        Ok(Solved { summary, scalars, linearised, multipliers })
    }
}
