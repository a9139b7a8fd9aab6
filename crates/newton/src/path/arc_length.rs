//! Steps of a given arc length, on which the load parameter is found: past limit points, where it has a greatest or least value (theory §14).

use pneuflex_model::{LoadParameter, StateKind};

use super::newton::Driven;
use super::predictor::LONGER;
use super::step_control::{Attempt, CRUMB};
use super::{Converged, Path, Target};
use crate::arc::{self, ArcEquation, ArcKind, Direction};
use crate::checkpoint::Approach;
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure};
use crate::stability;
use crate::state::{Correction, Equilibrium, State, difference};
use crate::tangent_solver::Tangent;

/// A step that turns further from the path's direction, by its cosine, may have come to another branch, and is halved.
const TURNED: f64 = 0.5;

/// Steps that are no longer than this many times the least one may turn as far as this: where contact begins, a path has a corner.
const CORNER: (f64, f64) = (100.0, 0.0);

/// A limit point is found when the load parameter differs by less than this share from its extreme value,
const LIMIT_TOLERANCE: f64 = 1e-6;

/// or after so many attempts: at a corner there is no slope of zero.
const LIMIT_ATTEMPTS: usize = 4;

/// What a step led to.
struct Found {
    converged: Converged,
    /// Why it is told of, if it is no requested one and does not lie between.
    kind: Option<StateKind>,
    is_falling: bool,
}

impl Path {
    /// See [`Path::follow`].
    pub(super) fn follow_arc(&mut self, requested: &[LoadParameter], observer: Observer<'_>) -> Result<(), Failure> {
        let Some(&last) = requested.last() else { return Ok(()) };
        let mut left = requested;
        let mut approach = self.approach.take().unwrap_or_else(|| self.new_approach());
        (self.is_careful, self.last) = (true, last);
        if self.equilibrium.is_inexact || self.is_strained_at_rest(last)? {
            let solved = self.solve_again(None, observer).map_err(|cause| self.failure(last, cause))?;
            self.adopt(solved);
        }
        let mut is_blocked = false;
        loop {
            let at = self.equilibrium.state.parameter;
            let is_next = left.first() == Some(&at);
            if is_next || self.arc.untold.is_some() {
                self.tell(&mut approach, observer);
            }
            left = &left[usize::from(is_next)..];
            let Some(&next) = left.first() else { return Ok(()) };
            if self.arc.past_limit >= self.settings.states_past_limit {
                return Ok(());
            }
            self.step += 1;
            approach.step = approach.step.min(self.settings.max_step);
            let (wanted, had_predictor) = (approach.step, self.predictor.is_some());
            let mut attempt = Attempt { start: at, wanted, tried: wanted, attempted: at, had_predictor };
            let ahead = (!self.arc.is_falling).then_some(next);
            match self.arc_step(ahead, is_blocked, &mut attempt, observer) {
                Ok(Some(found)) => {
                    is_blocked = false;
                    self.accept_arc(found, &attempt, &mut approach, next, observer)?;
                }
                Ok(None) => return Ok(()),
                Err(cause) => match self.leave_branch(&cause, [attempt.attempted, next], observer) {
                    Some(converged) => {
                        let is_falling = converged.equilibrium.state.parameter < at;
                        let is_past = is_falling || self.arc.is_past_limit();
                        let kind = is_past.then_some(StateKind::PastLimit);
                        attempt.attempted = converged.equilibrium.state.parameter;
                        self.accept_arc(
                            Found { converged, kind, is_falling },
                            &attempt,
                            &mut approach,
                            next,
                            observer,
                        )?;
                    }
                    None => {
                        is_blocked |= attempt.attempted == next;
                        self.reject(cause, &attempt, &mut approach, observer)?;
                    }
                },
            }
        }
    }

    /// Whether the undeformed body is no equilibrium, as with the full invariant, which has a pressure there: no path begins at it.
    fn is_strained_at_rest(&mut self, last: LoadParameter) -> Result<bool, Failure> {
        let state = self.equilibrium.state.clone();
        if state.parameter > LoadParameter::default() {
            return Ok(false);
        }
        let assembled = self.system.residual(&state).map_err(|error| self.failure(last, error.into()))?;
        Ok(self.system.free_norm(&assembled.residual) > self.scales.negligible_force())
    }

