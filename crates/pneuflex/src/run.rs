//! Following an analysis through its times, with observers.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pneuflex_model::LoadParameter;
use pneuflex_newton::{self as newton, Cause, Checkpoint, ConvergedState, Failure, Path, PathReport};
use pneuflex_post::summary::{ProbeSite, StepSummary, probe_sites};

use crate::analysis::Analysis;
use crate::derived;
use crate::error::{Error, ResultsError, Unfinished};
use crate::error_estimate::ErrorEstimate;
use crate::folder::OutputFolder;
use crate::neighbour::Neighbour;
use crate::observer::{End, Event, Listener, Observer, ReachedState, StopToken};
use crate::on_threads;
use crate::reason::explain;
use crate::recorder::Recorder;
use crate::solution::{Solution, Status};
use crate::start::{Recorded, Start};

/// Where results are recorded, and whether an earlier run is gone on with.
enum Recording {
    Fresh(PathBuf),
    Continued(PathBuf),
    Opened(OutputFolder, Start),
}

/// A run that is being prepared: observers, threads, a way to stop it, where it begins, where it is recorded.
pub struct Run<'a> {
    analysis: &'a Analysis,
    observers: Vec<Box<dyn Observer + 'a>>,
    threads: Option<usize>,
    stop: StopToken,
    start: Start,
    recording: Option<Recording>,
    keeps_fields: bool,
    neighbour: Option<Neighbour>,
    keeps_equilibria: bool,
}

impl Analysis {
    /// A run of this analysis, to be given observers and so on before it is solved.
    pub fn run(&self) -> Run<'_> {
        Run::new(self)
    }

    /// Solves it from rest through all times.
    ///
    /// # Errors
    /// [`Error::Setup`], [`Error::NotConverged`] with what was reached, or [`Error::Results`].
    pub fn solve(&self) -> Result<Solution, Error> {
        self.run().solve()
    }
}

impl<'a> Run<'a> {
    fn new(analysis: &'a Analysis) -> Self {
        Self {
            analysis,
            observers: Vec::new(),
            threads: None,
            stop: StopToken::new(),
            start: Start::AtRest,
            recording: None,
            keeps_fields: true,
            neighbour: None,
            keeps_equilibria: false,
        }
    }

