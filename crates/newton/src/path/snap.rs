//! Where a body snaps: from the last equilibrium of a path to the next stable one under the same loads, by a motion that dampers hold back
//! (theory §14). A pseudo-transient continuation (Kelley & Keyes 1998, *SIAM J. Numer. Anal.* 35): c (u − uₙ)/Δτ + r(u) = 0 from step to step, Δτ
//! growing without limit. Every step releases energy, so that what it comes to is a minimum, and the dampers carry nothing there.

use pneuflex_model::{Continuation, LoadParameter};

use super::branching::normalised;
use super::newton::Driven;
use super::{Converged, Path, Target};
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure};
use crate::history::Snap;
use crate::state::{Correction, State, difference, dot};

/// Steps of pseudo-time at the most, those that failed included.
const MOST: usize = 1000;

/// 1/Δτ of the first step, and beyond which a snap is given up.
const RATES: [f64; 2] = [10.0, 1e9];

/// 1/Δτ falls by this factor after a step that took few iterations,
const FASTER: f64 = 0.4;

/// and grows by this one where one fails.
const SLOWER: f64 = 5.0;

/// A rate that failed is not come nearer to than this factor,
const LONGER: f64 = 1.6;

/// and counts as this share of itself after every step that succeeds.
const FORGETTING: f64 = 0.7;

/// So many iterations are few.
const FEW: usize = 7;

/// A step that takes more is too long: where its equation has no solution near by, Newton's method would roam.
const MOST_ITERATIONS: usize = 14;

/// A guess that has to be shortened further than this share calls for a smaller Δτ instead.
const SHORTENED: f64 = 0.5;

/// The dampers are let go when they carry less than this share of the greatest force so far, and again at this share of that.
const LET_GO: f64 = 0.1;

/// Without dampers the body may move no further than this, in mean spacings of the nodes: it would be another snap.
const SETTLED: f64 = 1.0;

/// An unstable body is pushed along its motion by this share of the mean spacing of the nodes, unless the user says by how much.
const PUSH: f64 = 0.05;

/// Relative difference of the work of a step by twice as many points from which on it is known,
const WORK_TOLERANCE: f64 = 1e-3;

/// unless it is less than this share of what a stress of the shear modulus does on an element,
const NO_WORK: f64 = 1e-6;

/// and how often the points are doubled at the most.
const MOST_HALVINGS: u32 = 8;

/// The motion so far.
struct Motion {
    /// 1/Δτ.
    rate: f64,
    /// What it does not fall below, as that failed before.
    failed: f64,
    /// Greatest force of the dampers, N.
    greatest: f64,
    /// Force at which they are let go next, N.
    let_go: f64,
    /// Energy released, mJ; `None` if it is not known of every step.
    released: Option<f64>,
    steps: usize,
}

impl Motion {
    fn add(&mut self, released: Option<f64>) {
        self.released = self.released.zip(released).map(|(so_far, released)| so_far + released);
    }
}

/// What a step of pseudo-time led to.
enum Step {
    Done {
        iterations: usize,
        /// Force that the dampers carried at its end, N.
        force: f64,
        /// As [`Motion::released`].
        released: Option<f64>,
    },
    /// This share of it was all that could be done.
    TooFar(f64),
}

impl Path {
    /// A stable equilibrium under the loads at which the path has ended, or the failure itself if that does not help or none is found.
    pub(super) fn snap(&mut self, failure: Failure, observer: Observer<'_>) -> Result<Converged, Failure> {
        let may_help = !matches!(
            failure.cause,
            Cause::Interrupted | Cause::OutOfMemory(_) | Cause::Rounding { .. } | Cause::HeldBySprings { .. }
        );
        if !matches!(failure.cause, Cause::IndefiniteTangent { .. }) {
            self.unstable = None;
        }
        let is_of_mesh = self.unstable.as_ref().is_some_and(|(motions, _)| motions.are_of_the_mesh());
        if self.settings.continuation != Continuation::Damped || !may_help || is_of_mesh {
            return Err(failure);
        }
        let before = self.equilibrium.clone();
        let aim = failure.attempted.max(before.state.parameter);
        self.forget_predictor();
        let most = std::mem::replace(&mut self.settings.max_iterations, MOST_ITERATIONS);
        let found = self.move_damped(aim, observer);
        self.settings.max_iterations = most;
        self.system.damp(0.0);
        self.system.begin_step(&before.state);
        self.equilibrium = before;
        match found {
            Ok((converged, motion)) => {
                let snap = self.jump(&converged);
                self.snaps.push(Snap { released: motion.released, steps: motion.steps, ..snap });
                Ok(converged)
            }
            Err(cause) => {
                self.system.revert();
                let cause = if cause == Cause::Interrupted { cause } else { failure.cause };
                Err(Failure { cause, ..failure })
            }
        }
    }