    /// Tells of the present state.
    fn tell(&mut self, approach: &mut Approach, observer: Observer<'_>) {
        let state = self.describe(self.iterations - approach.iterations_before, approach.load_steps);
        observer(Event::Converged(&state));
        self.arc.untold = None;
        self.bifurcations.clear();
        (approach.load_steps, approach.iterations_before) = (0, self.iterations);
    }

    /// One step along the path, or to the position `ahead` of a rising load parameter, if the step comes to it and that is not known to be
    /// impossible (`is_blocked`). None if the load parameter would fall below zero, or where overlaps at rest are not gone yet.
    fn arc_step(
        &mut self,
        ahead: Option<LoadParameter>,
        is_blocked: bool,
        attempt: &mut Attempt,
        observer: Observer<'_>,
    ) -> Result<Option<Found>, Cause> {
        self.check_stop()?;
        let start = self.equilibrium.state.clone();
        self.system.begin_step(&start);
        let (rate, iterations) = self.present_rate(&start)?;
        let weight = arc::weight(&start, self.arc.greatest, &rate);
        let last = self.arc.last.clone();
        let direction = Direction::after(&rate, last.as_ref().map(|(u, t)| (&u[..], *t)), weight);
        let change = attempt.wanted * direction.slope();
        let reachable = ahead.filter(|_| !is_blocked);
        if let Some(target) = reachable.filter(|target| start.parameter + CRUMB * change >= *target) {
            return self.land(target, (&direction, weight), attempt, observer);
        }
        self.forget_predictor();
        let aim = start.parameter + change;
        let (guess, share) = self.shortened(&start, &direction.over(attempt.wanted), aim)?;
        (attempt.tried, attempt.attempted) = (share * attempt.wanted, guess.parameter);
        observer(Event::StepStarted { step: self.step, parameter: guess.parameter });
        let equation = ArcEquation { start: &start, weight, kind: ArcKind::Sphere(attempt.tried) };
        let mut kind = self.arc.is_past_limit().then_some(StateKind::PastLimit);
        let mut converged =
            match self.newton(guess.clone(), Driven::ByArc(&equation), None, Target::Requested, observer) {
                Ok(converged) => converged,
                Err(Cause::Interrupted) => return Err(Cause::Interrupted),
                Err(cause) => {
                    let converged = self.around_corner(guess, &direction, &equation, cause, observer)?;
                    let is_falling = self.falls(&equation, &converged);
                    return Ok(Some(Found { converged, kind, is_falling }));
                }
            };
        converged.iterations += iterations;
        let mut is_falling = self.falls(&equation, &converged);
        if let Err(cause) = self.check_branch(&start, &converged, &direction, (weight, attempt.tried)) {
            self.system.recycle(converged.predictor);
            return Err(cause);
        }
        if is_falling != self.arc.is_falling {
            // The tangent is one of the iterations; near to a singular one that may say the wrong thing.
            self.sharpen(&mut converged)?;
            is_falling = self.falls(&equation, &converged);
        }
        if is_falling != self.arc.is_falling {
            kind = Some(if is_falling { StateKind::GreatestLoad } else { StateKind::LeastLoad });
            converged = self.limit_point(&start, &direction, weight, attempt.tried, converged, observer)?;
        } else {
            is_falling = self.arc.is_falling;
        }
        let reached = converged.equilibrium.state.parameter;
        if let Some(target) = ahead.filter(|target| reached > *target) {
            self.system.recycle(converged.predictor);
            if is_blocked {
                return Err(Cause::OtherBranch);
            }
            return self.land(target, (&direction, weight), attempt, observer);
        }
        // Below it, overlaps that are gone would come back.
        let least = if is_falling { self.motion.overlaps_until } else { LoadParameter::default() };
        if reached <= least {
            self.system.recycle(converged.predictor);
            self.system.revert();
            return Ok(None);
        }
        Ok(Some(Found { converged, kind, is_falling }))
    }

