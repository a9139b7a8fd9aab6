//! Newton-Raphson at one load, and the load stepping around it (Fig. 3 of the paper, Steps 1–8).

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_assembly::Request;
use pneuflex_factor::Parallelism;
use pneuflex_model::{MPA_PER_KPA, Problem, Solver};

use crate::checkpoint::{Approach, Checkpoint, Misfit};
use crate::history::{Cause, Event, Failure, IterationRecord, LandedState, PathReport, Stability, Timing};
use crate::system::{AssembleError, SetupError, System};
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

/// A load step that is not a requested one is good enough when no node moves further than this, mm.
const LOOSE: f64 = 0.1;

/// Once a correction moves no node further than this (mm), the factor at hand is tried for the next ones.
const STALE_BELOW: f64 = 0.05;

/// Corrections in a row with the same old factor, at the most.
const MOST_STALE: usize = 8;

/// After the present equilibrium was solved again to the tolerances, the next step is at least this share of the rejected one.
const AFTER_POLISHING: f64 = 0.25;

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
    pressure_kpa: f64,
    displacement: Vec<[f64; 3]>,
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
    /// Residual that rounding leaves per mm of the body's extent, N/mm; see [`Path::rounding`].
    rounding_per_mm: f64,
    step: usize,
    iterations: usize,
    /// The way to the next requested pressure, if it has begun.
    approach: Option<Approach>,
    stability: Stability,
    /// Largest stretching per pressure at the beginning, 1/kPa.
    first_rate: Option<f64>,
    /// Seconds spent before this path was resumed.
    spent: Timing,
    stop: Option<&'a AtomicBool>,
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
struct Correction {
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
        let size = (0..3)
            .map(|d| {
                let (low, high) = problem
                    .mesh
                    .nodes
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[d]), b.max(x[d])));
                high - low
            })
            .fold(0.0, f64::max);
        let state = State {
            pressure_kpa: 0.0,
            displacement: vec![[0.0; 3]; n],
            multipliers: vec![0.0; 3 * n],
            contact_points: 0,
            is_loose: false,
        };
        let element_size = (problem.mesh.volume() / problem.mesh.num_elements().max(1) as f64).cbrt();
        let rounding_per_mm = f64::EPSILON * problem.material.bulk_modulus * element_size * (n as f64).sqrt();
        Ok(Self {
            system,
            settings,
            observer,
            begin,
            state,
            has_factor: false,
            size,
            rounding_per_mm,
            step: 0,
            iterations: 0,
            approach: None,
            stability: Stability::default(),
            first_rate: None,
            spent: Timing::default(),
            stop: None,
        })
    }

    /// Goes on from a checkpoint of the same problem: everything from here on is as if the path had never ended.
    ///
    /// # Errors
    /// [`ResumeError`] if the checkpoint does not fit the problem; the path is still at rest then.
    pub fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), ResumeError> {
        checkpoint.check(self.state.displacement.len(), self.system.num_contact_points())?;
        self.has_factor = checkpoint.linearisation.is_some();
        if let Some(linearisation) = checkpoint.linearisation {
            self.system.restore(linearisation)?;
        }
        let Checkpoint { pressure_kpa, displacement, multipliers, contact_points, is_loose, .. } = checkpoint;
        self.state = State { pressure_kpa, displacement, multipliers, contact_points, is_loose };
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

    /// Steps from the present equilibrium to `pressure_kpa` and lands on it exactly.
    ///
    /// # Errors
    /// [`Failure`] when the step falls below its least size; the present equilibrium is then the last one reached.
    pub fn advance_to(&mut self, pressure_kpa: f64) -> Result<LandedState, Failure> {
        let step_kpa = match self.state.pressure_kpa > 0.0 {
            true => self.settings.max_step_kpa,
            false => self.settings.first_step_kpa.max(self.settings.min_step_kpa),
        };
        let fresh = Approach { step_kpa, load_steps: 0, iterations_before: self.iterations };
        let mut approach = self.approach.take().unwrap_or(fresh);
        approach.step_kpa = approach.step_kpa.min(self.settings.max_step_kpa);
        while self.state.pressure_kpa < pressure_kpa {
            let start = self.state.pressure_kpa;
            // A last step that would leave a crumb takes it along.
            let is_last = pressure_kpa - start <= 1.01 * approach.step_kpa;
            let wanted = if is_last { pressure_kpa } else { start + approach.step_kpa };
            self.step += 1;
            let mut attempted = wanted;
            let had_factor = self.has_factor;
            match self.load_step(&mut attempted, pressure_kpa) {
                Ok(converged) => {
                    approach.load_steps += 1;
                    if converged.iterations <= 8 {
                        approach.step_kpa = (2.0 * (wanted - start)).min(self.settings.max_step_kpa);
                    }
                    self.state = converged.state;
                    let checkpoint = self.checkpoint(approach);
                    (self.observer)(Event::StepAccepted(&checkpoint));
                }
                Err(Cause::Interrupted) => return Err(self.failure(attempted, Cause::Interrupted)),
                Err(cause) => {
                    (self.observer)(Event::StepRejected { step: self.step, pressure_kpa: attempted, cause: &cause });
                    self.has_factor = false;
                    approach.step_kpa = 0.5 * (attempted - start);
                    if self.state.is_loose {
                        // What is left of its residual misleads the guess; solved to the tolerances it gets a longer step again.
                        self.state.is_loose = false;
                        self.confirm();
                        let again = AFTER_POLISHING * (wanted - start);
                        approach.step_kpa = approach.step_kpa.max(again).max(self.settings.min_step_kpa);
                    }
                    if had_factor {
                        // The guess came from a tangent near the equilibrium; the one at the equilibrium gets its chance.
                        approach.step_kpa = approach.step_kpa.max(self.settings.min_step_kpa);
                    }
                    if approach.step_kpa < self.settings.min_step_kpa {
                        self.confirm();
                        return Err(self.failure(attempted, cause));
                    }
                }
            }
        }
        Ok(self.land(self.iterations - approach.iterations_before, approach.load_steps))
    }

    fn failure(&self, attempted_kpa: f64, cause: Cause) -> Failure {
        Failure { reached_kpa: self.state.pressure_kpa, attempted_kpa, cause, stability: self.stability }
    }

    /// Solves the present equilibrium, perhaps one on the way, to the tolerances asked for, and finds out how firm it is: otherwise what
    /// was left of the residual would speak of stability, too.
    fn confirm(&mut self) {
        if self.state.pressure_kpa <= 0.0 {
            return;
        }
        let u = self.state.displacement.clone();
        self.system.carry_pressures(&u);
        match self.newton(self.state.pressure_kpa, u, None, Target::Requested) {
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
        let (u, pressure) = (self.state.displacement.clone(), self.state.pressure_kpa);
        let change = (1e-3 * pressure).max(self.settings.min_step_kpa);
        self.system.carry_pressures(&u);
        self.system.assemble(&u, pressure * MPA_PER_KPA, Request::Tangent)?;
        self.system.factorize()?;
        self.system.assemble(&u, (pressure + change) * MPA_PER_KPA, Request::Residual)?;
        let correction = self.system.solve(None)?;
        let rate = self.system.extent(&u, &correction).stretch / change;
        Ok(self.first_rate.map_or(1.0, |first| rate / first))
    }

    /// [`Self::advance_to`], and tells the observer.
    ///
    /// # Errors
    /// As there.
    pub fn land_on(&mut self, pressure_kpa: f64) -> Result<(), Failure> {
        let landed = self.advance_to(pressure_kpa)?;
        (self.observer)(Event::Landed(&landed));
        Ok(())
    }

    fn checkpoint(&self, approach: Approach) -> Checkpoint {
        let State { pressure_kpa, displacement, multipliers, contact_points, is_loose } = self.state.clone();
        Checkpoint {
            pressure_kpa,
            displacement,
            multipliers,
            contact_points,
            is_loose,
            step: self.step,
            iterations: self.iterations,
            timing: self.timing(),
            approach,
            first_rate: self.first_rate,
            linearisation: self.system.linearisation().filter(|_| self.has_factor).cloned(),
        }
    }

    /// One step to given displacements of the held degrees of freedom (mm, one entry per node) at the present pressure.
    ///
    /// # Errors
    /// The cause, if the step does not converge; there is no halving.
    pub fn impose(&mut self, held_displacement: &[[f64; 3]]) -> Result<LandedState, Cause> {
        let before = self.iterations;
        self.step += 1;
        let change: Vec<[f64; 3]> = held_displacement
            .iter()
            .zip(&self.state.displacement)
            .map(|(target, now)| std::array::from_fn(|k| target[k] - now[k]))
            .collect();
        self.has_factor = false;
        let start = self.state.displacement.clone();
        self.system.carry_pressures(&start);
        let converged = self.newton(self.state.pressure_kpa, start, Some(change), Target::Requested)?;
        self.state = converged.state;
        Ok(self.land(self.iterations - before, 1))
    }

    fn land(&self, iterations: usize, load_steps: usize) -> LandedState {
        LandedState {
            pressure_kpa: self.state.pressure_kpa,
            displacement: self.state.displacement.as_flattened().to_vec(),
            reaction: self.state.multipliers.iter().map(|lambda| -lambda).collect(),
            iterations,
            load_steps,
            contact_points: self.state.contact_points,
        }
    }

    /// One load step towards `aim` (kPa), which becomes the pressure that is tried: a guess along the tangent, cut short where it
    /// would deform the body too much or drive walls deep into each other, and Newton's method from there, to the end only at the
    /// pressure asked for.
    fn load_step(&mut self, aim: &mut f64, requested: f64) -> Result<Converged, Cause> {
        let wanted = *aim;
        let start = self.state.pressure_kpa;
        let mut u = self.state.displacement.clone();
        let mut iterations = 0;
        self.check_stop()?;
        if !self.has_factor {
            self.system.carry_pressures(&u);
            self.system.assemble(&u, start * MPA_PER_KPA, Request::Tangent)?;
            self.system.factorize()?;
            self.iterations += 1;
            iterations = 1;
        }
        // The present pressure in the factor, the new one in the residual: with the new pressure in K as well, K is
        // indefinite where the stresses that balance it are still missing.
        self.system.assemble(&u, wanted * MPA_PER_KPA, Request::Residual)?;
        let correction = self.system.solve(None)?;
        self.has_factor = false;
        let allowed = self.system.deepest_penetration(&u).max(DEEP);
        let extent = self.system.extent(&u, &correction);
        self.first_rate.get_or_insert(extent.stretch / (wanted - start));
        let mut share = (GUESS.stretch / extent.stretch).min(GUESS.angle / extent.angle).min(1.0);
        let shortest = SHORTEST * share;
        loop {
            let guess = scaled(&correction, share);
            let mut trial = u.clone();
            self.system.warp(&mut trial, &guess)?;
            if share * SHORTEN < shortest || self.system.deepest_penetration(&trial) <= allowed {
                self.system.carry(&u, &guess);
                u = trial;
                break;
            }
            share *= SHORTEN;
        }
        let pressure_kpa = if share < 1.0 { start + share * (wanted - start) } else { wanted };
        *aim = pressure_kpa;
        let target = if pressure_kpa == requested { Target::Requested } else { Target::OnTheWay };
        (self.observer)(Event::StepStarted { step: self.step, pressure_kpa });
        let mut converged = self.newton(pressure_kpa, u, None, target)?;
        converged.iterations += iterations;
        Ok(converged)
    }

    /// Residual norm that rounding leaves, N: positions x are known to ε|x|, their gradients to ε|x|/h with the element size h,
    /// pressures to κ ε|x|/h, and forces on an element to κ ε|x| h; over n nodes that adds up to √n times as much.
    fn rounding(&self, displacement: &[[f64; 3]]) -> f64 {
        let largest = displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        self.rounding_per_mm * (self.size + largest)
    }

    /// Newton's method at one pressure from a guess `u`; `imposed` are changes wanted at held degrees of freedom.
    fn newton(
        &mut self,
        pressure_kpa: f64,
        mut u: Vec<[f64; 3]>,
        mut imposed: Option<Vec<[f64; 3]>>,
        target: Target,
    ) -> Result<Converged, Cause> {
        let pressure = pressure_kpa * MPA_PER_KPA;
        let mut multipliers = self.state.multipliers.clone();
        let load = self.system.load_norm(&u, pressure).max(f64::MIN_POSITIVE);
        let rounding = self.rounding(&u).min(MOST_ROUNDING * self.settings.residual_tolerance * load);
        // What a correction cannot fall below once the residual is rounding.
        let unknowns = self.system.held().iter().filter(|held| !**held).count() as f64;
        let rounded_tolerance = self.settings.tolerance * (unknowns / FEW_UNKNOWNS).sqrt().max(1.0);
        let (mut least, mut most) = (usize::MAX, 0);
        let mut last = Correction::default();
        let mut negative_pivots = 0;
        let (mut iteration, mut stale) = (0, 0);
        let mut norms: Vec<f64> = Vec::new();
        let (had_imposed, mut is_cautious) = (imposed.is_some(), false);
        while iteration < self.settings.max_iterations {
            self.check_stop()?;
            // An old factor serves as long as it contracts well; a new one is an iteration.
            let is_stale = iteration > 0 && last.largest < STALE_BELOW && last.goes_on && stale < MOST_STALE;
            if is_stale {
                stale += 1;
                self.system.assemble(&u, pressure, Request::Residual)?;
            } else {
                stale = 0;
                iteration += 1;
                self.iterations += 1;
                if is_cautious {
                    self.system.carry_pressures(&self.state.displacement);
                }
                self.system.assemble(&u, pressure, Request::Tangent)?;
                negative_pivots = self.system.factorize()?.negative;
            }
            let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
            let correction = self.system.solve(imposed.take().as_deref())?;
            let updated = self.system.multipliers(&correction)?;
            let squared: f64 = correction.as_flattened().iter().map(|x| x * x).sum::<f64>()
                + updated.iter().zip(&multipliers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            let largest = correction.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            let norm = squared.sqrt();
            let ratio = if is_stale { norm / last.norm } else { 0.0 };
            // An old factor goes on while it needs few more corrections to get there.
            let goes_on = ratio * ratio * norm < self.settings.tolerance || !is_stale;
            let now = Correction { norm, largest, goes_on, residual };
            multipliers = updated;
            let touching = self.system.contact_points();
            let record = IterationRecord {
                step: self.step,
                iteration,
                new_tangent: !is_stale,
                pressure_kpa,
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
                if largest > HARMLESS && self.system.extent(&u, &correction).exceeds(&HOPELESS) {
                    // Once with the stresses of the last equilibrium in the tangent: far from the path, those that the linear system
                    // predicted can be so large that nothing of the tangent is left.
                    if is_cautious || had_imposed {
                        return Err(Cause::Diverged { correction: now.norm });
                    }
                    is_cautious = true;
                    continue;
                }
                norms.push(norm);
                let before = norms.len().checked_sub(1 + CIRCLE).map(|index| norms[index]);
                if iteration >= CIRCLING_FROM && before.is_some_and(|before| norm > NOT_SMALLER * before) {
                    correction = scaled(&correction, 0.5);
                }
            }
            if iteration + 6 > self.settings.max_iterations {
                (least, most) = (least.min(touching), most.max(touching));
            }
            // A correction with an old factor that hardly contracts is thrown away.
            let is_used = ratio < STALE_CONTRACTION || norm < self.settings.tolerance;
            if is_used {
                self.system.carry(&u, &correction);
                self.system.warp(&mut u, &correction)?;
            }
            if !is_used {
                last.goes_on = false;
                continue;
            }
            last = now;
            // Small corrections of an unstable tangent lead away from the path.
            if target == Target::OnTheWay && largest < LOOSE && negative_pivots == 0 {
                self.has_factor = !is_stale;
                let mut converged = self.converged(pressure_kpa, u, multipliers, iteration);
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
                self.system.assemble(&u, pressure, Request::Residual)?;
                let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
                if residual <= (self.settings.residual_tolerance * load).max(rounding).max(RESIDUAL_FLOOR) {
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
                    return Ok(self.converged(pressure_kpa, u, multipliers, iteration));
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

    fn converged(
        &self,
        pressure_kpa: f64,
        displacement: Vec<[f64; 3]>,
        multipliers: Vec<f64>,
        iterations: usize,
    ) -> Converged {
        let contact_points = self.system.contact_points();
        let state = State { pressure_kpa, displacement, multipliers, contact_points, is_loose: false };
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

fn scaled(field: &[[f64; 3]], factor: f64) -> Vec<[f64; 3]> {
    field.iter().map(|x| x.map(|t| factor * t)).collect()
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

/// Follows the equilibrium path from rest through the given pressures (kPa, increasing), landing on each exactly.
///
/// # Errors
/// [`Failure`] when the load step falls below its least size, with what the run had cost; the observer has seen every
/// state landed on before.
pub fn follow_path(
    problem: &Problem,
    pressures_kpa: &[f64],
    settings: &Solver,
    observer: &mut dyn FnMut(Event<'_>),
) -> Result<PathReport, (Failure, PathReport)> {
    let mut path = match Path::new(problem, settings, observer) {
        Ok(path) => path,
        Err(error) => {
            let cause = Cause::SingularTangent(error.to_string());
            let attempted_kpa = pressures_kpa.first().copied().unwrap_or(0.0);
            let failure = Failure { reached_kpa: 0.0, attempted_kpa, cause, stability: Stability::default() };
            return Err((failure, PathReport { iterations: 0, timing: Timing::default() }));
        }
    };
    for &pressure in pressures_kpa {
        if let Err(failure) = path.land_on(pressure) {
            return Err((failure, PathReport { iterations: path.iterations, timing: path.timing() }));
        }
    }
    Ok(PathReport { iterations: path.iterations, timing: path.timing() })
}
