//! Following a load path (Fig. 3 of the paper, Steps 1–8): from equilibrium to equilibrium in load steps.
//!
//! `step_control` chooses the steps, `predictor` makes a guess, `newton` finds the equilibrium from it.

mod newton;
mod predictor;
mod release;
mod step_control;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_factor::Parallelism;
use pneuflex_mesh::Mesh;
use pneuflex_model::{Clock, LoadParameter, Problem, Solver};

use crate::checkpoint::{Approach, Checkpoint};
use crate::contributions::CavityPressures;
use crate::convergence::Scales;
use crate::error::{AssembleError, ResumeError, SetupError};
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure, Stability};
use crate::history::{Augmentation, ConvergedState};
use crate::prescribed_motion::PrescribedMotion;
use crate::stability::{self, Response};
use crate::state::{Equilibrium, State};
use crate::system::System;
use crate::tangent_solver::Tangent;
use crate::timing::{PathReport, Timing};
use crate::tuning::Tuning;
use crate::unstable_motion::UnstableMotions;

/// Follows equilibria of one problem from rest. It owns everything it needs, and may be sent to another thread.
pub struct Path {
    mesh: Arc<Mesh>,
    system: System,
    settings: Solver,
    tuning: Tuning,
    scales: Scales,
    begin: Instant,
    equilibrium: Equilibrium,
    /// Those before it, back to the last one that is solved to the tolerances: it is not known whether inexact ones are equilibria at all.
    previous: Vec<Equilibrium>,
    /// Whether every step up to the next requested position is solved to the tolerances, as an inexact one has led astray.
    is_careful: bool,
    /// Tangent near the present equilibrium, which predicts the next one.
    predictor: Option<Tangent>,
    step: usize,
    iterations: usize,
    /// The way to the next requested position, if it has begun.
    approach: Option<Approach>,
    stability: Stability,
    motion: PrescribedMotion,
    pressures: CavityPressures,
    clock: Clock,
    /// Largest stretching per change of the forces at the beginning, 1/N.
    first_rate: Option<f64>,
    /// Seconds spent before this path was resumed.
    spent: Timing,
    stop: Option<Arc<AtomicBool>>,
    augmentation: Option<Augmentation>,
}

/// How well a load step is to be solved.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    /// To the tolerance asked for.
    Requested,
    /// Well enough to go on from (inexact Newton).
    OnTheWay,
}

