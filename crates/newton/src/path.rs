//! Newton-Raphson at one load, and the load stepping around it (Fig. 3 of the paper, Steps 1–8).

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_assembly::Request;
use pneuflex_factor::Parallelism;
use pneuflex_model::{Clock, Problem, Solver};

use crate::checkpoint::{Approach, Checkpoint, Misfit};
use crate::history::{
    Augmentation, Cause, Event, Failure, IterationRecord, LandedState, PathReport, Stability, Timing,
};
use crate::system::{AssembleError, Correction, SetupError, System, extent_of};
use crate::warp::Extent;

/// A correction this much larger than the body is no use.
const RUNAWAY: f64 = 1e3;

/// Guesses are shortened where they would drive walls deeper than this into each other, mm.
const DEEP: f64 = 0.2;

/// By how much a guess is shortened at a time, and at the most.
const SHORTEN: f64 = 0.7;
const SHORTEST: f64 = 0.03;

/// Guesses are shortened to this stretching and rotation (radians) at any point: Newton's method hardly returns from further away.
const GUESS: Extent = Extent { stretch: 0.2, angle: 0.7 };

/// A correction with more stretching or rotation than this comes from a tangent that is nearly singular, and leads nowhere.
const HOPELESS: Extent = Extent { stretch: 0.7, angle: 1.5 };

/// Corrections smaller than this are not hopeless, mm.
const HARMLESS: f64 = 0.1;

/// From this iteration on a correction that is not clearly smaller than the one so many tangents before is halved: contact points that
/// open and close in turn let Newton's method run in circles.
const CIRCLING_FROM: usize = 8;
const CIRCLE: usize = 3;
const NOT_SMALLER: f64 = 0.7;

/// A load step that is not a requested one is good enough when no node moves further than this, mm, and nothing is stretched further than
/// this: in small elements 0.1 mm would leave stresses from which there is no going on.
const LOOSE: f64 = 0.1;
const LOOSE_STRETCH: f64 = 0.05;

/// Materials whose bulk modulus is a larger multiple of the shear modulus than this allow the less of it, the less they allow of a change of
/// volume.
const LOOSE_RATIO: f64 = 2e4;

/// Once a correction moves no node further than this (mm), the factor at hand is tried for the next ones.
const STALE_BELOW: f64 = 0.05;

/// Corrections in a row with the same old factor, at the most.
const MOST_STALE: usize = 8;

/// After the present equilibrium was solved again to the tolerances, the next step is at least this share of the rejected one.
const AFTER_POLISHING: f64 = 0.25;

/// Displacements of supports below this are rounding, mm.
const ROUNDED: f64 = 1e-13;

/// Residuals below this are rounding, N: it bounds the relative tolerance from below where the load is tiny.
const RESIDUAL_FLOOR: f64 = 1e-9;

/// Rounding is accepted in the residual up to this multiple of the tolerance asked for.
const MOST_ROUNDING: f64 = 10.0;

/// Unknowns up to which the tolerance of the correction's norm can be met whatever the rounding. Beyond, rounding makes the norm
/// grow with the root of their number.
const FEW_UNKNOWNS: f64 = 1e4;

/// A correction with an old factor that is not smaller than this share of the one before is thrown away.
const STALE_CONTRACTION: f64 = 0.5;

/// An equilibrium, the start of the next step.
#[derive(Clone, Debug)]
struct State {
    time: f64,
    displacement: Vec<[f64; 3]>,
    /// Unknowns beside the displacements.
    border: Vec<f64>,
    multipliers: Vec<f64>,
    contact_points: usize,
    /// Solved well enough to go on from, not to the tolerances asked for.
    is_loose: bool,
}

/// Follows equilibria of one problem from rest.
pub struct Path<'a> {
    system: System,
    settings: &'a Solver,
    observer: &'a mut dyn FnMut(Event<'_>),
    begin: Instant,
    state: State,
    /// The factor belongs to the present state's tangent, so it predicts the next one.
    has_factor: bool,
    size: f64,
    /// Stretching that is loose enough, see [`LOOSE_STRETCH`].
    loose_stretch: f64,
    /// Residual that rounding leaves per mm of the body's extent, N/mm; see [`Path::rounding`].
    rounding_per_mm: f64,
    step: usize,
    iterations: usize,
    /// The way to the next requested pressure, if it has begun.
    approach: Option<Approach>,
    stability: Stability,
    /// Moves the supports of a problem; `None` if they never move.
    moving: Option<Problem>,
    clock: Clock,
    /// Largest stretching per time at the beginning.
    first_rate: Option<f64>,
    /// Seconds spent before this path was resumed.
    spent: Timing,
    stop: Option<&'a AtomicBool>,
    /// Largest distance of contact points asked for at requested loads, mm.
    penetration_tolerance: Option<f64>,
    augmentation: Option<Augmentation>,
}

