//! Where a path ends: how firm its last equilibrium is.

use pneuflex_model::LoadParameter;

use super::Path;
use crate::error::AssembleError;
use crate::event::Observer;
use crate::failure::{Cause, Failure, Stability};
use crate::stability::{self, Response};
use crate::unstable_motion::UnstableMotions;

impl Path {
    /// Solves the present equilibrium, perhaps one on the way, to the tolerances asked for, and finds out how firm it is: otherwise what
    /// was left of the residual would speak of stability, too.
    pub(super) fn confirm(&mut self, observer: Observer<'_>) {
        if self.equilibrium.state.parameter <= LoadParameter::default() {
            return;
        }
        match self.solve_again(None, observer) {
            Ok(converged) => self.adopt(converged),
            Err(Cause::IndefiniteTangent { negative_pivots, motions }) => {
                self.stability = Stability { negative_pivots, motions, softening: self.stability.softening };
                return;
            }
            Err(Cause::Interrupted) => return,
            // The tangent of what is there has to do, if there is nothing before it.
            Err(_) => {
                self.system.revert();
                if self.go_back(observer) {
                    return;
                }
            }
        }
        self.forget_predictor();
        let Self { system, mesh, equilibrium, motion, settings, .. } = self;
        let state = &equilibrium.state;
        self.stability = match (stability::stretching_rate(system, state, motion, settings.min_step), self.first_rate) {
            (Ok(Some(Response { rate, motion })), Some(first)) => Stability {
                softening: Some(rate / first),
                motions: UnstableMotions::of_response(system, mesh, &state.displacement, motion).map(Box::new),
                negative_pivots: 0,
            },
            // An equilibrium whose tangent is singular is as unstable as can be told.
            (Err(AssembleError::Factor(_)), _) => Stability { softening: Some(f64::INFINITY), ..Stability::default() },
            // Nothing is known.
            (Ok(_) | Err(_), _) => Stability::default(),
        };
    }

    /// Goes back to the equilibrium before an inexact state that turned out to be none, and says whether there is one.
    fn go_back(&mut self, observer: Observer<'_>) -> bool {
        let Some(previous) = self.previous.pop() else { return false };
        self.equilibrium = previous;
        self.is_careful = true;
        self.augmentation = None;
        self.confirm(observer);
        true
    }

    pub(super) fn failure(&self, attempted: LoadParameter, cause: Cause) -> Failure {
        let reached = self.equilibrium.state.parameter;
        let is_past_limit = self.arc.is_past_limit();
        Failure { reached, attempted, cause, stability: self.stability.clone(), clock: self.clock, is_past_limit }
    }
}
