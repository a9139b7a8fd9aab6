//! Load steps that begin at the guesses which the equilibrium path of a similar problem gives (theory §14).

use pneuflex_model::{Continuation, LoadParameter};
use serde::{Deserialize, Serialize};

use super::newton::Driven;
use super::step_control::Attempt;
use super::{Converged, Path, Target};
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure};
use crate::linearisation::Linearisation;
use crate::state::{State, difference, dot};
use crate::tangent_solver::Tangent;

/// A step that differs from the neighbour's by more than this share of it may have come to another branch.
const UNLIKE: f64 = 0.5;

/// A neighbour's state that is nearer than this share of its step is passed over.
const CRUMB: f64 = 0.25;

/// The equilibria that the path of a problem has come to, load step by load step, with the stresses that the tangent there carries.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumPath(Vec<Linearisation>);

/// A step of a neighbour.
struct Guess<'a> {
    /// Where it ends.
    end: &'a Linearisation,
    /// Displacements on the way there, mm, one entry per node.
    change: Vec<[f64; 3]>,
}

impl EquilibriumPath {
    /// Adds an accepted load step. A path that has gone back forgets what was beyond.
    fn push(&mut self, state: Linearisation) {
        self.0.retain(|before| before.parameter < state.parameter);
        self.0.push(state);
    }

    /// Displacement at the end of the step before a state of it, mm, and its position.
    fn before(&self, number: usize) -> (Vec<[f64; 3]>, LoadParameter) {
        match number.checked_sub(1).map(|before| &self.0[before]) {
            Some(before) => (before.displacement.clone(), before.parameter),
            None => (vec![[0.0; 3]; self.0[number].displacement.len()], LoadParameter::default()),
        }
    }

    /// The step on from a position; none beyond a requested one, and beyond the end.
    fn guess(&self, from: LoadParameter, requested: LoadParameter) -> Option<Guess<'_>> {
        let is_next = |number: &usize| {
            self.0[*number].parameter - from > CRUMB * (self.0[*number].parameter - self.before(*number).1)
        };
        let number = (0..self.0.len()).find(is_next)?;
        let end = &self.0[number];
        if end.parameter > requested {
            return None;
        }
        let begin = self.displacement_at(from);
        Some(Guess { end, change: difference(&end.displacement, &begin) })
    }

    /// The displacement at a position that is not beyond its end, mm.
    fn displacement_at(&self, position: LoadParameter) -> Vec<[f64; 3]> {
        let Some(number) = self.0.iter().position(|state| state.parameter >= position) else { return Vec::new() };
        let (mut displacement, at) = self.before(number);
        let end = &self.0[number];
        let share = (position - at) / (end.parameter - at);
        let change = difference(&end.displacement, &displacement);
        let pairs = displacement.as_flattened_mut().iter_mut().zip(change.as_flattened());
        pairs.for_each(|(u, change)| *u += share * change);
        displacement
    }
}

impl Path {
    /// Takes the guesses of its load steps from the path of a similar problem on a mesh of the same topology. No step is much longer than the
    /// neighbour's, so that nothing is left out which a path from rest looks at, and what is found is the same to the tolerances; where the two
    /// differ the path ends with [`Cause::OtherBranch`]. Says whether the neighbour can be used: where the equations have unknowns beside the
    /// displacements, anything moves but by loads, or the path may go on beyond limit points, it is not.
    pub fn start_from(&mut self, neighbour: EquilibriumPath) -> bool {
        let (num_nodes, num_stored) = (self.mesh.num_nodes(), self.system.num_stored());
        let is_used = self.settings.continuation == Continuation::Load
            && self.settings.imperfection.is_none()
            && self.system.num_bordered() == 0
            && !self.system.is_augmented()
            && !self.motion.is_driving()
            && !neighbour.0.is_empty()
            && neighbour.0.iter().all(|state| state.fits(num_nodes, 0, num_stored));
        self.neighbour = is_used.then_some(neighbour);
        is_used
    }

    /// Keeps its equilibria for the paths of similar problems.
    pub fn keep_equilibria(&mut self) {
        self.kept = Some(EquilibriumPath::default());
    }

    /// The equilibria that were kept; none of a path that has left a branch, snapped, may have snapped, or gone beyond a limit point.
    pub fn take_equilibria(&mut self) -> Option<EquilibriumPath> {
        self.kept.take().filter(|kept| !kept.0.is_empty())
    }

    /// Keeps the present equilibrium, if that is wanted.
    pub(super) fn keep_equilibrium(&mut self) {
        if !self.bifurcations.is_empty() || !self.snaps.is_empty() {
            self.keep_nothing();
        }
        if let Some(kept) = &mut self.kept {
            kept.push(self.system.next_linearisation(&self.equilibrium.state));
        }
    }

    /// Another problem need not do the same.
    pub(super) fn keep_nothing(&mut self) {
        self.kept = None;
    }