/// How well a load step is to be solved.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    /// To the tolerance asked for.
    Requested,
    /// Well enough to go on from.
    OnTheWay,
}

/// Measures of a correction.
#[derive(Clone, Copy, Default)]
struct Measures {
    /// ‖\[Δq; Δλ\]‖, mm and N.
    norm: f64,
    /// Largest component of Δq, mm.
    largest: f64,
    /// Whether the next one is to be tried with the same factor.
    goes_on: bool,
    /// Residual norm before it, N.
    residual: f64,
}

/// An attempt that converged.
struct Converged {
    state: State,
    iterations: usize,
}

impl<'a> Path<'a> {
    /// Starts at rest.
    ///
    /// # Errors
    /// [`SetupError`] if the equations cannot be set up.
    pub fn new(
        problem: &Problem,
        settings: &'a Solver,
        observer: &'a mut dyn FnMut(Event<'_>),
    ) -> Result<Self, SetupError> {
        let begin = Instant::now();
        let system = System::new(problem, Parallelism::Threads)?;
        let n = problem.mesh.num_nodes();
        let size = extent_of(&problem.mesh);
        let state = State {
            time: 0.0,
            displacement: vec![[0.0; 3]; n],
            border: vec![0.0; system.border_len()],
            multipliers: vec![0.0; 3 * n],
            contact_points: 0,
            is_loose: false,
        };
        let element_size = (problem.mesh.volume() / problem.mesh.num_elements().max(1) as f64).cbrt();
        let materials = problem.materials().0;
        let bulk_modulus = materials.iter().map(|material| material.bulk_modulus).fold(0.0, f64::max);
        let ratio = materials.iter().map(|m| m.bulk_modulus / m.shear_modulus()).fold(LOOSE_RATIO, f64::max);
        let rounding_per_mm = f64::EPSILON * bulk_modulus * element_size * (n as f64).sqrt();
        Ok(Self {
            system,
            settings,
            observer,
            begin,
            state,
            has_factor: false,
            size,
            loose_stretch: LOOSE_STRETCH * LOOSE_RATIO / ratio,
            rounding_per_mm,
            step: 0,
            iterations: 0,
            approach: None,
            stability: Stability::default(),
            moving: problem.supports.iter().any(|support| support.motion.is_some()).then(|| problem.clone()),
            clock: problem.clock,
            first_rate: None,
            spent: Timing::default(),
            stop: None,
            penetration_tolerance: problem.contact.penetration_tolerance,
            augmentation: None,
        })
    }

    /// Goes on from a checkpoint of the same problem: everything from here on is as if the path had never ended.
    ///
    /// # Errors
    /// [`ResumeError`] if the checkpoint does not fit the problem; the path is still at rest then.
    pub fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), ResumeError> {
        checkpoint.check(self.state.displacement.len(), self.system.num_contact_points(), self.state.border.len())?;
        self.has_factor = checkpoint.linearisation.is_some();
        self.system.set_contact_multipliers(checkpoint.contact_multipliers);
        self.augmentation = checkpoint.augmentation;
        if let Some(linearisation) = checkpoint.linearisation {
            self.system.restore(linearisation)?;
        }
        let Checkpoint { time, displacement, border, multipliers, contact_points, is_loose, .. } = checkpoint;
        self.state = State { time, displacement, border, multipliers, contact_points, is_loose };
        (self.step, self.iterations) = (checkpoint.step, checkpoint.iterations);
        self.approach = Some(checkpoint.approach);
        self.first_rate = checkpoint.first_rate;
        self.spent = checkpoint.timing;
        Ok(())
    }

    /// Lets the path end with [`Cause::Interrupted`] before the next iteration once `stop` is true.
    pub fn stop_when(&mut self, stop: &'a AtomicBool) {
        self.stop = Some(stop);
    }

    fn check_stop(&self) -> Result<(), Cause> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => Err(Cause::Interrupted),
            _ => Ok(()),
        }
    }

    /// Newton iterations so far, those of rejected attempts included.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Seconds spent so far.
    pub fn timing(&self) -> Timing {
        let now = Timing { total_s: self.begin.elapsed().as_secs_f64(), ..self.system.timing };
        Timing {
            assembly_s: self.spent.assembly_s + now.assembly_s,
            factor_s: self.spent.factor_s + now.factor_s,
            solve_s: self.spent.solve_s + now.solve_s,
            contact_s: self.spent.contact_s + now.contact_s,
            total_s: self.spent.total_s + now.total_s,
        }
    }

    /// Displacements of the present equilibrium, mm.
    pub fn displacement(&self) -> &[[f64; 3]] {
        &self.state.displacement
    }

    /// The system, e.g. for its energies.
    pub fn system(&mut self) -> &mut System {
        &mut self.system
    }

    /// Steps from the present equilibrium to `time` and lands on it exactly.
    ///
    /// # Errors
    /// [`Failure`] when the step falls below its least size; the present equilibrium is then the last one reached.
    pub fn advance_to(&mut self, time: f64) -> Result<LandedState, Failure> {
        let step = match self.state.time > 0.0 {
            true => self.settings.max_step,
            false => self.settings.first_step.max(self.settings.min_step),
        };
        let fresh = Approach { step, load_steps: 0, iterations_before: self.iterations };
        let mut approach = self.approach.take().unwrap_or(fresh);
        approach.step = approach.step.min(self.settings.max_step);
        while self.state.time < time {
            let start = self.state.time;
            // A last step that would leave a crumb takes it along.
            let is_last = time - start <= 1.01 * approach.step;
            let wanted = if is_last { time } else { start + approach.step };
            self.step += 1;
            let mut attempted = wanted;
            let had_factor = self.has_factor;
            match self.load_step(&mut attempted, time) {
                Ok(converged) => {
                    approach.load_steps += 1;
                    if converged.iterations <= 8 {
                        approach.step = (2.0 * (wanted - start)).min(self.settings.max_step);
                    }
                    self.state = converged.state;
                    self.augmentation = None;
                    if let Some(tolerance) = self.penetration_tolerance.filter(|_| attempted == time)
                        && let Err(cause) = self.augment(tolerance)
                    {
                        return Err(self.failure(attempted, cause));
                    }
                    let checkpoint = self.checkpoint(approach);
                    (self.observer)(Event::StepAccepted(&checkpoint));
                }
                Err(Cause::Interrupted) => return Err(self.failure(attempted, Cause::Interrupted)),
                Err(cause) => {
                    (self.observer)(Event::StepRejected { step: self.step, time: attempted, cause: &cause });
                    self.has_factor = false;
                    approach.step = 0.5 * (attempted - start);
                    if self.state.is_loose {
                        // What is left of its residual misleads the guess; solved to the tolerances it gets a longer step again.
                        self.state.is_loose = false;
                        self.confirm();
                        let again = AFTER_POLISHING * (wanted - start);
                        approach.step = approach.step.max(again).max(self.settings.min_step);
                    }
                    if had_factor {
                        // The guess came from a tangent near the equilibrium; the one at the equilibrium gets its chance.
                        approach.step = approach.step.max(self.settings.min_step);
                    }
                    if approach.step < self.settings.min_step {
                        self.confirm();
                        return Err(self.failure(attempted, cause));
                    }
                }
            }
        }
        Ok(self.land(self.iterations - approach.iterations_before, approach.load_steps))
    }

    fn failure(&self, attempted: f64, cause: Cause) -> Failure {
        Failure { reached: self.state.time, attempted, cause, stability: self.stability, clock: self.clock }
    }

    /// Solves the present equilibrium, perhaps one on the way, to the tolerances asked for, and finds out how firm it is: otherwise what
    /// was left of the residual would speak of stability, too.
    fn confirm(&mut self) {
        if self.state.time <= 0.0 {
            return;
        }
        let u = self.state.displacement.clone();
        self.system.carry_pressures(&u);
        match self.newton(self.state.time, (u, self.state.border.clone()), None, Target::Requested) {
            Ok(converged) => {
                self.state = converged.state;
                // An equilibrium whose tangent is singular is as unstable as can be told.
                let softening = self.softening().unwrap_or(f64::INFINITY);
                self.stability = Stability { softening, negative_pivots: 0 };
            }
            Err(Cause::IndefiniteTangent { negative_pivots }) => self.stability.negative_pivots = negative_pivots,
            // Nothing new is known.
            Err(_) => {}
        }
        self.has_factor = false;
    }

    /// [`Stability::softening`] of the present equilibrium.
    fn softening(&mut self) -> Result<f64, Cause> {
        let State { displacement: u, border, time, .. } = self.state.clone();
        let change = (1e-3 * time).max(self.settings.min_step);
        self.system.carry_pressures(&u);
        self.system.assemble(&u, time, &border, Request::Tangent)?;
        self.system.factorize()?;
        let prescribed = self.prescribed(time + change, &u);
        self.system.assemble(&u, time + change, &border, Request::Residual)?;
        let correction = self.system.solve(prescribed.as_deref())?;
        let rate = self.system.extent(&u, &correction.displacement).stretch / change;
        Ok(self.first_rate.map_or(1.0, |first| rate / first))
    }

    /// [`Self::advance_to`], and tells the observer.
    ///
    /// # Errors
    /// As there.
    pub fn land_on(&mut self, time: f64) -> Result<(), Failure> {
        let landed = self.advance_to(time)?;
        (self.observer)(Event::Landed(&landed));
        Ok(())
    }

    fn checkpoint(&self, approach: Approach) -> Checkpoint {
        let State { time, displacement, border, multipliers, contact_points, is_loose } = self.state.clone();
        Checkpoint {
            time,
            displacement,
            border,
            multipliers,
            contact_points,
            is_loose,
            step: self.step,
            iterations: self.iterations,
            timing: self.timing(),
            approach,
            first_rate: self.first_rate,
            linearisation: self.system.linearisation().filter(|_| self.has_factor).cloned(),
            contact_multipliers: self.system.contact_multipliers().to_vec(),
            augmentation: self.augmentation.clone(),
        }
    }

    /// One step to given displacements of the held degrees of freedom (mm, one entry per node) at the present time.
    ///
    /// # Errors
    /// The cause, if the step does not converge; there is no halving.
    pub fn impose(&mut self, held_displacement: &[[f64; 3]]) -> Result<LandedState, Cause> {
        let before = self.iterations;
        self.step += 1;
        self.has_factor = false;
        let start = (self.state.displacement.clone(), self.state.border.clone());
        self.system.carry_pressures(&start.0);
        let converged = self.newton(self.state.time, start, Some(held_displacement.to_vec()), Target::Requested)?;
        self.state = converged.state;
        if let Some(tolerance) = self.penetration_tolerance {
            self.augment(tolerance)?;
        }
        Ok(self.land(self.iterations - before, 1))
    }

    fn land(&self, iterations: usize, load_steps: usize) -> LandedState {
        LandedState {
            time: self.state.time,
            displacement: self.state.displacement.as_flattened().to_vec(),
            reaction: self.state.multipliers.iter().map(|lambda| -lambda).collect(),
            iterations,
            load_steps,
            contact_points: self.state.contact_points,
            cavity_pressures: self.system.cavity_pressures(self.state.time, &self.state.border),
            contact_multipliers: self.system.contact_multipliers().to_vec(),
            augmentation: self.augmentation.clone(),
        }
    }

    /// Solves the present equilibrium to the tolerances once more, with the contact's present multipliers.
    pub(crate) fn solve_again(&mut self) -> Result<(), Cause> {
        self.has_factor = false;
        let start = (self.state.displacement.clone(), self.state.border.clone());
        self.system.carry_pressures(&start.0);
        self.state = self.newton(self.state.time, start, None, Target::Requested)?.state;
        Ok(())
    }

    pub(crate) fn set_augmentation(&mut self, augmentation: Augmentation) {
        self.augmentation = Some(augmentation);
    }

    /// Changes of displacement that the supports prescribe from a displacement to a time, mm; `None` if there are none.
    fn prescribed(&self, time: f64, displacement: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
        let target = self.moving.as_ref()?.held_displacement(time);
        Some(difference(&target, displacement))
    }

    /// One load step towards `aim`, a time that becomes the one that is tried: a guess along the tangent, cut short where it
    /// would deform the body too much or drive walls deep into each other, and Newton's method from there, to the end only at the
    /// time asked for.
    fn load_step(&mut self, aim: &mut f64, requested: f64) -> Result<Converged, Cause> {
        let wanted = *aim;
        let start = self.state.time;
        let (mut u, mut border) = (self.state.displacement.clone(), self.state.border.clone());
        let mut iterations = 0;
        self.check_stop()?;
        if !self.has_factor {
            self.system.carry_pressures(&u);
            self.system.assemble(&u, start, &border, Request::Tangent)?;
            self.system.factorize()?;
            self.iterations += 1;
            iterations = 1;
        }
        // The present loads in the factor, the new ones in the residual: with the new pressure in K as well, K is
        // indefinite where the stresses that balance it are still missing.
        self.system.assemble(&u, wanted, &border, Request::Residual)?;
        let prescribed = self.prescribed(wanted, &u);
        let correction = self.system.solve(prescribed.as_deref())?;
        self.has_factor = false;
        let allowed = self.system.deepest_penetration(&u).max(DEEP);
        let extent = self.system.extent(&u, &correction.displacement);
        self.first_rate.get_or_insert(extent.stretch / (wanted - start));
        let mut share = (GUESS.stretch / extent.stretch).min(GUESS.angle / extent.angle).min(1.0);
        let shortest = SHORTEST * share;
        loop {
            let guess = correction.scaled(share);
            let mut trial = u.clone();
            self.system.warp(&mut trial, &guess.displacement)?;
            if share * SHORTEN < shortest || self.system.deepest_penetration(&trial) <= allowed {
                self.system.carry(&u, &guess.displacement);
                u = trial;
                add(&mut border, &guess.border);
                break;
            }
            share *= SHORTEN;
        }
        let time = if share < 1.0 { start + share * (wanted - start) } else { wanted };
        *aim = time;
        let target = if time == requested { Target::Requested } else { Target::OnTheWay };
        (self.observer)(Event::StepStarted { step: self.step, time });
        let held = self.moving.as_ref().map(|problem| problem.held_displacement(time));
        let mut converged = self.newton(time, (u, border), held, target)?;
        converged.iterations += iterations;
        Ok(converged)
    }

    /// Residual norm that rounding leaves, N: positions x are known to ε|x|, their gradients to ε|x|/h with the element size h,
    /// pressures to κ ε|x|/h, and forces on an element to κ ε|x| h; over n nodes that adds up to √n times as much.
    fn rounding(&self, displacement: &[[f64; 3]]) -> f64 {
        let largest = displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        self.rounding_per_mm * (self.size + largest)
    }

    /// Newton's method at one time from a guess of the displacements and the unknowns beside them; `held` are the displacements wanted
    /// at held degrees of freedom, if they are to move.
    fn newton(
        &mut self,
        time: f64,
        (mut u, mut border): (Vec<[f64; 3]>, Vec<f64>),
        held: Option<Vec<[f64; 3]>>,
        target: Target,
    ) -> Result<Converged, Cause> {
        let mut multipliers = self.state.multipliers.clone();
        let load = self.system.load_norm(&u, time, &border).max(f64::MIN_POSITIVE);
        let rounding = self.rounding(&u).min(MOST_ROUNDING * self.settings.residual_tolerance * load);
        // What a correction cannot fall below once the residual is rounding.
        let unknowns = self.system.held().iter().filter(|held| !**held).count() as f64;
        let rounded_tolerance = self.settings.tolerance * (unknowns / FEW_UNKNOWNS).sqrt().max(1.0);
        let (mut least, mut most) = (usize::MAX, 0);
        let mut last = Measures::default();
        let mut negative_pivots = 0;
        let (mut iteration, mut stale) = (0, 0);
        let mut norms: Vec<f64> = Vec::new();
        let mut is_cautious = false;
        while iteration < self.settings.max_iterations {
            self.check_stop()?;
            // An old factor serves as long as it contracts well; a new one is an iteration.
            let is_stale = iteration > 0 && last.largest < STALE_BELOW && last.goes_on && stale < MOST_STALE;
            if is_stale {
                stale += 1;
                self.system.assemble(&u, time, &border, Request::Residual)?;
            } else {
                stale = 0;
                iteration += 1;
                self.iterations += 1;
                if is_cautious {
                    self.system.carry_pressures(&self.state.displacement);
                }
                self.system.assemble(&u, time, &border, Request::Tangent)?;
                negative_pivots = self.system.factorize()?.negative;
            }
            let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
            let prescribed = held.as_deref().map(|target| difference(target, &u));
            let prescribed = prescribed.filter(|change| self.is_felt(change));
            let correction = self.system.solve(prescribed.as_deref())?;
            let updated = self.system.multipliers(&correction)?;
            let straight = correction.displacement.as_flattened();
            let squared: f64 = straight.iter().map(|x| x * x).sum::<f64>()
                + updated.iter().zip(&multipliers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
                + correction.border.iter().map(|y| y * y).sum::<f64>();
            let largest = straight.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            let norm = squared.sqrt();
            let ratio = if is_stale { norm / last.norm } else { 0.0 };
            // An old factor goes on while it needs few more corrections to get there.
            let goes_on = ratio * ratio * norm < self.settings.tolerance || !is_stale;
            let now = Measures { norm, largest, goes_on, residual };
            multipliers = updated;
            let touching = self.system.contact_points();
            let record = IterationRecord {
                step: self.step,
                iteration,
                new_tangent: !is_stale,
                time,
                correction: now.norm,
                residual,
                relative_residual: residual / load,
                contact_points: touching,
                negative_pivots,
                elapsed_s: self.spent.total_s + self.begin.elapsed().as_secs_f64(),
            };
            (self.observer)(Event::Iteration(&record));
            if !now.norm.is_finite() || largest > RUNAWAY * self.size {
                return Err(Cause::Diverged { correction: now.norm });
            }
            let mut correction = correction;
            if !is_stale {
                if largest > HARMLESS && self.system.extent(&u, &correction.displacement).exceeds(&HOPELESS) {
                    // Once with the stresses of the last equilibrium in the tangent: far from the path, those that the linear system
                    // predicted can be so large that nothing of the tangent is left.
                    if is_cautious || prescribed.is_some() {
                        return Err(Cause::Diverged { correction: now.norm });
                    }
                    is_cautious = true;
                    continue;
                }
                norms.push(norm);
                let before = norms.len().checked_sub(1 + CIRCLE).map(|index| norms[index]);
                if iteration >= CIRCLING_FROM && before.is_some_and(|before| norm > NOT_SMALLER * before) {
                    correction = correction.scaled(0.5);
                }
            }
            if iteration + 6 > self.settings.max_iterations {
                (least, most) = (least.min(touching), most.max(touching));
            }
            // A correction with an old factor that hardly contracts is thrown away.
            let is_used = ratio < STALE_CONTRACTION || norm < self.settings.tolerance;
            if is_used {
                self.system.carry(&u, &correction.displacement);
                self.system.warp(&mut u, &correction.displacement)?;
                add(&mut border, &correction.border);
            }
            if !is_used {
                last.goes_on = false;
                continue;
            }
            last = now;
            // Small corrections of an unstable tangent lead away from the path.
            if target == Target::OnTheWay && negative_pivots == 0 && self.is_small(&u, &correction) {
                self.has_factor = !is_stale;
                let mut converged = self.converged(time, (u, border), multipliers, iteration);
                converged.state.is_loose = true;
                return Ok(converged);
            }
            let was_cautious = std::mem::take(&mut is_cautious);
            let is_rounding = residual <= rounding && last.norm < rounded_tolerance;
            if was_cautious {
                // The inertia of such a tangent says nothing about the equilibrium.
                continue;
            }
            if last.norm < self.settings.tolerance || is_rounding {
                self.system.assemble(&u, time, &border, Request::Residual)?;
                let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
                // Where supports or cavities drive the body, what the loads were at the guess says little.
                let driven = if held.is_some() || !border.is_empty() {
                    self.system.load_norm(&u, time, &border).max(self.system.reaction_norm())
                } else {
                    0.0
                };
                let is_satisfied = self.system.border_violation() <= self.settings.residual_tolerance;
                let tolerance = self.settings.residual_tolerance * load.max(driven);
                if is_satisfied && residual <= tolerance.max(rounding).max(RESIDUAL_FLOOR) {
                    if negative_pivots > 0 {
                        return Err(Cause::IndefiniteTangent { negative_pivots });
                    }
                    // Reactions of the final state, not of its linearisation.
                    for ((value, r), held) in
                        multipliers.iter_mut().zip(self.system.totals().residual.as_flattened()).zip(self.system.held())
                    {
                        *value = if *held { -r } else { 0.0 };
                    }
                    self.has_factor = true;
                    return Ok(self.converged(time, (u, border), multipliers, iteration));
                }
            }
        }
        if most > least && last.norm < 1.0 {
            return Err(Cause::ContactChatter { least, most });
        }
        Err(Cause::TooManyIterations {
            iterations: self.settings.max_iterations,
            correction: last.norm,
            residual: last.residual,
            node: self.largest_residual_node(),
        })
    }

    /// Whether a correction is so small that the state after it will do on the way.
    fn is_small(&mut self, displacement: &[[f64; 3]], correction: &Correction) -> bool {
        let straight = correction.displacement.as_flattened();
        straight.iter().all(|x| x.abs() < LOOSE)
            && self.system.extent(displacement, &correction.displacement).stretch < self.loose_stretch
    }

    /// Whether a change of the supports' displacements is more than rounding.
    fn is_felt(&self, change: &[[f64; 3]]) -> bool {
        change.as_flattened().iter().zip(self.system.held()).any(|(x, held)| *held && x.abs() > ROUNDED)
    }

    fn converged(
        &self,
        time: f64,
        (displacement, border): (Vec<[f64; 3]>, Vec<f64>),
        multipliers: Vec<f64>,
        iterations: usize,
    ) -> Converged {
        let contact_points = self.system.contact_points();
        let state = State { time, displacement, border, multipliers, contact_points, is_loose: false };
        Converged { state, iterations }
    }

    fn largest_residual_node(&self) -> usize {
        let held = self.system.held();
        let size =
            |node: usize, r: &[f64; 3]| -> f64 { (0..3).filter(|k| !held[3 * node + k]).map(|k| r[k] * r[k]).sum() };
        let residual = &self.system.totals().residual;
        (0..residual.len()).max_by(|&a, &b| size(a, &residual[a]).total_cmp(&size(b, &residual[b]))).unwrap_or(0)
    }
}

fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter().zip(b).map(|(a, b)| std::array::from_fn(|k| a[k] - b[k])).collect()
}

fn add(sum: &mut [f64], change: &[f64]) {
    for (value, delta) in sum.iter_mut().zip(change) {
        *value += delta;
    }
}

/// A path that cannot go on from a checkpoint.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResumeError {
    /// It belongs to another problem.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// Its tangent cannot be made again.
    #[error("the checkpoint's tangent cannot be made again: {0}")]
    Tangent(#[from] AssembleError),
}

impl From<AssembleError> for Cause {
    fn from(error: AssembleError) -> Self {
        match error {
            AssembleError::Local(local) => local.into(),
            AssembleError::Factor(factor) => factor.into(),
            AssembleError::Contradiction => Self::SingularTangent(error.to_string()),
        }
    }
}

impl From<pneuflex_assembly::LocalError> for Cause {
    fn from(e: pneuflex_assembly::LocalError) -> Self {
        Self::Inversion { element: e.block, point: e.point, jacobian: e.jacobian }
    }
}

impl From<pneuflex_factor::FactorError> for Cause {
    fn from(error: pneuflex_factor::FactorError) -> Self {
        Self::SingularTangent(error.to_string())
    }
}

/// Follows the equilibrium path from rest through the given times (increasing), landing on each exactly.
///
/// # Errors
/// [`Failure`] when the load step falls below its least size, with what the run had cost; the observer has seen every
/// state landed on before.
pub fn follow_path(
    problem: &Problem,
    times: &[f64],
    settings: &Solver,
    observer: &mut dyn FnMut(Event<'_>),
) -> Result<PathReport, Box<(Failure, PathReport)>> {
    let mut path = match Path::new(problem, settings, observer) {
        Ok(path) => path,
        Err(error) => {
            let cause = Cause::SingularTangent(error.to_string());
            let attempted = times.first().copied().unwrap_or(0.0);
            let (stability, clock) = (Stability::default(), problem.clock);
            let failure = Failure { reached: 0.0, attempted, cause, stability, clock };
            return Err(Box::new((failure, PathReport { iterations: 0, timing: Timing::default() })));
        }
    };
    for &time in times {
        if let Err(failure) = path.land_on(time) {
            return Err(Box::new((failure, PathReport { iterations: path.iterations, timing: path.timing() })));
        }
    }
    Ok(PathReport { iterations: path.iterations, timing: path.timing() })
}