/// An attempt that converged.
pub(crate) struct Converged {
    pub(crate) equilibrium: Equilibrium,
    /// Tangent near it.
    pub(crate) predictor: Option<Tangent>,
    pub(crate) iterations: usize,
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
        let state = State::at_rest(n, system.num_bordered());
        let tuning = Tuning::default();
        Ok(Self {
            scales: Scales::of(problem, &tuning),
            equilibrium: Equilibrium {
                state,
                multipliers: vec![0.0; 3 * n],
                contact_points: 0,
                is_inexact: false,
                mesh_motions: None,
            },
            previous: Vec::new(),
            is_careful: false,
            mesh: Arc::clone(&problem.mesh),
            system,
            settings: settings.clone(),
            tuning,
            begin,
            predictor: None,
            step: 0,
            iterations: 0,
            approach: None,
            stability: Stability::default(),
            motion: PrescribedMotion::of(problem),
            pressures: CavityPressures::of(problem)?,
            clock: problem.clock,
            first_rate: None,
            spent: Timing::default(),
            stop: None,
            augmentation: None,
        })
    }

    /// Goes on from a checkpoint of the same problem: everything from here on is as if the path had never ended.
    ///
    /// # Errors
    /// [`ResumeError`] if the checkpoint does not fit the problem; the path is still at rest then.
    pub fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), ResumeError> {
        let Equilibrium { state, .. } = &self.equilibrium;
        let of_contact = [self.system.num_contact_points(), self.system.num_stored()];
        checkpoint.check(state.displacement.len(), of_contact, state.bordered.len())?;
        self.system.set_contact_multipliers(&checkpoint.contact_multipliers);
        if let Some(linearisation) = &checkpoint.linearisation {
            self.predictor = Some(self.system.restore(linearisation)?);
        }
        let Checkpoint {
            parameter, displacement, bordered, multipliers, contact_points, is_inexact, mesh_motions, ..
        } = checkpoint;
        let state = State::new(parameter, displacement, bordered);
        self.equilibrium = Equilibrium { state, multipliers, contact_points, is_inexact, mesh_motions };
        self.augmentation = checkpoint.augmentation;
        (self.step, self.iterations) = (checkpoint.step, checkpoint.iterations);
        self.approach = Some(checkpoint.approach);
        self.first_rate = checkpoint.first_rate;
        self.is_careful = checkpoint.is_careful;
        self.spent = checkpoint.timing;
        Ok(())
    }

    /// Lets the path end with [`Cause::Interrupted`] before the next iteration once `stop` is true.
    pub fn stop_when(&mut self, stop: Arc<AtomicBool>) {
        self.stop = Some(stop);
    }

    pub(crate) fn check_stop(&self) -> Result<(), Cause> {
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

    /// What the path has cost so far.
    pub fn report(&self) -> PathReport {
        PathReport { iterations: self.iterations, timing: self.timing() }
    }

    /// The present equilibrium.
    pub fn equilibrium(&self) -> &Equilibrium {
        &self.equilibrium
    }

    /// The present equilibrium as data, also one on the way to a requested position; iterations and load steps are those of the whole path.
    pub fn present(&self) -> ConvergedState {
        self.describe(self.iterations, self.step)
    }

    /// The system, e.g. for its energies.
    pub fn system(&mut self) -> &mut System {
        &mut self.system
    }

    /// [`Self::advance_to`], and tells the observer.
    ///
    /// # Errors
    /// As there.
    pub fn advance_and_tell(
        &mut self,
        parameter: impl Into<LoadParameter>,
        observer: Observer<'_>,
    ) -> Result<(), Failure> {
        let converged = self.advance_to(parameter, observer)?;
        observer(Event::Converged(&converged));
        Ok(())
    }

    /// One step to given displacements of the held degrees of freedom (mm, one entry per node) at the present position.
    ///
    /// # Errors
    /// The cause, if the step does not converge; there is no halving.
    pub fn prescribe(
        &mut self,
        held_displacement: &[[f64; 3]],
        observer: Observer<'_>,
    ) -> Result<ConvergedState, Cause> {
        let before = self.iterations;
        self.step += 1;
        let converged = self.solve_again(Some(held_displacement), observer)?;
        self.adopt(converged);
        if self.system.is_augmented() {
            self.augment(observer)?;
        }
        Ok(self.describe(self.iterations - before, 1))
    }

    /// Solves the present equilibrium to the tolerances once more, with a tangent of its own.
    pub(crate) fn solve_again(
        &mut self,
        held: Option<&[[f64; 3]]>,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        self.forget_predictor();
        let start = self.equilibrium.state.clone();
        self.system.predict(&start.displacement, None);
        self.newton(start, (held, None), Target::Requested, observer)
    }

    /// Solves from the present equilibrium to the tolerances, at first with a tangent near it.
    pub(crate) fn solve_near(&mut self, tangent: Option<Tangent>, observer: Observer<'_>) -> Result<Converged, Cause> {
        let start = self.equilibrium.state.clone();
        self.newton(start, (None, tangent), Target::Requested, observer)
    }

    pub(crate) fn take_predictor(&mut self) -> Option<Tangent> {
        self.predictor.take()
    }

    /// An attempt becomes the present equilibrium.
    pub(crate) fn adopt(&mut self, converged: Converged) {
        self.forget_predictor();
        let before = std::mem::replace(&mut self.equilibrium, converged.equilibrium);
        // Beyond a limit point there are states that are good enough to go on from, but no equilibria.
        if self.equilibrium.is_inexact {
            self.previous.push(before);
        } else {
            self.previous.clear();
        }
        self.predictor = converged.predictor;
        self.system.commit();
    }

    pub(crate) fn forget_predictor(&mut self) {
        self.system.recycle(self.predictor.take());
    }

    /// Solves the present equilibrium, perhaps one on the way, to the tolerances asked for, and finds out how firm it is: otherwise what
    /// was left of the residual would speak of stability, too.
    fn confirm(&mut self, observer: Observer<'_>) {
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

    fn failure(&self, attempted: LoadParameter, cause: Cause) -> Failure {
        let reached = self.equilibrium.state.parameter;
        Failure { reached, attempted, cause, stability: self.stability.clone(), clock: self.clock }
    }

    fn checkpoint(&self, approach: Approach) -> Checkpoint {
        let Equilibrium { state, multipliers, contact_points, is_inexact, mesh_motions } = self.equilibrium.clone();
        Checkpoint {
            parameter: state.parameter,
            displacement: state.displacement,
            bordered: state.bordered,
            multipliers,
            contact_points,
            is_inexact,
            step: self.step,
            iterations: self.iterations,
            timing: self.timing(),
            approach,
            first_rate: self.first_rate,
            linearisation: self.predictor.as_ref().map(|tangent| tangent.linearisation().clone()),
            contact_multipliers: self.system.contact_multipliers(),
            augmentation: self.augmentation.clone(),
            mesh_motions,
            is_careful: self.is_careful,
        }
    }

    /// The present equilibrium as data.
    fn describe(&self, iterations: usize, load_steps: usize) -> ConvergedState {
        let Equilibrium { state, multipliers, contact_points, mesh_motions, .. } = &self.equilibrium;
        ConvergedState {
            parameter: state.parameter,
            displacement: state.displacement.clone(),
            reaction: multipliers.as_chunks().0.iter().map(|lambda: &[f64; 3]| lambda.map(|l| -l)).collect(),
            iterations,
            load_steps,
            contact_points: *contact_points,
            cavity_pressures: self.pressures.at(state),
            contact_multipliers: self.system.contact_multipliers(),
            augmentation: self.augmentation.clone(),
            mesh_motions: *mesh_motions,
        }
    }

    pub(crate) fn set_augmentation(&mut self, augmentation: Augmentation) {
        self.augmentation = Some(augmentation);
    }
}

/// Follows the equilibrium path from rest through the given positions (increasing), each reached exactly.
///
/// # Errors
/// [`Failure`] when the load step falls below its least size, with what the run had cost; the observer has seen every
/// converged state before.
pub fn follow_path(
    problem: &Problem,
    parameters: &[impl Into<LoadParameter> + Copy],
    settings: &Solver,
    observer: Observer<'_>,
) -> Result<PathReport, Box<(Failure, PathReport)>> {
    let first = parameters.first().map_or(LoadParameter::default(), |&first| first.into());
    let mut path = Path::new(problem, settings)
        .map_err(|error| Box::new((Failure::at_rest(problem.clock, first, error.into()), PathReport::default())))?;
    for &parameter in parameters {
        if let Err(failure) = path.advance_and_tell(parameter, observer) {
            return Err(Box::new((failure, path.report())));
        }
    }
    Ok(path.report())
}