    /// A step along the neighbour's path towards a requested position; none where there is none.
    pub(super) fn step_with_neighbour(
        &mut self,
        requested: LoadParameter,
        observer: Observer<'_>,
    ) -> Option<Result<(Converged, Attempt), Failure>> {
        let start = self.equilibrium.state.clone();
        // The first step tells how firm the body is at rest.
        if start.parameter <= LoadParameter::default() {
            return None;
        }
        let neighbour = self.neighbour.take()?;
        let found = neighbour.guess(start.parameter, requested).map(|guess| {
            self.step += 1;
            let attempted = guess.end.parameter;
            let size = attempted - start.parameter;
            let attempt =
                Attempt { start: start.parameter, wanted: size, tried: size, attempted, had_predictor: false };
            let converged = self.newton_from(&start, &guess, requested, observer);
            converged.map(|converged| (converged, attempt)).map_err(|cause| {
                self.system.revert();
                let is_of_path = !matches!(cause, Cause::Interrupted | Cause::OutOfMemory(_));
                self.failure(attempted, if is_of_path { Cause::OtherBranch } else { cause })
            })
        });
        self.neighbour = Some(neighbour);
        found
    }

    fn newton_from(
        &mut self,
        start: &State,
        guess: &Guess<'_>,
        requested: LoadParameter,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        self.check_stop()?;
        self.system.begin_step(start);
        self.forget_predictor();
        let attempted = guess.end.parameter;
        let mut state = start.moved_to(attempted);
        let pairs = state.displacement.as_flattened_mut().iter_mut().zip(guess.change.as_flattened());
        pairs.for_each(|(u, change)| *u += change);
        // Its own stresses would be those of another body's displacement, in which the nearly incompressible material is far from equilibrium.
        self.system.carry(guess.end);
        let target = if attempted == requested || self.is_careful { Target::Requested } else { Target::OnTheWay };
        observer(Event::StepStarted { step: self.step, parameter: attempted });
        let mut converged = self.newton(state, Driven::ByLoad(None), None, target, observer)?;
        self.judge_by_own_stresses(&mut converged, guess)?;
        let state = &converged.equilibrium.state;
        let change = difference(&state.displacement, &start.displacement);
        let unlike = difference(&change, &guess.change);
        let is_like = dot(&unlike, &unlike) <= UNLIKE * UNLIKE * dot(&guess.change, &guess.change);
        if is_like && converged.equilibrium.negative_pivots == 0 && self.system.passed_through(start, state).is_none() {
            return Ok(converged);
        }
        self.system.recycle(converged.predictor);
        Err(Cause::OtherBranch)
    }

    /// Makes a tangent at the state that was found if the last one has the stresses of the neighbour, under which a body that buckles may be
    /// stable.
    fn judge_by_own_stresses(&mut self, converged: &mut Converged, guess: &Guess<'_>) -> Result<(), Cause> {
        let is_own = |tangent: &Tangent| tangent.linearisation().stored != guess.end.stored;
        if converged.predictor.as_ref().is_some_and(is_own) {
            return Ok(());
        }
        self.system.recycle(converged.predictor.take());
        (self.iterations, converged.iterations) = (self.iterations + 1, converged.iterations + 1);
        let (_, tangent) = self.system.tangent(&converged.equilibrium.state)?;
        converged.equilibrium.negative_pivots = tangent.negative_pivots();
        converged.predictor = Some(tangent);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(states: &[(f64, f64)]) -> EquilibriumPath {
        let mut path = EquilibriumPath::default();
        for &(at, x) in states {
            let (parameter, displacement) = (LoadParameter(at), vec![[x, 0.0, 0.0]]);
            path.push(Linearisation { parameter, displacement, bordered: Vec::new(), stored: vec![10.0 * x] });
        }
        path
    }

    #[test]
    fn guesses_end_at_its_states_but_for_crumbs_and_pass_over_nothing_that_is_asked_for() {
        let path = path(&[(5.0, 1.0), (10.0, 2.0), (20.0, 4.0)]);
        let guess = |from: f64, requested: f64| {
            let found = path.guess(LoadParameter(from), LoadParameter(requested));
            found.map(|guess| (guess.end.parameter.0, guess.change[0][0], guess.end.stored[0]))
        };
        assert_eq!(guess(5.0, 30.0), Some((10.0, 1.0, 20.0)));
        assert_eq!(guess(2.5, 30.0), Some((5.0, 0.5, 10.0)));
        assert_eq!(guess(4.5, 30.0), Some((10.0, 1.1, 20.0)));
        assert_eq!(guess(12.5, 30.0), Some((20.0, 1.5, 40.0)));
        assert_eq!((guess(10.0, 15.0), guess(20.0, 30.0), guess(25.0, 30.0)), (None, None, None));
    }

    #[test]
    fn what_was_beyond_is_forgotten_where_it_has_gone_back() {
        let going_back = path(&[(5.0, 1.0), (10.0, 2.5), (15.0, 8.0), (12.0, 3.0)]);
        assert_eq!(going_back, path(&[(5.0, 1.0), (10.0, 2.5), (12.0, 3.0)]));
    }
}