    /// Where contact begins on a path it has a corner, at which the load parameter may turn back at once. No guess along the path's direction
    /// finds that: this one goes on in the displacements, and back in the load parameter. `cause` is why the first one failed.
    fn around_corner(
        &mut self,
        guess: State,
        direction: &Direction<'_>,
        equation: &ArcEquation<'_>,
        cause: Cause,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        let ArcKind::Sphere(size) = equation.kind else { return Err(cause) };
        let start = equation.start;
        if self.system.deepest_penetration(&guess) <= self.system.deepest_penetration(start) {
            return Err(cause);
        }
        self.system.revert();
        self.system.begin_step(start);
        let back = guess.moved_to(start.parameter + -direction.sign * size);
        let change = change_between(start, &back);
        self.system.predict_ahead(start, &change, back.parameter);
        let found = self.newton(back, Driven::ByArc(equation), None, Target::Requested, observer)?;
        let change = change_between(start, &found.equilibrium.state);
        let is_back = direction.cosine(&change.displacement, 0.0, equation.weight) <= 0.0;
        if is_back || found.equilibrium.contact_points <= self.equilibrium.contact_points {
            self.system.recycle(found.predictor);
            return Err(cause);
        }
        Ok(found)
    }

    /// A step to a requested position.
    fn land(
        &mut self,
        target: LoadParameter,
        (direction, weight): (&Direction<'_>, f64),
        attempt: &mut Attempt,
        observer: Observer<'_>,
    ) -> Result<Option<Found>, Cause> {
        attempt.attempted = target;
        let start = self.equilibrium.state.clone();
        let mut aim = target;
        let converged = self.load_step(&mut aim, target, observer)?;
        let Correction { displacement, .. } = change_between(&start, &converged.equilibrium.state);
        // Given its load, a body that snaps has one equilibrium after the snap.
        let predicted = (aim - start.parameter) / direction.slope();
        let checked = if arc::length(&displacement, aim - start.parameter, weight) > LONGER * predicted {
            Err(Cause::OtherBranch)
        } else {
            self.check_branch(&start, &converged, direction, (weight, predicted))
        };
        if let Err(cause) = checked {
            self.system.recycle(converged.predictor);
            return Err(cause);
        }
        Ok(Some(Found { converged, kind: None, is_falling: self.arc.is_falling }))
    }

    fn accept_arc(
        &mut self,
        found: Found,
        attempt: &Attempt,
        approach: &mut Approach,
        next: LoadParameter,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        let Found { converged, kind, is_falling } = found;
        approach.load_steps += 1;
        let is_landing = attempt.attempted == next;
        if !is_landing && !kind.is_some_and(StateKind::is_limit_point) {
            let is_easy = converged.iterations <= self.tuning.easy_iterations;
            approach.after_accepted(attempt.wanted, is_easy, self.settings.max_step, &self.tuning);
        }
        let before = self.equilibrium.clone();
        self.adopt(converged);
        let (start, state) = (&before.state, &self.equilibrium.state);
        let change = (difference(&state.displacement, &start.displacement), state.parameter - start.parameter);
        self.arc.last = Some(change);
        self.arc.greatest = self.arc.greatest.max(state.parameter.0);
        self.arc.is_falling = is_falling;
        self.arc.past_limit += usize::from(kind.is_some());
        self.arc.untold = kind;
        let is_told = kind.is_some() || state.parameter == next;
        self.complete(before, attempt, is_told, observer)?;
        let checkpoint = self.checkpoint(*approach);
        observer(Event::StepAccepted(&checkpoint));
        Ok(())
    }

    /// Where the load parameter has its extreme value between the start of a step and what it led to, by the cubic through values and slopes.
    fn limit_point(
        &mut self,
        start: &State,
        direction: &Direction<'_>,
        weight: f64,
        size: f64,
        beyond: Converged,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        let whole = change_between(start, &beyond.equilibrium.state);
        let rise = beyond.equilibrium.state.parameter - start.parameter;
        let mut ends = [(0.0, 0.0, direction.slope()), (size, rise, self.slope(start, &beyond, weight))];
        let mut found = beyond;
        for _ in 0..LIMIT_ATTEMPTS {
            let [(from, low, first), (to, high, second)] = ends;
            let (beside, curvature) = arc::extreme([low, high], [first, second], to - from);
            let at = from + beside;
            let share = at / size;
            // The parabola with the start's tangent through both states.
            let (linear, square) = (share - share * share, share * share);
            let guess = direction.over(size).scaled(linear).plus(square, &whole);
            let aim = start.parameter + (linear * size * direction.slope() + square * rise);
            let mut state = start.moved_to(aim);
            self.system.recycle(found.predictor.take());
            self.system.predict_ahead(start, &guess, aim);
            let moved = state.displacement.as_flattened_mut().iter_mut().zip(guess.displacement.as_flattened());
            moved.for_each(|(u, change)| *u += change);
            state.bordered.iter_mut().zip(&guess.bordered).for_each(|(y, change)| *y += change);
            let equation = ArcEquation { start, weight, kind: ArcKind::Sphere(at) };
            let iterations = found.iterations;
            found = self.newton(state, Driven::ByArc(&equation), None, Target::Requested, observer)?;
            found.iterations += iterations;
            self.sharpen(&mut found)?;
            let slope = self.slope(start, &found, weight);
            let rise = found.equilibrium.state.parameter - start.parameter;
            if 0.5 * slope * slope / curvature.abs() < LIMIT_TOLERANCE * self.arc.greatest.max(rise.abs()) {
                break;
            }
            ends[usize::from(slope * first < 0.0)] = (at, rise, slope);
        }
        Ok(found)
    }

    /// Change of the load parameter per arc length at a state that was reached from a start.
    fn slope(&self, start: &State, found: &Converged, weight: f64) -> f64 {
        let state = &found.equilibrium.state;
        let change = difference(&state.displacement, &start.displacement);
        let change = Some((&change[..], state.parameter - start.parameter));
        found.rate.as_ref().map_or(0.0, |rate| Direction::after(rate, change, weight).slope())
    }

    fn falls(&self, equation: &ArcEquation<'_>, found: &Converged) -> bool {
        found.rate.as_ref().is_some_and(|rate| equation.is_falling(&found.equilibrium.state, rate))
    }

    /// Whether what a step led to lies on the path that it began on.
    fn check_branch(
        &mut self,
        start: &State,
        found: &Converged,
        direction: &Direction<'_>,
        (weight, size): (f64, f64),
    ) -> Result<(), Cause> {
        let state = &found.equilibrium.state;
        let change = difference(&state.displacement, &start.displacement);
        let (small, corner) = CORNER;
        let least = if size > small * self.settings.min_step { TURNED } else { corner };
        if direction.cosine(&change, state.parameter - start.parameter, weight) < least {
            return Err(Cause::OtherBranch);
        }
        match self.system.passed_through(start, state) {
            Some(obstacle) => Err(Cause::PassedThrough { obstacle }),
            None => Ok(()),
        }
    }

    /// Takes the tangent at an equilibrium itself for its inertia and direction.
    pub(super) fn sharpen(&mut self, found: &mut Converged) -> Result<(), Cause> {
        let Equilibrium { state, negative_pivots, .. } = &mut found.equilibrium;
        self.system.recycle(found.predictor.take());
        self.system.predict(&state.displacement, None);
        let (_, tangent) = self.system.tangent(state)?;
        (self.iterations, found.iterations) = (self.iterations + 1, found.iterations + 1);
        *negative_pivots = tangent.negative_pivots();
        found.rate = Some(self.rate_by(&tangent, state)?);
        found.predictor = Some(tangent);
        Ok(())
    }

    /// The change of all unknowns per change of the load parameter at the present equilibrium, and the number of tangents that it took. The
    /// tangent stays.
    pub(super) fn present_rate(&mut self, start: &State) -> Result<(Correction, usize), Cause> {
        let (tangent, iterations) = self.take_predictor(start)?;
        let rate = self.rate_by(&tangent, start)?;
        if self.first_rate.is_none() {
            self.first_rate = stability::compliance(&mut self.system, &tangent, start, &rate)?;
        }
        self.predictor = Some(tangent);
        Ok((rate, iterations))
    }

    /// The change of all unknowns per change of the load parameter by a tangent.
    pub(super) fn rate_by(&mut self, tangent: &Tangent, state: &State) -> Result<Correction, Cause> {
        let change = arc::probe(state.parameter, self.last);
        let [here, there] = [state.parameter, state.parameter + change].map(|at| self.motion.target(at));
        let held = here.zip(there).map(|(here, there)| difference(&there, &here));
        Ok(self.system.rate(tangent, state, change, held.as_deref())?)
    }
}

fn change_between(start: &State, end: &State) -> Correction {
    Correction {
        displacement: difference(&end.displacement, &start.displacement),
        bordered: end.bordered.iter().zip(&start.bordered).map(|(b, a)| b - a).collect(),
    }
}