    /// Steps of pseudo-time until the dampers carry nothing; the present equilibrium is where they have come to.
    fn move_damped(&mut self, aim: LoadParameter, observer: Observer<'_>) -> Result<(Converged, Motion), Cause> {
        let mut motion =
            Motion { rate: RATES[0], failed: 0.0, greatest: 0.0, let_go: 0.0, released: Some(0.0), steps: 0 };
        let mut iterations = 0;
        self.equilibrium.state = self.equilibrium.state.moved_to(aim);
        while motion.steps < MOST && motion.rate < RATES[1] {
            self.check_stop()?;
            motion.steps += 1;
            self.step += 1;
            observer(Event::StepStarted { step: self.step, parameter: aim });
            match self.damped_step(motion.rate, observer) {
                Ok(Step::Done { iterations: taken, force, released }) => {
                    iterations += taken;
                    motion.add(released);
                    motion.greatest = motion.greatest.max(force);
                    if force < LET_GO * motion.greatest && (motion.let_go == 0.0 || force < motion.let_go) {
                        motion.let_go = LET_GO * force;
                        if let Some(mut converged) = self.settle(&mut motion, observer)? {
                            converged.iterations += iterations;
                            return Ok((converged, motion));
                        }
                    } else if force > LET_GO * motion.greatest {
                        motion.let_go = 0.0;
                    }
                    if taken <= FEW {
                        motion.rate = (FASTER * motion.rate).max(motion.failed);
                    }
                    motion.failed *= FORGETTING;
                }
                Ok(Step::TooFar(share)) => {
                    motion.failed = LONGER * motion.rate;
                    motion.rate /= share.max(1.0 / SLOWER);
                }
                Err(cause @ (Cause::Interrupted | Cause::OutOfMemory(_))) => return Err(cause),
                Err(cause) => {
                    observer(Event::StepRejected { step: self.step, parameter: aim, cause: &cause });
                    self.system.revert();
                    motion.failed = LONGER * motion.rate;
                    motion.rate *= SLOWER;
                }
            }
        }
        Err(Cause::OtherBranch)
    }

    /// One step of pseudo-time from where the body is.
    fn damped_step(&mut self, rate: f64, observer: Observer<'_>) -> Result<Step, Cause> {
        self.system.damp(rate);
        let start = self.equilibrium.state.clone();
        self.system.begin_step(&start);
        self.system.predict(&start.displacement, None);
        let (assembled, tangent) = self.system.tangent(&start)?;
        self.iterations += 1;
        if tangent.negative_pivots() > 0 {
            self.system.recycle(Some(tangent));
            return Ok(Step::TooFar(0.0));
        }
        let held = self.motion.target(start.parameter);
        let change = self.motion.change(&start);
        let mut correction = self.system.solve(&tangent, &assembled, change.as_deref())?;
        self.system.recycle(Some(tangent));
        if let Some(push) = self.push(&correction) {
            correction = correction.plus(1.0, &push);
        }
        let (guess, share) = self.shortened(&start, &correction, start.parameter)?;
        if share < SHORTENED {
            return Ok(Step::TooFar(share));
        }
        let found = self.newton(guess, Driven::ByLoad(held.as_deref()), None, Target::Requested, observer)?;
        self.system.recycle(found.predictor);
        let state = &found.equilibrium.state;
        if let Some(obstacle) = self.system.passed_through(&start, state) {
            return Err(Cause::PassedThrough { obstacle });
        }
        let forces = self.system.vanishing_forces(&state.displacement).unwrap_or_default();
        let force = self.system.free_norm(&forces);
        let released = self.released([&start, state], &assembled.residual)?;
        self.equilibrium = found.equilibrium;
        Ok(Step::Done { iterations: 1 + found.iterations, force, released })
    }

