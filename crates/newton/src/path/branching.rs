//! Where a body buckles: the path leaves the branch that becomes unstable along the motion that does (theory §14).

use pneuflex_model::{Continuation, LoadParameter};

use super::newton::Driven;
use super::{Converged, Path, Target};
use crate::arc::{self, ArcEquation, ArcKind};
use crate::event::Observer;
use crate::failure::Cause;
use crate::history::Bifurcation;
use crate::state::{Correction, difference, dot};

/// So many sizes of the motion are tried, each twice the one before.
const SIZES: i32 = 5;

/// It is tried from one equilibrium so often at the most: a smaller step may know the motion better.
const MOST: usize = 4;

/// A state with less than this share of the guess's motion is one of the old branch.
const OLD_BRANCH: f64 = 0.25;

impl Path {
    /// An equilibrium near the present one on a branch that leaves it along the motion that made a step to `attempted` fail, as far as that was
    /// the `cause`; no further than to the `next` requested position. By the load alone the path goes on to greater ones only.
    pub(super) fn leave_branch(
        &mut self,
        cause: &Cause,
        [attempted, next]: [LoadParameter; 2],
        observer: Observer<'_>,
    ) -> Option<Converged> {
        let imperfection = self.settings.imperfection?;
        let is_unstable = matches!(cause, Cause::IndefiniteTangent { .. });
        let start = self.equilibrium.state.clone();
        if !is_unstable || self.branchings >= MOST || start.parameter <= LoadParameter::default() {
            return None;
        }
        self.branchings += 1;
        let (motions, mode) = self.unstable.take()?;
        if motions.are_of_the_mesh() {
            return None;
        }
        self.system.revert();
        self.system.begin_step(&start);
        let (rate, _) = self.present_rate(&start).ok()?;
        self.forget_predictor();
        let weight = arc::weight(&start, self.arc.greatest.max(start.parameter.0), &rate);
        let mode = normalised(mode, &rate);
        let ahead = attempted - start.parameter;
        for power in 0..SIZES {
            for sign in [1.0, -1.0] {
                let size = imperfection * 2.0_f64.powi(power);
                let along = Correction { displacement: mode.clone(), bordered: vec![0.0; rate.bordered.len()] };
                let guess = rate.scaled(ahead).plus(sign * size, &along);
                let mut state = start.moved_to(attempted);
                self.system.move_by(&mut state, &guess).ok()?;
                self.system.predict_ahead(&start, &guess, attempted);
                let sphere = ArcKind::Sphere(arc::length(&guess.displacement, ahead, weight));
                let equation = ArcEquation { start: &start, weight, kind: sphere };
                match self.newton(state, Driven::ByArc(&equation), None, Target::Requested, observer) {
                    Ok(found) if self.is_on_branch(&found, &mode, sign * size, next) => {
                        self.bifurcations.push(Bifurcation { parameter: start.parameter, mode, size, motions });
                        return Some(found);
                    }
                    Ok(found) => self.system.recycle(found.predictor),
                    Err(Cause::Interrupted) => return None,
                    Err(_) => {}
                }
                self.system.revert();
                self.system.begin_step(&start);
            }
        }
        None
    }

    /// Whether states are taken whatever their inertia: past a limit point, unless the path is to leave a branch that becomes unstable there, and
    /// has not tried in vain.
    pub(super) fn takes_unstable(&self) -> bool {
        let leaves = self.settings.imperfection.is_some() && self.branchings < MOST;
        let was_stable = self.equilibrium.negative_pivots == 0 && !self.arc.is_falling;
        self.arc.is_past_limit() && !(leaves && was_stable)
    }

    /// Whether a state lies on the branch that a guess with a motion of a size was to lead to, and the path may go on there.
    fn is_on_branch(&self, found: &Converged, mode: &[[f64; 3]], size: f64, next: LoadParameter) -> bool {
        let (start, state) = (&self.equilibrium.state, &found.equilibrium.state);
        let change = difference(&state.displacement, &start.displacement);
        let share = dot(&change, mode) / (size * dot(mode, mode));
        let goes_on = match self.settings.continuation {
            Continuation::Load | Continuation::Damped => {
                found.equilibrium.negative_pivots == 0 && state.parameter > start.parameter
            }
            Continuation::ArcLength => true,
        };
        share > OLD_BRANCH && goes_on && state.parameter <= next && state.parameter > LoadParameter::default()
    }
}

/// A motion whose largest displacement is 1, in the sense in which the body moves already.
pub(super) fn normalised(mut mode: Vec<[f64; 3]>, rate: &Correction) -> Vec<[f64; 3]> {
    let largest = mode.iter().map(|u| u.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max).sqrt();
    let factor = if dot(&mode, &rate.displacement) < 0.0 { -largest } else { largest };
    mode.as_flattened_mut().iter_mut().for_each(|x| *x /= factor);
    mode
}
