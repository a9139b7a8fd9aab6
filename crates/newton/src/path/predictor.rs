//! One load step: a guess along the tangent of the present equilibrium, and Newton's method from there.

use pneuflex_model::{Continuation, LoadParameter};

use super::newton::Driven;
use super::{Converged, Path, Target};
use crate::event::{Event, Observer};
use crate::failure::Cause;
use crate::stability;
use crate::state::{Correction, State, difference, dot};
use crate::tangent_solver::Tangent;

/// A step of a given load that moves the body this many times as far as predicted may have come to another branch.
pub(super) const LONGER: f64 = 2.0;
/// One that moves it so many times as far has come to another branch. What lies between is seen with a shorter step: a path that bends is soon as
/// long as predicted, a jump keeps its length.
const JUMP: f64 = 4.0;
/// A step that moves it by less than this share of its displacement is no jump: under loads that rest both lengths are rounding.
const NEGLIGIBLE: f64 = 1e-4;

/// How many times as far as a tangent predicts a step has moved the body.
fn times_predicted(change: &[[f64; 3]], predicted: &[[f64; 3]]) -> f64 {
    (dot(change, change) / dot(predicted, predicted)).sqrt()
}

impl Path {
    /// One load step towards `aim`, which becomes the position that is tried: a guess along the tangent, cut short where it
    /// would deform the body too much or drive walls deep into each other, and Newton's method from there, to the end only at the
    /// position asked for.
    pub(super) fn load_step(
        &mut self,
        aim: &mut LoadParameter,
        requested: LoadParameter,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        self.check_stop()?;
        let start = self.equilibrium.state.clone();
        self.system.begin_step(&start);
        let (correction, iterations) = self.guess(&start, *aim)?;
        let (state, share) = self.shortened(&start, &correction, *aim)?;
        *aim = state.parameter;
        let target = if *aim == requested || self.is_careful { Target::Requested } else { Target::OnTheWay };
        observer(Event::StepStarted { step: self.step, parameter: *aim });
        let held = self.motion.target(*aim);
        let mut converged = self.newton(state, Driven::ByLoad(held.as_deref()), None, target, observer)?;
        converged.iterations += iterations;
        if let Some(obstacle) = self.system.passed_through(&start, &converged.equilibrium.state) {
            self.system.recycle(converged.predictor);
            return Err(Cause::PassedThrough { obstacle });
        }
        let is_damped = self.settings.continuation == Continuation::Damped;
        let change = difference(&converged.equilibrium.state.displacement, &start.displacement);
        // The first tangent may be a bad one.
        let is_first = start.parameter == LoadParameter::default();
        let whole = &converged.equilibrium.state.displacement;
        let has_moved = dot(&change, &change) > NEGLIGIBLE * NEGLIGIBLE * dot(whole, whole);
        let times = times_predicted(&change, &correction.scaled(share).displacement);
        if (is_damped || !is_first) && has_moved && times > LONGER {
            let times = match self.way_back(&start, &mut converged) {
                Ok(back) => times.min(times_predicted(&change, &back)),
                Err(cause @ (Cause::Interrupted | Cause::OutOfMemory(_))) => return Err(cause),
                Err(cause) if is_damped => return Err(cause),
                Err(_) => 0.0,
            };
            let can_be_halved = 0.5 * (*aim - start.parameter) >= self.settings.min_step;
            converged.has_jumped = !is_damped && times > if can_be_halved { JUMP } else { LONGER };
            if times > LONGER && !converged.has_jumped {
                self.system.recycle(converged.predictor);
                return Err(Cause::OtherBranch);
            }
            if !is_first {
                // Similar designs do not follow what may have snapped.
                self.keep_nothing();
            }
        }
        Ok(converged)
    }

    /// The way back to where a step began, as the tangent of its end predicts it. A tangent of the beginning may be a bad one, as that of a body
    /// at rest under the stress of the full invariant; where the body has snapped without a word, neither predicts the step. A step that may be
    /// rejected has a new tangent, which becomes the next step's; where it is told of only, the one at hand is near enough.
    fn way_back(&mut self, start: &State, converged: &mut Converged) -> Result<Vec<[f64; 3]>, Cause> {
        let state = &converged.equilibrium.state;
        let tangent = match converged.predictor.take() {
            Some(tangent) if self.settings.continuation != Continuation::Damped => tangent,
            other => {
                self.system.recycle(other);
                self.system.predict(&state.displacement, None);
                (self.iterations, converged.iterations) = (self.iterations + 1, converged.iterations + 1);
                self.system.tangent(state)?.1
            }
        };
        let assembled = self.system.residual_ahead(&tangent, state, start.parameter)?;
        let change = self.motion.change(&state.moved_to(start.parameter));
        let back = self.system.solve(&tangent, &assembled, change.as_deref())?;
        converged.predictor = Some(tangent);
        Ok(back.displacement)
    }

    /// The correction of the present equilibrium for the loads of a position, and the number of tangents that it took.
    ///
    /// The present loads are in the factor, the new ones in the residual: with the new pressure in K as well, K is indefinite where the
    /// stresses that balance it are still missing.
    fn guess(&mut self, start: &State, wanted: LoadParameter) -> Result<(Correction, usize), Cause> {
        let (tangent, iterations) = self.take_predictor(start)?;
        let loaded = start.moved_to(wanted);
        let assembled = self.system.residual_ahead(&tangent, start, wanted)?;
        let change = self.motion.change(&loaded);
        let correction = self.system.solve(&tangent, &assembled, change.as_deref())?;
        if self.first_rate.is_none() {
            self.first_rate = stability::compliance(&mut self.system, &tangent, start, &correction)?;
        }
        self.system.recycle(Some(tangent));
        Ok((correction, iterations))
    }

    /// A tangent near the present equilibrium, and the number of tangents that it took.
    pub(super) fn take_predictor(&mut self, start: &State) -> Result<(Tangent, usize), Cause> {
        if let Some(tangent) = self.predictor.take() {
            return Ok((tangent, 0));
        }
        self.system.predict(&start.displacement, None);
        let (_, tangent) = self.system.tangent(start)?;
        self.iterations += 1;
        Ok((tangent, 1))
    }

    /// The state after as much of a guess as is safe, at the position on the load path that it is good for, and that share of it.
    pub(super) fn shortened(
        &mut self,
        start: &State,
        correction: &Correction,
        aim: LoadParameter,
    ) -> Result<(State, f64), Cause> {
        let tuning = self.tuning.clone();
        let already = tuning.guess_deepening * self.system.deepest_penetration(start);
        let allowed = already.max(tuning.guess_penetration * self.scales.length);
        let extent = self.system.extent(&start.displacement, &correction.displacement);
        let mut share = (tuning.guess.stretch / extent.stretch).min(tuning.guess.angle / extent.angle).min(1.0);
        let shortest = tuning.shortest * share;
        loop {
            let guess = correction.scaled(share);
            let parameter = if share < 1.0 { start.parameter + share * (aim - start.parameter) } else { aim };
            let mut trial = start.moved_to(parameter);
            self.system.move_by(&mut trial, &guess)?;
            let is_last = share * tuning.shortening < shortest;
            if is_last || self.system.deepest_penetration(&trial) <= allowed {
                self.system.predict_ahead(start, &guess, parameter);
                return Ok((trial, share));
            }
            share *= tuning.shortening;
        }
    }
}