    /// Energy that the body and its loads give up between two states, mJ: the work of the residual along the straight line between them, by
    /// Romberg's rule; `first` is the residual of the first one, N. `None` if elements are turned inside out on the way.
    fn released(&mut self, [start, end]: [&State; 2], first: &[[f64; 3]]) -> Result<Option<f64>, Cause> {
        self.system.damp(0.0);
        let change = difference(&end.displacement, &start.displacement);
        let mut between = start.clone();
        let mut along = |path: &mut Self, share: f64| {
            let pairs = start.displacement.as_flattened().iter().zip(change.as_flattened());
            let moved = between.displacement.as_flattened_mut().iter_mut().zip(pairs);
            moved.for_each(|(u, (start, change))| *u = start + share * change);
            let pairs = start.bordered.iter().zip(&end.bordered);
            between.bordered.iter_mut().zip(pairs).for_each(|(y, (start, end))| *y = start + share * (end - start));
            let residual = path.system.residual(&between).ok()?.residual;
            Some(-dot(&path.system.free_part(&residual), &change))
        };
        let Some(last) = along(self, 1.0) else { return Ok(None) };
        let (mut trapezoid, mut simpson) = (0.5 * (last - dot(&self.system.free_part(first), &change)), f64::INFINITY);
        let least = NO_WORK * self.scales.force * self.scales.length;
        for halvings in 0..MOST_HALVINGS {
            self.check_stop()?;
            let parts = f64::from(1 << halvings);
            let middles = (0..1 << halvings).map(|part| along(self, (f64::from(part) + 0.5) / parts));
            let Some(sum) = middles.sum::<Option<f64>>() else { return Ok(None) };
            let finer = 0.5 * (trapezoid + sum / parts);
            let better = (4.0 * finer - trapezoid) / 3.0;
            if (better - simpson).abs() <= WORK_TOLERANCE * better.abs().max(least) {
                return Ok(Some(better));
            }
            (trapezoid, simpson) = (finer, better);
        }
        Ok(None)
    }

    /// The equilibrium to which the body comes without dampers from where it is; `None` if it does not stay there. A motion that is unstable
    /// there is left in `self.unstable` for the next step.
    fn settle(&mut self, motion: &mut Motion, observer: Observer<'_>) -> Result<Option<Converged>, Cause> {
        self.system.damp(0.0);
        let start = self.equilibrium.state.clone();
        self.system.begin_step(&start);
        self.system.predict(&start.displacement, None);
        let (assembled, tangent) = self.system.tangent(&start)?;
        self.iterations += 1;
        let is_stable = tangent.negative_pivots() == 0;
        if !is_stable && motion.rate > 1.0 {
            self.system.recycle(Some(tangent));
            return Ok(None);
        }
        let held = self.motion.target(start.parameter);
        let driven = Driven::ByLoad(held.as_deref());
        match self.newton(start.clone(), driven, Some(tangent), Target::Requested, observer) {
            Ok(found) => {
                let change = difference(&found.equilibrium.state.displacement, &start.displacement);
                let moved = change.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                if found.equilibrium.negative_pivots == 0 && moved < SETTLED * self.scales.length {
                    motion.add(self.released([&start, &found.equilibrium.state], &assembled.residual)?);
                    return Ok(Some(found));
                }
                self.system.recycle(found.predictor);
            }
            Err(cause @ (Cause::Interrupted | Cause::OutOfMemory(_))) => return Err(cause),
            Err(Cause::IndefiniteTangent { .. }) => motion.rate = RATES[0],
            Err(_) => {}
        }
        self.system.revert();
        Ok(None)
    }

    /// A small motion along the one that was found to be unstable, once: by itself a symmetric body leaves no unstable equilibrium.
    fn push(&mut self, correction: &Correction) -> Option<Correction> {
        let (motions, mode) = self.unstable.take()?;
        if motions.are_of_the_mesh() {
            return None;
        }
        let size = self.settings.imperfection.unwrap_or(PUSH * self.scales.length);
        let along =
            Correction { displacement: normalised(mode, correction), bordered: vec![0.0; correction.bordered.len()] };
        Some(along.scaled(size))
    }

    /// How the body has jumped from the present equilibrium to another one, without dampers.
    pub(super) fn jump(&self, converged: &Converged) -> Snap {
        let (before, after): (&State, &State) = (&self.equilibrium.state, &converged.equilibrium.state);
        let change = difference(&after.displacement, &before.displacement);
        let length = |u: &[f64; 3]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (node, moved) =
            change.iter().map(length).enumerate().fold((0, 0.0), |most, now| if now.1 > most.1 { now } else { most });
        let place = self.mesh.nodes[node];
        Snap { from: before.parameter, to: after.parameter, node, place, moved, released: None, steps: 0 }
    }
}
