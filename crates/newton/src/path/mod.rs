//! Load stepping (Fig. 3 of the paper, Steps 1–8) around Newton's method at one load, which is in `newton`.

mod newton;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_assembly::Request;
use pneuflex_factor::Parallelism;
use pneuflex_model::{Clock, Problem, Solver};

use crate::checkpoint::{Approach, Checkpoint, Misfit};
use crate::history::{Augmentation, Cause, ConvergedState, Event, Failure, PathReport, Stability, Timing};
use crate::system::{AssembleError, SetupError, System, extent_of};

/// After the present equilibrium was solved again to the tolerances, the next step is at least this share of the rejected one.
const AFTER_POLISHING: f64 = 0.25;

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
pub struct Path {
    system: System,
    settings: Solver,
    begin: Instant,
    state: State,
    /// The factor belongs to the present state's tangent, so it predicts the next one.
    has_factor: bool,
    size: f64,
    /// Stretching that is loose enough, see `newton::loose_stretch`.
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
    stop: Option<Arc<AtomicBool>>,
    /// Largest distance of contact points asked for at requested loads, mm.
    penetration_tolerance: Option<f64>,
    augmentation: Option<Augmentation>,
}

/// Who is told about everything that happens on a path.
pub type Observer<'a> = &'a mut dyn FnMut(Event<'_>);

/// How well a load step is to be solved.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    /// To the tolerance asked for.
    Requested,
    /// Well enough to go on from.
    OnTheWay,
}

/// An attempt that converged.
struct Converged {
    state: State,
    iterations: usize,
}

impl Path {
    /// Starts at rest.
    ///
    /// # Errors
    /// [`SetupError`] if the equations cannot be set up.
    pub fn new(problem: &Problem, settings: &Solver) -> Result<Self, SetupError> {
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
        let rounding_per_mm = f64::EPSILON * bulk_modulus * element_size * (n as f64).sqrt();
        Ok(Self {
            system,
            settings: settings.clone(),
            begin,
            state,
            has_factor: false,
            size,
            loose_stretch: newton::loose_stretch(&materials),
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
    pub fn stop_when(&mut self, stop: Arc<AtomicBool>) {
        self.stop = Some(stop);
    }

    fn check_stop(&self) -> Result<(), Cause> {
        match &self.stop {
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
    pub fn advance_to(&mut self, time: f64, observer: Observer<'_>) -> Result<ConvergedState, Failure> {
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
            match self.load_step(&mut attempted, time, observer) {
                Ok(converged) => {
                    approach.load_steps += 1;
                    if converged.iterations <= 8 {
                        approach.step = (2.0 * (wanted - start)).min(self.settings.max_step);
                    }
                    self.state = converged.state;
                    self.augmentation = None;
                    if let Some(tolerance) = self.penetration_tolerance.filter(|_| attempted == time)
                        && let Err(cause) = self.augment(tolerance, observer)
                    {
                        return Err(self.failure(attempted, cause));
                    }
                    let checkpoint = self.checkpoint(approach);
                    observer(Event::StepAccepted(&checkpoint));
                }
                Err(Cause::Interrupted) => return Err(self.failure(attempted, Cause::Interrupted)),
                Err(cause) => {
                    observer(Event::StepRejected { step: self.step, time: attempted, cause: &cause });
                    self.has_factor = false;
                    approach.step = 0.5 * (attempted - start);
                    if self.state.is_loose {
                        // What is left of its residual misleads the guess; solved to the tolerances it gets a longer step again.
                        self.state.is_loose = false;
                        self.confirm(observer);
                        let again = AFTER_POLISHING * (wanted - start);
                        approach.step = approach.step.max(again).max(self.settings.min_step);
                    }
                    if had_factor {
                        // The guess came from a tangent near the equilibrium; the one at the equilibrium gets its chance.
                        approach.step = approach.step.max(self.settings.min_step);
                    }
                    if approach.step < self.settings.min_step {
                        self.confirm(observer);
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
    fn confirm(&mut self, observer: Observer<'_>) {
        if self.state.time <= 0.0 {
            return;
        }
        let u = self.state.displacement.clone();
        self.system.carry_pressures(&u);
        match self.newton(self.state.time, (u, self.state.border.clone()), None, Target::Requested, observer) {
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
    pub fn advance_and_tell(&mut self, time: f64, observer: Observer<'_>) -> Result<(), Failure> {
        let landed = self.advance_to(time, observer)?;
        observer(Event::Converged(&landed));
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
    pub fn impose(&mut self, held_displacement: &[[f64; 3]], observer: Observer<'_>) -> Result<ConvergedState, Cause> {
        let before = self.iterations;
        self.step += 1;
        self.has_factor = false;
        let start = (self.state.displacement.clone(), self.state.border.clone());
        self.system.carry_pressures(&start.0);
        let converged =
            self.newton(self.state.time, start, Some(held_displacement.to_vec()), Target::Requested, observer)?;
        self.state = converged.state;
        if let Some(tolerance) = self.penetration_tolerance {
            self.augment(tolerance, observer)?;
        }
        Ok(self.land(self.iterations - before, 1))
    }

    fn land(&self, iterations: usize, load_steps: usize) -> ConvergedState {
        ConvergedState {
            time: self.state.time,
            displacement: self.state.displacement.clone(),
            reaction: self.state.multipliers.as_chunks().0.iter().map(|lambda: &[f64; 3]| lambda.map(|l| -l)).collect(),
            iterations,
            load_steps,
            contact_points: self.state.contact_points,
            cavity_pressures: self.system.cavity_pressures(self.state.time, &self.state.border),
            contact_multipliers: self.system.contact_multipliers().to_vec(),
            augmentation: self.augmentation.clone(),
        }
    }

    /// Solves the present equilibrium to the tolerances once more, with the contact's present multipliers.
    pub(crate) fn solve_again(&mut self, observer: Observer<'_>) -> Result<(), Cause> {
        self.has_factor = false;
        let start = (self.state.displacement.clone(), self.state.border.clone());
        self.system.carry_pressures(&start.0);
        self.state = self.newton(self.state.time, start, None, Target::Requested, observer)?.state;
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
            AssembleError::Contradiction => Self::Contradiction,
        }
    }
}

impl From<pneuflex_assembly::LocalError> for Cause {
    fn from(e: pneuflex_assembly::LocalError) -> Self {
        Self::Inversion { element: e.block, point: e.point, jacobian: e.jacobian }
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
    observer: Observer<'_>,
) -> Result<PathReport, Box<(Failure, PathReport)>> {
    let mut path = match Path::new(problem, settings) {
        Ok(path) => path,
        Err(error) => {
            let cause = Cause::Setup(error);
            let attempted = times.first().copied().unwrap_or(0.0);
            let (stability, clock) = (Stability::default(), problem.clock);
            let failure = Failure { reached: 0.0, attempted, cause, stability, clock };
            return Err(Box::new((failure, PathReport { iterations: 0, timing: Timing::default() })));
        }
    };
    for &time in times {
        if let Err(failure) = path.advance_and_tell(time, observer) {
            return Err(Box::new((failure, PathReport { iterations: path.iterations, timing: path.timing() })));
        }
    }
    Ok(PathReport { iterations: path.iterations, timing: path.timing() })
}