    /// Tells a closure what happens. It is called on the thread that solves.
    pub fn observer(self, listener: impl FnMut(&Event<'_>) + Send + 'a) -> Self {
        self.observe_with(Listener(listener))
    }

    /// Tells an observer that has something to do at the end, or may fail.
    pub fn observe_with(mut self, observer: impl Observer + 'a) -> Self {
        self.observers.push(Box::new(observer));
        self
    }

    /// Number of threads; all of the machine's if nothing is said.
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// Ends with [`Error::Interrupted`] before the next iteration once `token` is stopped.
    pub fn stop(mut self, token: &StopToken) -> Self {
        self.stop = token.clone();
        self
    }

    /// Goes on from a load step that an observer was told of, by [`Event::StepAccepted`], as if the run had never ended.
    pub fn resume_from(self, checkpoint: Checkpoint) -> Self {
        self.start_at(Start::From(Box::new((Recorded::default(), checkpoint))))
    }

    /// Begins where [`Analysis::start_after`] says.
    pub fn start_at(mut self, start: Start) -> Self {
        self.start = start;
        self
    }

    /// Records the run in a folder, which is made if need be: summary, history of iterations, fields, checkpoints. Results of an earlier
    /// run in it are replaced once the equations are set up; a folder that holds anything else is refused.
    pub fn record(mut self, folder: impl Into<PathBuf>) -> Self {
        self.recording = Some(Recording::Fresh(folder.into()));
        self
    }

    /// Goes on with the run that a folder holds, and records it there; from rest where there is nothing to go on with.
    pub fn resume(mut self, folder: impl Into<PathBuf>) -> Self {
        self.recording = Some(Recording::Continued(folder.into()));
        self
    }

    /// Records the run in a folder that is open already, from where [`OutputFolder::start`] says.
    pub fn record_in(mut self, folder: OutputFolder, start: Start) -> Self {
        self.recording = Some(Recording::Opened(folder, start));
        self
    }

    /// Keeps no displacements of the states that are reached, only their summaries.
    pub fn without_fields(mut self) -> Self {
        self.keeps_fields = false;
        self
    }

    /// Takes the guesses of a path from rest from the load steps of a similar design, where its mesh has the same topology, there are no
    /// obstacles and nothing moves but by loads. States are the same to the tolerances; where the two designs differ the run ends ([`Error::has_left_neighbour`]), and is to be
    /// made again without it. See [`newton::Path::start_from`].
    pub fn start_from(mut self, neighbour: Option<Neighbour>) -> Self {
        self.neighbour = neighbour;
        self
    }

    /// Keeps [`Solution::neighbour`] for similar designs, if it `is_wanted`.
    pub fn keep_equilibria(mut self, is_wanted: bool) -> Self {
        self.keeps_equilibria = is_wanted;
        self
    }

    /// Follows the equilibria from rest, or from where it was said, through the analysis's times.
    ///
    /// # Errors
    /// [`Error::Setup`]; [`Error::NotConverged`] and [`Error::Interrupted`] with what was reached; [`Error::Input`] for a folder that cannot be
    /// used, or too many threads;
    /// [`Error::Results`] for results that could not be derived or recorded.
    pub fn solve(self) -> Result<Solution, Error> {
        match self.threads {
            None => self.follow(),
            threads => on_threads(threads, || self.follow()),
        }
    }

    fn follow(mut self) -> Result<Solution, Error> {
        let analysis = self.analysis;
        let (folder, start) = match self.recording.take() {
            Some(recording) => {
                let (folder, start, is_fresh) = recording.open(analysis, self.start)?;
                (Some((folder, is_fresh)), start)
            }
            None => (None, self.start),
        };
        let (recorded, from) = match start {
            Start::Complete(states) => {
                let warnings = analysis.warnings(&states);
                let status = Status::at_end(analysis.left(&states), None, false);
                return Ok(Solution { status, states, warnings, ..Solution::default() });
            }
            Start::From(earlier) => (earlier.0, Some(earlier.1)),
            Start::AtRest => (Recorded::default(), None),
        };
        let states = recorded.steps.clone();
        let remaining = left(&analysis.requested, &states, from.as_ref());
        let last_equilibrium = match &from {
            Some(checkpoint) => checkpoint.displacement.clone(),
            None => vec![[0.0; 3]; analysis.problem.mesh.num_nodes()],
        };
        let spent = from.as_ref().map_or([0, 0], |from| [from.approach.iterations_before, from.approach.load_steps]);
        let stop = Arc::new(AtomicBool::new(false));
        let is_at_rest = from.is_none();
        let mut path = set_up(analysis, &remaining, from, &stop);
        let mut has_started_from = false;
        if let (Ok(path), true) = (&mut path, is_at_rest) {
            // Where a body meets an obstacle its own guesses are the better ones.
            let neighbour = self.neighbour.filter(|_| analysis.problem.obstacles.is_empty());
            let neighbour = neighbour.and_then(|neighbour| neighbour.path_on(&analysis.problem.mesh));
            has_started_from = neighbour.is_some_and(|neighbour| path.start_from(neighbour));
            if self.keeps_equilibria {
                path.keep_equilibria();
            }
        }
        // Only now: a run that cannot begin leaves the results of an earlier one as they are.
        if let (Some((folder, is_fresh)), Ok(_)) = (folder, &path) {
            if is_fresh {
                folder.begin()?;
            }
            // First, so that nobody hears of a state that could not be recorded.
            self.observers.insert(0, Box::new(Recorder::new(folder, analysis, recorded)?));
        }
        let mut audience = Audience {
            analysis,
            sites: probe_sites(&analysis.problem.mesh, &analysis.probes),
            observers: self.observers,
            spent,
            last_equilibrium,
            found: Solution { states, has_started_from, ..Solution::default() },
            keeps_fields: self.keeps_fields,
            to_be_estimated: None,
            error: None,
            token: self.stop,
            stop,
        };
        let result = path.and_then(|path| audience.follow(path, &remaining));
        audience.finish(result)
    }
}

/// The positions that are still to be reached after the states that were, from a checkpoint on. Beyond a limit point those are left that
/// the path has not come to.
fn left(requested: &[LoadParameter], states: &[StepSummary], from: Option<&Checkpoint>) -> Vec<LoadParameter> {
    let last = states.iter().rfind(|state| state.kind.is_requested()).map(StepSummary::when);
    let is_beyond = |at: LoadParameter, from: &Checkpoint| {
        at == from.parameter || at > from.parameter.max(LoadParameter(from.arc.greatest))
    };
    let is_left = |at: LoadParameter| last.is_none_or(|last| at > last) && from.is_none_or(|from| is_beyond(at, from));
    requested.iter().copied().filter(|at| is_left(*at)).collect()
}

/// Why a path ended early, and what it had cost.
type Ended = Box<(Failure, PathReport)>;

/// The path from rest or from a checkpoint.
fn set_up(
    analysis: &Analysis,
    parameters: &[LoadParameter],
    from: Option<Checkpoint>,
    stop: &Arc<AtomicBool>,
) -> Result<Path, Ended> {
    let Analysis { problem, solver, .. } = analysis;
    let unable = |cause: Cause| {
        let attempted = parameters.first().copied().unwrap_or_default();
        Box::new((Failure::at_rest(problem.clock, attempted, cause), PathReport::default()))
    };
    let mut path = Path::new(problem, solver).map_err(|e| unable(e.into()))?;
    path.stop_when(Arc::clone(stop));
    if let Some(checkpoint) = from {
        path.resume(checkpoint).map_err(|e| unable(e.into()))?;
    }
    Ok(path)
}

impl Recording {
    /// The folder, where the run begins, and whether what the folder holds is replaced; `start` is where a run begins that is recorded anew.
    fn open(self, analysis: &Analysis, start: Start) -> Result<(OutputFolder, Start, bool), Error> {
        let (folder, start) = match self {
            Self::Fresh(path) => return Ok((OutputFolder::prepare(&path)?, start, true)),
            Self::Continued(path) => {
                let folder = OutputFolder::prepare(&path)?;
                let start = folder.start(analysis)?;
                (folder, start)
            }
            Self::Opened(folder, start) => (folder, start),
        };
        let is_fresh = matches!(start, Start::AtRest);
        Ok((folder, start, is_fresh))
    }
}

/// Those who listen, and what is kept for the end.
struct Audience<'a> {
    analysis: &'a Analysis,
    sites: BTreeMap<String, ProbeSite>,
    observers: Vec<Box<dyn Observer + 'a>>,
    /// Iterations before the last requested position, and load steps accepted since.
    spent: [usize; 2],
    /// Displacements of the last accepted load step, mm.
    last_equilibrium: Vec<[f64; 3]>,
    found: Solution,
    keeps_fields: bool,
    /// The last state, if its errors are to be estimated: once the memory of the path is free again.
    to_be_estimated: Option<ConvergedState>,
    /// First thing that could not be derived or recorded; nobody is told anything after it.
    error: Option<ResultsError>,
    token: StopToken,
    /// Stops this path alone.
    stop: Arc<AtomicBool>,
}

