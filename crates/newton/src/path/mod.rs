//! Following a load path (Fig. 3 of the paper, Steps 1–8): from equilibrium to equilibrium in load steps.
//!
//! `step_control` chooses the steps, `predictor` makes a guess, or `neighbour` one from the path of a similar problem, `newton` finds the
//! equilibrium from it; `arc_length` goes on beyond limit points, `branching` where a body buckles, `snap` where it jumps; `ending` finds out
//! why it goes no further.

mod arc_length;
mod branching;
mod ending;
mod neighbour;
mod newton;
mod predictor;
mod record;
mod release;
mod snap;
mod step_control;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_factor::Parallelism;
use pneuflex_mesh::Mesh;
use pneuflex_model::{Clock, Continuation, LoadParameter, Problem, Solver};

pub use self::neighbour::EquilibriumPath;
use self::newton::Driven;
use crate::arc::{self, ArcEquation, ArcKind, ArcMemory};
use crate::checkpoint::{Approach, Checkpoint};
use crate::contributions::CavityPressures;
use crate::convergence::Scales;
use crate::error::{ResumeError, SetupError};
use crate::event::{Event, Observer};
use crate::failure::{Cause, Failure, Stability};
use crate::history::{Augmentation, Bifurcation, ConvergedState, Snap};
use crate::prescribed_motion::PrescribedMotion;
use crate::state::{Correction, Equilibrium, State};
use crate::system::System;
use crate::tangent_solver::Tangent;
use crate::timing::{PathReport, Timing};
use crate::tuning::Tuning;
use crate::unstable_motion::{Mode, UnstableMotions};

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
    /// The path of a similar problem, as long as this one goes along with it.
    neighbour: Option<EquilibriumPath>,
    /// Its own equilibria, if they are kept for similar problems.
    kept: Option<EquilibriumPath>,
    /// What a path that is followed by its arc length remembers.
    arc: ArcMemory,
    /// The last requested position, if it is followed by its arc length.
    last: LoadParameter,
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
    /// Unstable motions of the last state that was given up for them, and the softest.
    unstable: Option<(UnstableMotions, Mode)>,
    /// How often it was tried to leave the branch from the present equilibrium.
    branchings: usize,
    /// Where the path has left a branch since the last state that was told of.
    bifurcations: Vec<Bifurcation>,
    /// How the body has snapped since the last state that was told of.
    snaps: Vec<Snap>,
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
    /// Change of all unknowns per change of the load parameter, if it was needed.
    pub(crate) rate: Option<Correction>,
    pub(crate) iterations: usize,
    /// The tangents at neither end of the load step predict it.
    pub(crate) has_jumped: bool,
}

impl Path {
    /// Starts at rest.
    ///
    /// # Errors
    /// [`SetupError`] if the equations cannot be set up.
    pub fn new(problem: &Problem, settings: &Solver) -> Result<Self, SetupError> {
        let begin = Instant::now();
        let is_damped = settings.continuation == Continuation::Damped;
        let system = System::of(problem, is_damped, Parallelism::Threads)?;
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
                negative_pivots: 0,
            },
            previous: Vec::new(),
            is_careful: false,
            mesh: Arc::clone(&problem.mesh),
            system,
            settings: settings.clone(),
            tuning,
            begin,
            predictor: None,
            neighbour: None,
            kept: None,
            arc: ArcMemory::default(),
            last: LoadParameter::default(),
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
            unstable: None,
            branchings: 0,
            bifurcations: Vec::new(),
            snaps: Vec::new(),
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
            parameter,
            displacement,
            bordered,
            multipliers,
            contact_points,
            is_inexact,
            mesh_motions,
            negative_pivots,
            ..
        } = checkpoint;
        let state = State::new(parameter, displacement, bordered);
        self.equilibrium =
            Equilibrium { state, multipliers, contact_points, is_inexact, mesh_motions, negative_pivots };
        self.arc = checkpoint.arc;
        self.bifurcations = checkpoint.bifurcations;
        self.snaps = checkpoint.snaps;
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
        self.bifurcations.clear();
        self.snaps.clear();
        Ok(())
    }

    /// Follows the path through the given positions (increasing), and tells the observer of each. By its arc length it goes on beyond limit
    /// points: its states are told of as they come there, until the load parameter has risen to the last position again, would fall below
    /// zero, or there are as many as [`Solver::states_past_limit`]. Positions above the limit point that it does not come to are passed over.
    ///
    /// # Errors
    /// As [`Self::advance_to`].
    pub fn follow(&mut self, parameters: &[LoadParameter], observer: Observer<'_>) -> Result<(), Failure> {
        match self.settings.continuation {
            Continuation::Load | Continuation::Damped => {
                parameters.iter().try_for_each(|&at| self.advance_and_tell(at, observer))
            }
            Continuation::ArcLength => self.follow_arc(parameters, observer),
        }
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
        // Beyond a limit point, and there above all, the load parameter has to give way.
        let start = self.equilibrium.state.clone();
        let gives_way = held.is_none() && self.arc.is_past_limit();
        let rate = if gives_way { Some(self.present_rate(&start)?.0) } else { None };
        self.forget_predictor();
        self.system.predict(&start.displacement, None);
        let Some(rate) = rate else {
            return self.newton(start, Driven::ByLoad(held), None, Target::Requested, observer);
        };
        let weight = arc::weight(&start, self.arc.greatest, &rate);
        let equation = ArcEquation { start: &start, weight, kind: ArcKind::Across(&rate) };
        self.newton(start.clone(), Driven::ByArc(&equation), None, Target::Requested, observer)
    }

    /// Solves from the present equilibrium to the tolerances, at first with a tangent near it. Beyond a limit point it is of no use.
    pub(crate) fn solve_near(&mut self, tangent: Option<Tangent>, observer: Observer<'_>) -> Result<Converged, Cause> {
        if self.arc.is_past_limit() {
            self.system.recycle(tangent);
            return self.solve_again(None, observer);
        }
        let start = self.equilibrium.state.clone();
        self.newton(start, Driven::ByLoad(None), tangent, Target::Requested, observer)
    }

    pub(crate) fn take_tangent(&mut self) -> Option<Tangent> {
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
        self.branchings = 0;
        self.system.commit();
    }

    pub(crate) fn forget_predictor(&mut self) {
        self.system.recycle(self.predictor.take());
    }

    pub(crate) fn set_augmentation(&mut self, augmentation: Augmentation) {
        self.augmentation = Some(augmentation);
    }
}

/// Follows the equilibrium path from rest through the given positions (increasing), each reached exactly; see [`Path::follow`].
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
    let parameters: Vec<LoadParameter> = parameters.iter().map(|&parameter| parameter.into()).collect();
    match path.follow(&parameters, observer) {
        Ok(()) => Ok(path.report()),
        Err(failure) => Err(Box::new((failure, path.report()))),
    }
}