impl Audience<'_> {
    /// Follows the path through the given positions.
    fn follow(&mut self, mut path: Path, parameters: &[LoadParameter]) -> Result<PathReport, Ended> {
        if let Err(failure) = path.follow(parameters, &mut |event| self.hear(event)) {
            let is_new = self.found.states.last().is_none_or(|state| failure.reached != state.when());
            if is_new && failure.reached > LoadParameter::default() {
                let present = path.present();
                let before: [usize; 2] = self.spent;
                self.found.last = Some(ConvergedState {
                    iterations: present.iterations.saturating_sub(before[0]),
                    load_steps: before[1],
                    ..present
                });
            }
            return Err(Box::new((failure, path.report())));
        }
        if self.analysis.output.error_estimate && !self.token.is_stopped() && self.error.is_none() {
            self.to_be_estimated = Some(path.present());
        }
        let kept = path.take_equilibria();
        self.found.neighbour = kept.map(|kept| Neighbour::new(&self.analysis.problem.mesh, kept));
        Ok(path.report())
    }

    /// Passes on what the path says.
    fn hear(&mut self, event: newton::Event<'_>) {
        let done = match event {
            _ if self.error.is_some() => Ok(()),
            newton::Event::StepStarted { step, parameter } => self.tell(&Event::StepStarted { step, parameter }),
            newton::Event::Iteration(record) => self.tell(&Event::Iteration(record)),
            newton::Event::StepRejected { step, parameter, cause } => {
                self.tell(&Event::StepRejected { step, parameter, cause })
            }
            newton::Event::StepAccepted(checkpoint) => {
                self.last_equilibrium.clone_from(&checkpoint.displacement);
                self.spent = [checkpoint.approach.iterations_before, checkpoint.approach.load_steps];
                self.tell(&Event::StepAccepted(checkpoint))
            }
            newton::Event::Converged(equilibrium) => self.state(equilibrium),
        };
        if let Err(error) = done {
            self.error = Some(error);
        }
        if self.error.is_some() || self.token.is_stopped() {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn tell(&mut self, event: &Event<'_>) -> Result<(), ResultsError> {
        self.observers.iter_mut().try_for_each(|observer| observer.observe(event))
    }

    fn state(&mut self, equilibrium: &ConvergedState) -> Result<(), ResultsError> {
        let began = Instant::now();
        let described = derived::describe(&self.analysis.problem, &self.sites, equilibrium)?;
        let seconds = began.elapsed().as_secs_f64();
        let state = ReachedState { summary: &described.summary, equilibrium, described: &described, seconds };
        self.tell(&Event::State(state))?;
        self.found.states.push(described.summary);
        if self.keeps_fields {
            self.found.fields.push(equilibrium.clone());
        }
        Ok(())
    }

    fn finish(mut self, result: Result<PathReport, Ended>) -> Result<Solution, Error> {
        let (report, failure) = match result {
            Ok(report) => (report, None),
            Err(ended) => (ended.1, Some(ended.0)),
        };
        let explained =
            |failure| explain(&self.analysis.problem, self.analysis.vocabulary(), failure, &self.last_equilibrium);
        let reason = failure.as_ref().and_then(explained);
        let last = self.to_be_estimated.take();
        self.found.error_estimate = last.map(|state| ErrorEstimate::of(self.analysis, &state));
        let (failed, explained) = (failure.as_ref(), reason.as_ref());
        let mut error = self.error.take();
        for observer in &mut self.observers {
            let last = self.found.last.as_ref();
            let estimate = self.found.error_estimate.as_ref();
            let end =
                End { report: &report, failure: failed, reason: explained, last, estimate, error: error.as_ref() };
            if let Err(new) = observer.finish(&end) {
                error.get_or_insert(new);
            }
        }
        let PathReport { iterations, timing } = report;
        let warnings = self.analysis.warnings_beside(&self.found.states, self.found.error_estimate.as_ref());
        let status = Status::at_end(self.analysis.left(&self.found.states), failure.as_ref(), error.is_some());
        let reached = Solution { status, warnings, iterations, timing, ..self.found };
        match (error, failure) {
            (Some(error), _) => Err(error.into()),
            (None, Some(failure)) => Err(Unfinished { failure, reason, reached }.into_error()),
            (None, None) => Ok(reached),
        }
    }
}
